#pragma once

// The module's side of a broadcast (transfer_frame.hpp): collects an image in RAM. What is done with the image is the
// owner's.

#include <array>

#include "shared/broadcast/transfer_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::broadcast {

/// The program or the bootloader that has a receiver.
class ReceiverOwner {
 public:
  [[nodiscard]] virtual ModuleCondition condition() const = 0;
  /// The header of the image in slot A; empty without an image.
  [[nodiscard]] virtual std::span<const std::uint8_t> image_header() const = 0;

 protected:
  ~ReceiverOwner() = default;
};

class ImageReceiver {
 public:
  /// buffer: for the image, at most max_blocks blocks. serial: of the module. owner: must outlive the receiver.
  ImageReceiver(std::span<std::uint8_t> buffer, std::uint32_t serial, const ReceiverOwner& owner)
      : buffer_(buffer), serial_(serial), owner_(owner) {}
  ImageReceiver(const ImageReceiver&) = delete;
  ImageReceiver& operator=(const ImageReceiver&) = delete;

  /// A session keeps its module against other hosts for so long after its last request.
  static constexpr Microseconds session_timeout_us = 3'000'000;

  /// A frame from the bus. Returns the answer. Frames with other identifiers have no effect.
  [[nodiscard]] std::optional<CanFrame> receive(Microseconds now, const CanFrame& frame);
  /// The bus was away for some time. The number of the present block is not known any more.
  void bus_was_lost() { has_block_ = false; }

  [[nodiscard]] ReceiverState state() const { return status_.state; }
  /// Whether a session that is not silent has not installed its image yet.
  [[nodiscard]] bool is_in_use(Microseconds now) const {
    return status_.state > ReceiverState::idle && status_.state < ReceiverState::installed &&
           now - last_request_ < session_timeout_us;
  }
  /// The image, if state() is `complete` or a later one.
  [[nodiscard]] std::span<const std::uint8_t> image() const { return image_; }

  /// The host has asked to install the image.
  [[nodiscard]] bool has_install_request() const { return installs_; }
  /// As after the start of the module.
  void reset();
  /// The module has received an image of this size, in the buffer, and a request to install it, before it restarted.
  void resume(std::uint8_t session, std::uint32_t size);
  [[nodiscard]] std::uint8_t session() const { return status_.session; }
  /// What came of it: `installed`, `refused` or `failed`, with an error that the host gets. That ends the
  /// request.
  void set_state(ReceiverState state, std::uint8_t error = 0);
  /// The host has asked to start the program; once.
  [[nodiscard]] bool take_leave_request();
  /// The host has asked for the bootloader; once.
  [[nodiscard]] bool take_enter_request();

 private:
  void receive_symbol(const CanFrame& frame);
  [[nodiscard]] std::optional<CanFrame> receive_request(Microseconds now, const CanFrame& frame);
  void select(Microseconds now, std::uint8_t session);
  void begin(std::uint32_t size);
  void restart_collection();
  void enter_block(unsigned block, std::uint8_t kind);
  void take_checksum(unsigned block, std::uint32_t checksum);
  [[nodiscard]] CanFrame answer(Code code);
  [[nodiscard]] HeaderWord header_word(std::uint8_t number) const;
  [[nodiscard]] ReportAnswer report() const;
  [[nodiscard]] std::span<std::uint8_t> bytes_of(unsigned block) const;  ///< as one function: the bootloader is small
  [[nodiscard]] unsigned missing_in(unsigned block) const;
  void count_received(unsigned symbols);

  std::span<std::uint8_t> buffer_;
  const std::uint32_t serial_;
  const ReceiverOwner& owner_;

  StatusAnswer status_;
  std::span<std::uint8_t> image_;  ///< the part of the buffer that the image takes
  std::array<SymbolSet, max_blocks> received_{};
  unsigned missing_ = 0;  ///< symbols of the image
  Microseconds last_request_ = 0;
  BlockDecoder decoder_;
  bool has_block_ = false;  ///< the block to which symbols belong is known
  unsigned block_ = 0;
  BlockKind kind_ = BlockKind::symbols;
  unsigned next_symbol_ = 0;               ///< symbols of a block come in ascending order
  std::optional<std::uint32_t> checksum_;  ///< of the present block, if it has come
  bool expects_checksums_ = false;         ///< the host sends them: it has sent one
  bool installs_ = false;
  bool leaves_ = false;
  bool enters_ = false;
};

}  // namespace proleg::broadcast
