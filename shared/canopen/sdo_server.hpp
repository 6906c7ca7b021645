#pragma once

// The SDO server of a device (CiA 301, 7.2.4.3): expedited, segmented and block transfers in both directions, one
// transfer at a time. It has no clock: the caller passes the time.

#include <array>
#include <optional>
#include <span>

#include "shared/can/can_port.hpp"
#include "shared/canopen/block_transfer.hpp"
#include "shared/canopen/objects.hpp"

namespace proleg::canopen {

/// Whether a client can read values of more than four bytes, by segments or as a block. A bootloader has neither such
/// values nor room for the services: it is built with PROLEG_SDO_WITHOUT_LONG_UPLOADS, and refuses these commands.
#ifdef PROLEG_SDO_WITHOUT_LONG_UPLOADS
inline constexpr bool sdo_has_long_uploads = false;
#else
inline constexpr bool sdo_has_long_uploads = true;
#endif

/// The state of the device behind the SDO server. The server calls it only for entries that exist, that the declaration
/// allows to be read or written, and that have no fixed_value().
class ObjectAccess {
 public:
  /// The entry at an address, or the reason why it is absent. The declared dictionary decides, unless a device has
  /// another one.
  virtual AbortCode find(Address address, Entry& entry) { return find_entry(address, entry); }

  /// Reads a number as 32 bits. The server sends its low bytes.
  virtual AbortCode read(const Entry& entry, std::uint32_t& value) = 0;
  /// Writes a number, which is within the declared range. Signed types are sign-extended.
  virtual AbortCode write(const Entry& entry, std::uint32_t value) = 0;

  // Entries of long types are read and written in pieces, so that no memory of the size of the value is needed. A
  // device without such entries need not define these functions.

  /// Begins to read. size: number of bytes. The value must not change until the next call of open_read().
  virtual AbortCode open_read(const Entry& /*entry*/, std::uint32_t& /*size*/) { return AbortCode::unsupported_access; }
  /// Fills `part` from `offset` on; both are within the size. An offset may be read again, after a lost segment.
  virtual AbortCode read_part(const Entry& /*entry*/, std::uint32_t /*offset*/, std::span<std::uint8_t> /*part*/) {
    return AbortCode::unsupported_access;
  }
  /// Begins to write. size: nothing if the client does not announce it; else within the declared limits.
  virtual AbortCode open_write(const Entry& /*entry*/, std::optional<std::uint32_t> /*size*/) {
    return AbortCode::unsupported_access;
  }
  /// Takes the next bytes. Each offset comes once, in ascending order. The bytes have no effect before close_write().
  virtual AbortCode write_part(const Entry& /*entry*/, std::uint32_t /*offset*/,
                               std::span<const std::uint8_t> /*part*/) {
    return AbortCode::unsupported_access;
  }
  /// Ends the write after all bytes have come, and size and checksum are right: the value takes effect.
  virtual AbortCode close_write(const Entry& /*entry*/, std::uint32_t /*size*/) {
    return AbortCode::unsupported_access;
  }
  /// Ends a write without an effect, instead of close_write() or after it has failed: the old value remains.
  virtual void cancel_write(const Entry& /*entry*/) {}

 protected:
  ~ObjectAccess() = default;
};

class SdoServer {
  // The functions are cold: small code is worth more than speed. A segment takes 0.1 ms on the bus.
 public:
  /// Time without a frame of the client after which the server aborts the transfer.
  static constexpr Microseconds timeout_us = 1'000'000;
  /// Time without a segment of a block download after which the server acknowledges what it has (block_transfer.hpp).
  static constexpr Microseconds silence_us = 200'000;

  SdoServer(std::uint8_t node, ObjectAccess& device) : node_(node), device_(device) {}

  /// Handles a frame from the bus and returns the answer. The server ignores frames with another identifier or length.
  /// A request that begins a transfer ends the one in progress: nothing that that one has written takes effect.
  [[nodiscard, gnu::cold, gnu::noinline]] std::optional<CanFrame> receive(Microseconds now, const CanFrame& frame);

  /// Whether next_segment() has a frame: the server sends a sub-block as fast as the bus takes it.
  [[nodiscard]] bool has_segment() const {
    return sdo_has_long_uploads && state_ == State::block_upload && sender_.can_send();
  }
  /// The next segment of a block upload, or an abort. has_segment() must hold.
  [[nodiscard, gnu::cold, gnu::noinline]] CanFrame next_segment(Microseconds now);

  /// Handles timeouts. Must be called at next_deadline() or later. Returns a frame to be sent.
  [[nodiscard, gnu::cold, gnu::noinline]] std::optional<CanFrame> poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;

  /// Sets the node id; not during a transfer.
  void set_node(std::uint8_t node) { node_ = node; }
  /// Drops the transfer without a frame, as when the device's communication is reset.
  [[gnu::cold, gnu::noinline]] void reset();

 private:
  enum class State : std::uint8_t {
    idle,
    download,              ///< receives segments
    upload,                ///< sends segments
    block_download,        ///< receives sub-blocks
    block_download_end,    ///< all segments have come
    block_download_ended,  ///< idle, but the client may repeat the end
    block_upload_start,    ///< waits for the request to start
    block_upload,          ///< sends sub-blocks
    block_upload_end,      ///< waits for the client's answer to the end
  };

  // Handlers of requests. Each returns the answer.
  CanFrame initiate_download(const CanFrame& frame);
  CanFrame download_segment(const CanFrame& frame);
  CanFrame initiate_upload(const CanFrame& frame);
  CanFrame upload_segment(const CanFrame& frame);
  CanFrame initiate_block_download(const CanFrame& frame);
  std::optional<CanFrame> download_block_segment(const CanFrame& frame);
  CanFrame end_block_download(const CanFrame& frame);
  std::optional<CanFrame> receive_block_upload(const CanFrame& frame);
  CanFrame initiate_block_upload(const CanFrame& frame);
  std::optional<CanFrame> start_block_upload(const CanFrame& frame);
  std::optional<CanFrame> acknowledge_block_upload(const CanFrame& frame);

  // Access to the value.
  AbortCode find(const CanFrame& frame);
  AbortCode begin_write(std::optional<std::uint32_t> size);
  AbortCode add(std::span<const std::uint8_t> bytes);
  AbortCode finish_write();
  AbortCode begin_read();
  AbortCode read_part(std::uint32_t offset, std::span<std::uint8_t> part);
  /// Number of bytes in the segment at an offset: 7, or the rest in the last segment.
  [[nodiscard]] std::uint8_t bytes_at(std::uint32_t offset) const;

  // Encoders of answers.
  [[nodiscard]] CanFrame make(std::uint8_t command) const;
  [[nodiscard]] CanFrame make(std::uint8_t command, Address address) const;
  [[nodiscard]] CanFrame refuse(Address address, AbortCode code) const;
  CanFrame abort(AbortCode code);
  CanFrame unexpected(const CanFrame& frame);
  CanFrame answer_upload();
  [[nodiscard]] CanFrame answer_block_download() const;
  CanFrame acknowledge_block();
  [[nodiscard]] CanFrame end_block_upload() const;

  [[nodiscard]] bool is_active() const { return state_ != State::idle && state_ != State::block_download_ended; }
  [[nodiscard]] bool is_receiving_block() const {
    return state_ == State::block_download || state_ == State::block_download_end;
  }

  std::uint8_t node_;
  State state_ = State::idle;
  std::uint8_t toggle_ = 0;    ///< toggle bit that is expected in the next segment
  bool has_size_ = false;      ///< whether the client has announced the size
  bool uses_crc_ = false;      ///< whether both sides use the checksum
  std::uint8_t silences_ = 0;  ///< number of silences since the last frame of the client
  /// Bytes of the last segment, which is held because its number of data bytes is not known before the end.
  std::uint8_t held_ = 0;
  bool is_write_open_ = false;  ///< whether the device has a write of a long type open
  BlockCrc crc_;
  BlockReceiver receiver_;
  BlockSender sender_;
  std::array<std::uint8_t, segment_bytes> segment_{};  ///< the segment that is held
  std::array<std::uint8_t, 4> number_{};               ///< the value, unless it is of a long type
  Entry entry_{};
  std::uint32_t size_ = 0;
  std::uint32_t offset_ = 0;             ///< number of bytes that were received, or were acknowledged
  std::uint32_t summed_ = 0;             ///< number of bytes of an upload that are in the CRC
  AbortCode failure_ = AbortCode::none;  ///< failure of a block download, kept until the sub-block ends
  Microseconds last_frame_at_ = 0;       ///< time of the last frame of the client, or of an upload's last segment
  ObjectAccess& device_;
};

}  // namespace proleg::canopen
