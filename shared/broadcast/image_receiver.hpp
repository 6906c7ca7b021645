#pragma once

// The module's side of a broadcast (transfer_frame.hpp): it collects an image in RAM. The owner installs the image.

#include <array>

#include "shared/broadcast/transfer_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::broadcast {

/// The program or the bootloader that has a receiver.
class ReceiverOwner {
 public:
  [[nodiscard]] virtual ModuleCondition condition() const = 0;
  /// The header of the image in slot A; empty if there is no image.
  [[nodiscard]] virtual std::span<const std::uint8_t> image_header() const = 0;
  /// Which images the module takes: any, if it has no bootloader that checks them.
  [[nodiscard]] virtual TrustSummary trust() const { return {}; }

 protected:
  ~ReceiverOwner() = default;
};

class ImageReceiver {
 public:
  /// buffer: receives the image, at most max_blocks blocks. serial: serial number of the module. owner: must outlive
  /// the receiver.
  ImageReceiver(std::span<std::uint8_t> buffer, std::uint32_t serial, const ReceiverOwner& owner)
      : buffer_(buffer), serial_(serial), owner_(owner) {}
  ImageReceiver(const ImageReceiver&) = delete;
  ImageReceiver& operator=(const ImageReceiver&) = delete;

  /// Time after its last request for which a session keeps its module against other hosts.
  static constexpr Microseconds session_timeout_us = 3'000'000;

  /// Handles a frame from the bus and returns the answer. Frames with other identifiers have no effect.
  [[nodiscard]] std::optional<CanFrame> receive(Microseconds now, const CanFrame& frame);
  /// Must be called when the bus was lost for some time. The number of the present block is then unknown.
  void bus_was_lost() { has_block_ = false; }

  [[nodiscard]] ReceiverState state() const { return status_.state; }
  /// Whether a session that is not silent has an image that is not installed yet.
  [[nodiscard]] bool is_in_use(Microseconds now) const {
    return status_.state > ReceiverState::idle && status_.state < ReceiverState::installed &&
           now - last_request_ < session_timeout_us;
  }
  /// The image, if state() is `complete` or a later one.
  [[nodiscard]] std::span<const std::uint8_t> image() const { return image_; }

  /// Whether the host has asked to install the image.
  [[nodiscard]] bool has_install_request() const { return installs_; }
  /// Returns to the state after the start of the module.
  void reset();
  /// Continues after a restart that came between a request to install the image and its installation. size: of the
  /// image, which is in the buffer.
  void resume(std::uint8_t session, std::uint32_t size);
  [[nodiscard]] std::uint8_t session() const { return status_.session; }
  /// Ends the request with its result: `installed`, `refused` or `failed`, and an error that is sent to the host.
  void set_state(ReceiverState state, std::uint8_t error = 0);
  /// Whether the host has asked to start the program; true once for each request.
  [[nodiscard]] bool take_leave_request();
  /// Whether the host has asked for the bootloader; true once for each request.
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
  [[nodiscard]] std::span<std::uint8_t> bytes_of(unsigned block) const;  ///< not inline: the bootloader has little room
  [[nodiscard]] unsigned missing_in(unsigned block) const;
  void count_received(unsigned symbols);

  std::span<std::uint8_t> buffer_;
  const std::uint32_t serial_;
  const ReceiverOwner& owner_;

  StatusAnswer status_;
  std::span<std::uint8_t> image_;  ///< the part of the buffer that the image takes
  std::array<SymbolSet, max_blocks> received_{};
  unsigned missing_ = 0;  ///< number of symbols of the image that are missing
  Microseconds last_request_ = 0;
  BlockDecoder decoder_;
  bool has_block_ = false;  ///< whether the number of the present block is known
  unsigned block_ = 0;
  BlockKind kind_ = BlockKind::symbols;
  unsigned next_symbol_ = 0;               ///< symbols of a block come in ascending order
  std::optional<std::uint32_t> checksum_;  ///< checksum of the present block, if it was received
  bool expects_checksums_ = false;         ///< whether the host sends checksums: it has sent one
  bool installs_ = false;
  bool leaves_ = false;
  bool enters_ = false;
};

}  // namespace proleg::broadcast
