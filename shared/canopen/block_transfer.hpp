#pragma once

// The two ends of a block transfer by SDO (CiA 301, 7.2.4.3.9 to 7.2.4.3.15): sub-blocks of up to 127 segments, each
// with a sequence number; the receiver acknowledges a sub-block with the number of the last segment that came in
// sequence, and the sender continues after that one. Server and client have one of each.
//
// CiA 301 does not say what happens when the acknowledgement is lost, or the last segment of a sub-block. Here the
// receiver acts after a silence: it acknowledges the segments that it has. If no segment has come since its last
// acknowledgement, it repeats that acknowledgement.

#include <cstdint>
#include <span>

namespace proleg::canopen {

inline constexpr std::uint8_t max_block_size = 127;
inline constexpr std::uint8_t segment_bytes = 7;

/// CRC of a block transfer: polynomial x^16 + x^12 + x^5 + 1, start value 0, highest bit first (CiA 301, 7.2.4.3.16).
class BlockCrc {
 public:
  constexpr void add(std::span<const std::uint8_t> bytes) {
    // The eight steps of a byte are done at once: the polynomial has so few terms that the steps do not interfere.
    for (const std::uint8_t byte : bytes) {
      unsigned rest = value_ >> 8U ^ byte;
      rest ^= rest >> 4U;
      value_ = static_cast<std::uint16_t>(unsigned{value_} << 8U ^ rest << 12U ^ rest << 5U ^ rest);
    }
  }
  [[nodiscard]] constexpr std::uint16_t value() const { return value_; }

 private:
  std::uint16_t value_ = 0;
};

/// Bits of the first byte of a segment. The lower seven are the sequence number, which counts from 1.
inline constexpr std::uint8_t last_segment = 0x80;

class BlockReceiver {
 public:
  enum class Segment : std::uint8_t {
    taken,
    skipped,  ///< its sequence number is not the next one
    invalid,  ///< no sub-block has its sequence number
  };

  /// Starts a transfer. size: number of segments in each sub-block.
  void start(std::uint8_t size) { *this = BlockReceiver(size); }
  /// Takes a segment. head: its first byte.
  Segment take(std::uint8_t head);
  /// Whether the last segment of the sub-block has come: the sub-block must be acknowledged.
  [[nodiscard]] bool has_ended() const { return has_ended_; }
  /// Whether the last segment of the transfer was taken.
  [[nodiscard]] bool is_complete() const { return is_complete_; }
  /// Whether a sub-block was acknowledged, or a segment of the first one has come.
  [[nodiscard]] bool has_begun() const { return has_acknowledged_ || has_come_; }
  /// Returns the sequence number to acknowledge, at the end of a sub-block or after a silence. Begins the next
  /// sub-block.
  [[nodiscard]] std::uint8_t acknowledge();
  [[nodiscard]] std::uint8_t size() const { return size_; }
  /// Whether the transfer should end, because too many acknowledgements in a row have brought no segment. The received
  /// segments are then not those of this transfer: another client has begun one, and both ends would acknowledge for
  /// ever.
  [[nodiscard]] bool is_stuck() const { return unanswered_ >= max_unanswered; }

  explicit constexpr BlockReceiver(std::uint8_t size = max_block_size) : size_(size) {}

 private:
  static constexpr std::uint8_t max_unanswered = 20;

  std::uint8_t size_;
  std::uint8_t unanswered_ = 0;    ///< acknowledgements since a segment was taken
  std::uint8_t taken_ = 0;         ///< segments of the present sub-block that were taken
  std::uint8_t acknowledged_ = 0;  ///< segments of the last sub-block that were acknowledged
  bool has_come_ = false;          ///< whether a segment has come since the last acknowledgement
  bool has_ended_ = false;
  bool is_complete_ = false;
  bool has_acknowledged_ = false;
};

class BlockSender {
 public:
  enum class Answer : std::uint8_t {
    accepted,
    repeated,  ///< the acknowledgement was one of the sub-block before: the present one is sent again
    invalid_size,
    invalid_sequence_number,
  };

  /// Starts a transfer. size: number of segments of a sub-block; false if it is impossible.
  [[nodiscard]] bool start(std::uint8_t size);
  /// Sends the present sub-block again.
  void restart();
  [[nodiscard]] bool can_send() const { return !has_sent_last_ && sent_ < size_; }
  /// Number of segments of the present sub-block that were sent.
  [[nodiscard]] std::uint8_t sent() const { return sent_; }
  /// Counts the next segment as sent, and returns its first byte.
  [[nodiscard]] std::uint8_t send(bool is_last);
  /// Takes an acknowledgement of `number` segments. If `accepted`, the next sub-block begins behind these segments.
  [[nodiscard]] Answer acknowledge(std::uint8_t number, std::uint8_t next_size);

 private:
  std::uint8_t size_ = 0;
  std::uint8_t sent_ = 0;
  std::uint8_t acknowledged_ = 0;  ///< segments of the last sub-block that were acknowledged
  bool has_sent_last_ = false;
};

}  // namespace proleg::canopen
