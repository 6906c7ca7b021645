#pragma once

// The module's side of a broadcast (transfer_frame.hpp): collects an image in RAM. What is done with the image is the
// owner's.

#include <array>

#include "shared/broadcast/transfer_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::broadcast {

class ImageReceiver {
 public:
  /// buffer: for the image, at most max_blocks blocks. serial: of the module.
  ImageReceiver(std::span<std::uint8_t> buffer, std::uint32_t serial) : buffer_(buffer), serial_(serial) {}
  ImageReceiver(const ImageReceiver&) = delete;
  ImageReceiver& operator=(const ImageReceiver&) = delete;

  /// A session keeps its module against other hosts for so long after its last request.
  static constexpr Microseconds session_timeout_us = 3'000'000;

  /// A frame from the bus. Returns the answer. Frames with other identifiers have no effect.
  [[nodiscard]] std::optional<CanFrame> receive(Microseconds now, const CanFrame& frame);
  /// The bus was away for some time. The number of the present block is not known any more.
  void bus_was_lost() { has_block_ = false; }

  [[nodiscard]] ReceiverState state() const { return status_.state; }
  /// The image, if state() is `complete` or a later one.
  [[nodiscard]] std::span<const std::uint8_t> image() const { return image_; }

  /// The host has asked to install the image.
  [[nodiscard]] bool has_install_request() const { return installs_; }
  /// What came of it: `installed`, `refused` or `failed`, with an error that the host gets. That ends the
  /// request.
  void set_state(ReceiverState state, std::uint8_t error = 0);
  /// The host has asked to start the program; once.
  [[nodiscard]] bool take_leave_request();

 private:
  void receive_symbol(const CanFrame& frame);
  [[nodiscard]] std::optional<CanFrame> receive_request(Microseconds now, const CanFrame& frame);
  void select(Microseconds now, std::uint8_t session);
  void begin(std::uint32_t size);
  void enter_block(unsigned block, std::uint8_t kind);
  [[nodiscard]] ReportAnswer report() const;
  [[nodiscard]] unsigned missing_in(unsigned block) const;
  void count_received(unsigned symbols);

  std::span<std::uint8_t> buffer_;
  const std::uint32_t serial_;

  StatusAnswer status_;
  std::span<std::uint8_t> image_;  ///< the part of the buffer that the image takes
  std::array<SymbolSet, max_blocks> received_{};
  unsigned missing_ = 0;  ///< symbols of the image
  Microseconds last_request_ = 0;
  BlockDecoder decoder_;
  bool has_block_ = false;  ///< the block to which symbols belong is known
  unsigned block_ = 0;
  BlockKind kind_ = BlockKind::symbols;
  unsigned next_symbol_ = 0;  ///< symbols of a block come in ascending order
  bool installs_ = false;
  bool leaves_ = false;
};

}  // namespace proleg::broadcast
