#pragma once

// The SDO server of a device (CiA 301, 7.2.4.3): expedited, segmented and block transfers in both directions, one
// transfer at a time. It has no clock: times come in with the calls.

#include <array>
#include <optional>
#include <span>

#include "shared/can/can_port.hpp"
#include "shared/canopen/block_transfer.hpp"
#include "shared/canopen/objects.hpp"
#include "shared/canopen/sdo_profile.hpp"

namespace proleg::canopen {

/// The state of the device behind the SDO server. The server calls it only for entries that exist, that the declaration
/// allows to be read or written, and that have no fixed_value().
class ObjectAccess {
 public:
  /// The entry at an address, or why there is none: by the declared dictionary, unless a device has another one.
  virtual AbortCode find(Address address, Entry& entry) { return find_entry(address, entry); }

  /// A number, with 32 bits. The server sends its low bytes.
  virtual AbortCode read(const Entry& entry, std::uint32_t& value) = 0;
  /// A number that has passed the declared range. Signed types are sign-extended.
  virtual AbortCode write(const Entry& entry, std::uint32_t value) = 0;

  // Entries of long types, piece by piece, so that no memory of the size of the value is needed. A device without such
  // entries need not define these.

  /// Number of bytes. The value must not change until the next call of open_read().
  virtual AbortCode open_read(const Entry& /*entry*/, std::uint32_t& /*size*/) { return AbortCode::unsupported_access; }
  /// Fills `part` from `offset` on; both are within the size. An offset may come again, after a lost segment.
  virtual AbortCode read_part(const Entry& /*entry*/, std::uint32_t /*offset*/, std::span<std::uint8_t> /*part*/) {
    return AbortCode::unsupported_access;
  }
  /// size: nothing if the client does not announce it; else within the declared limits.
  virtual AbortCode open_write(const Entry& /*entry*/, std::optional<std::uint32_t> /*size*/) {
    return AbortCode::unsupported_access;
  }
  /// The next bytes. Each offset comes once, in ascending order. They have no effect before close_write().
  virtual AbortCode write_part(const Entry& /*entry*/, std::uint32_t /*offset*/,
                               std::span<const std::uint8_t> /*part*/) {
    return AbortCode::unsupported_access;
  }
  /// All bytes have come, and size and checksum are right: the value takes effect.
  virtual AbortCode close_write(const Entry& /*entry*/, std::uint32_t /*size*/) {
    return AbortCode::unsupported_access;
  }
  /// Instead of close_write(), or after it has failed: the old value remains.
  virtual void cancel_write(const Entry& /*entry*/) {}

 protected:
  ~ObjectAccess() = default;
};

class SdoServer {
  // Cold: small code is worth more than speed. A segment takes 0.1 ms on the bus.
 public:
  /// After this long without a frame of the client the server aborts the transfer.
  static constexpr Microseconds timeout_us = 1'000'000;
  /// After this long without a segment of a block download the server acknowledges what it has (block_transfer.hpp).
  static constexpr Microseconds silence_us = 200'000;

  SdoServer(std::uint8_t node, ObjectAccess& device) : node_(node), device_(device) {}

  /// A frame from the bus. Returns the answer. The server ignores frames with another identifier or length.
  /// A request that begins a transfer ends the one in progress: nothing that one has written takes effect.
  [[nodiscard, gnu::cold, gnu::noinline]] std::optional<CanFrame> receive(Microseconds now, const CanFrame& frame);

  /// Whether next_segment() has a frame: the server sends a sub-block as fast as the bus takes it.
  [[nodiscard]] bool has_segment() const {
    return sdo_has_long_uploads && state_ == State::block_upload && sender_.can_send();
  }
  /// The next segment of a block upload, or an abort. Only if has_segment().
  [[nodiscard, gnu::cold, gnu::noinline]] CanFrame next_segment(Microseconds now);

  /// To be called at next_deadline() or later. Returns a frame to be sent.
  [[nodiscard, gnu::cold, gnu::noinline]] std::optional<CanFrame> poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;

  /// Another node id; not during a transfer.
  void set_node(std::uint8_t node) { node_ = node; }
  /// Drops the transfer without a frame, as when the device's communication is reset.
  [[gnu::cold, gnu::noinline]] void reset();

 private:
  enum class State : std::uint8_t {
    idle,
    download,              ///< segments
    upload,                ///< segments
    block_download,        ///< sub-blocks
    block_download_end,    ///< all segments have come
    block_download_ended,  ///< idle; the end may be repeated
    block_upload_start,    ///< waits for the start
    block_upload,          ///< sub-blocks
    block_upload_end,      ///< waits for the client's answer to the end
  };

  // Requests. Each returns the answer.
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

  // The value.
  AbortCode find(const CanFrame& frame);
  AbortCode begin_write(std::optional<std::uint32_t> size);
  AbortCode add(std::span<const std::uint8_t> bytes);
  AbortCode finish_write();
  AbortCode begin_read();
  AbortCode read_part(std::uint32_t offset, std::span<std::uint8_t> part);
  /// A multiple of 7 bytes, and the rest in the last segment.
  [[nodiscard]] std::uint8_t bytes_at(std::uint32_t offset) const;

  // Answers.
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
  [[nodiscard]] bool is_writing() const;
  [[nodiscard]] bool is_receiving_block() const {
    return state_ == State::block_download || state_ == State::block_download_end;
  }

  std::uint8_t node_;
  State state_ = State::idle;
  std::uint8_t toggle_ = 0;     ///< expected in the next segment
  bool has_size_ = false;       ///< the client has announced it
  bool uses_crc_ = false;       ///< both sides do
  std::uint8_t silences_ = 0;   ///< since the last frame of the client
  std::uint8_t held_ = 0;       ///< bytes of the last segment, whose number is not known before the end
  bool is_write_open_ = false;  ///< of a long type, at the device
  BlockCrc crc_;
  BlockReceiver receiver_;
  BlockSender sender_;
  std::array<std::uint8_t, segment_bytes> segment_{};  ///< the one that is held
  std::array<std::uint8_t, 4> number_{};               ///< the value, unless it is of a long type
  Entry entry_{};
  std::uint32_t size_ = 0;
  std::uint32_t offset_ = 0;             ///< bytes that were received, or were acknowledged
  std::uint32_t summed_ = 0;             ///< bytes of an upload that are in the CRC
  AbortCode failure_ = AbortCode::none;  ///< of a block download, until the sub-block ends
  Microseconds heard_at_ = 0;            ///< the last frame of the client, or of an upload's segments
  ObjectAccess& device_;
};

}  // namespace proleg::canopen
