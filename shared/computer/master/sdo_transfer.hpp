#pragma once

// The client of SDO transfers of any size (CiA 301, 7.2.4.3): expedited, segmented or block, chosen by the size. It has
// no clock: the caller passes the time.

#include <array>
#include <optional>
#include <span>

#include "shared/can/can_port.hpp"
#include "shared/canopen/block_transfer.hpp"
#include "shared/canopen/object.hpp"

namespace proleg::canopen {

struct SdoTransferOptions {
  Microseconds timeout_us = 500'000;  ///< time for each answer; more for objects that need it (min_write_timeout_us)
  /// Number of attempts of a transfer that fails because frames were lost.
  unsigned attempts = 5;
  /// Greatest number of bytes of a value that is sent in segments, which need no checksum and fewer frames. Longer
  /// values are sent as a block, if the server supports it.
  std::uint8_t largest_segmented = 21;
  /// Number of segments in a sub-block of an upload, 1 to 127. While the robot moves, short ones leave room for other
  /// frames.
  std::uint8_t block_size = max_block_size;
};

/// The client of one transfer at a time. The program sends its frames in this way, after each of the other calls and
/// when the controller has sent a frame:
///
///   while (there is room for a frame) if (auto frame = transfer.next_frame(now)) send(*frame); else break;
class SdoTransfer {
 public:
  enum class State : std::uint8_t { idle, running, done, aborted };

  /// Begins a download. The data must remain until the transfer ends. A transfer in progress is dropped.
  void download(std::uint8_t node, Address address, std::span<const std::uint8_t> data,
                const SdoTransferOptions& options = {});
  /// Begins an upload. `buffer` receives the value. A longer value is rejected with `out_of_memory`.
  void upload(std::uint8_t node, Address address, std::span<std::uint8_t> buffer,
              const SdoTransferOptions& options = {});
  /// Ends the transfer with this code, which next_frame() then sends to the server.
  void abort(AbortCode code);

  /// The next frame to send; nothing if the client waits for the server. A transfer that is done or aborted may have a
  /// last frame.
  [[nodiscard]] std::optional<CanFrame> next_frame(Microseconds now);
  /// Takes any frame from the bus. Frames that do not belong to the transfer are ignored.
  void receive(Microseconds now, const CanFrame& frame);
  /// Handles timeouts. Must be called at next_deadline() or later.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const { return state_ == State::running ? deadline_ : never; }

  [[nodiscard]] State state() const { return state_; }
  /// The reason of the abort; valid in the state `aborted`.
  [[nodiscard]] AbortCode abort_code() const { return abort_code_; }
  /// Number of bytes; valid in the state `done`.
  [[nodiscard]] std::uint32_t size() const { return offset_; }
  /// Number of attempts that were begun.
  [[nodiscard]] unsigned attempts() const { return attempts_; }
  /// Number of bytes in the present attempt, for a display.
  [[nodiscard]] std::uint32_t progress() const { return offset_; }
  [[nodiscard]] std::uint8_t node() const { return node_; }
  [[nodiscard]] Address address() const { return address_; }

 private:
  /// The part of the transfer that the client sends, or waits for.
  enum class Step : std::uint8_t {
    initiate,  ///< the answer to the first frame
    segment,   ///< a segment, or its answer
    block,     ///< sub-blocks
    end,       ///< end of a block: the server's frame in an upload, its answer in a download
  };

  void start(std::uint8_t node, Address address, const SdoTransferOptions& options);
  void begin();
  /// Ends the transfer at the client and at the server.
  void fail(AbortCode code);
  /// Ends the present attempt at the client and at the server.
  void abort_attempt(AbortCode code);
  void retry(AbortCode code);
  void finish();
  void request(const CanFrame& frame);
  [[nodiscard]] CanFrame make(std::uint8_t command) const;
  [[nodiscard]] Microseconds wait_us() const;

  void receive_abort(const CanFrame& frame);
  void receive_initiate(Microseconds now, const CanFrame& frame);
  void receive_upload(const CanFrame& frame);
  void receive_segment(const CanFrame& frame);
  void receive_acknowledgement(Microseconds now, const CanFrame& frame);
  void receive_block_segment(Microseconds now, const CanFrame& frame);
  void receive_end(const CanFrame& frame);
  void send_segment();
  [[nodiscard]] CanFrame next_block_segment();
  void acknowledge();
  /// Adds received bytes. False if the transfer has failed, because they do not fit.
  [[nodiscard]] bool store(std::span<const std::uint8_t> bytes);
  void end_upload();

  SdoTransferOptions options_;
  State state_ = State::idle;
  Step step_ = Step::initiate;
  bool is_download_ = false;
  bool uses_block_ = false;
  bool has_no_block_ = false;  ///< whether the server has refused a block transfer
  bool uses_crc_ = false;
  bool has_size_ = false;  ///< whether the server has announced the size of an upload
  std::uint8_t node_ = 0;
  std::uint8_t toggle_ = 0;
  std::uint8_t held_ = 0;  ///< bytes of the last block segment, which is held because its number of data bytes is not
                           ///< known before the end
  std::uint8_t silences_ = 0;
  Address address_;
  unsigned attempts_ = 0;
  std::span<const std::uint8_t> data_;
  std::span<std::uint8_t> buffer_;
  std::uint32_t announced_ = 0;
  std::uint32_t offset_ = 0;  ///< number of bytes that were received, or were acknowledged
  BlockReceiver receiver_;
  BlockSender sender_;
  std::array<std::uint8_t, segment_bytes> segment_{};  ///< the segment that is held
  AbortCode abort_code_ = AbortCode::none;
  std::optional<CanFrame> abort_;    ///< frame that is sent first
  std::optional<CanFrame> request_;  ///< frame that is sent next
  CanFrame last_request_;
  Microseconds deadline_ = never;
};

}  // namespace proleg::canopen
