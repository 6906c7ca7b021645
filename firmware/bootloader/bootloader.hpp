#pragma once

// The bootloader as a node on the bus: it receives an image, by broadcast or from a CiA 302 tool, checks it, and
// installs it. Like the module's program it is a state machine: events come in, frames go out; it never waits, except
// in the flash. The servo has no pulses.

#include "firmware/bootloader/handover.hpp"
#include "shared/broadcast/image_receiver.hpp"
#include "shared/can/transmit_queue.hpp"
#include "shared/canopen/lss_slave.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/sdo_server.hpp"

namespace proleg::bootloader {

struct Ports {
  CanPort& can;
  SlotFlash& flash;
  canopen::LssStorage& settings;   ///< keeps the node id
  std::span<std::uint8_t> buffer;  ///< RAM for an image
};

class Bootloader final : private canopen::ObjectAccess, private broadcast::ReceiverOwner {
 public:
  /// Time without a host's request after which the bootloader starts a program that may run.
  static constexpr Microseconds idle_timeout_us = 10'000'000;
  static constexpr Microseconds heartbeat_period_us = 500'000;

  /// serial: the module's serial number, object 0x1018:4.
  Bootloader(const image::Place& place, std::uint32_t serial, const Ports& ports);

  /// Starts the bootloader. node: the stored node id; 0: none. Sends boot-up if there is one. left: by the start
  /// before; if it is `install`, the image that waits in the buffer is installed.
  void power_on(Microseconds now, std::uint8_t node, const Handover& left);
  void receive(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller has sent a frame.
  void transmitted(Microseconds now, const CanFrame& frame);
  /// Must be called when the controller was bus-off.
  void bus_was_lost();
  /// Does what is due. Must be called at next_deadline() or later. It may write flash, which takes seconds.
  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;

  /// Whether the chip must be reset, so that the program starts. Answers are sent before, if the bus takes them.
  [[nodiscard]] bool wants_restart() const { return leaves_ && queue_.size() == 0; }

 private:
  // Functions of ObjectAccess.
  canopen::AbortCode find(canopen::Address address, canopen::Entry& entry) override;
  canopen::AbortCode read(const canopen::Entry& entry, std::uint32_t& value) override;
  canopen::AbortCode write(const canopen::Entry& entry, std::uint32_t value) override;
  canopen::AbortCode open_write(const canopen::Entry& entry, std::optional<std::uint32_t> size) override;
  canopen::AbortCode write_part(const canopen::Entry& entry, std::uint32_t offset,
                                std::span<const std::uint8_t> part) override;
  canopen::AbortCode close_write(const canopen::Entry& entry, std::uint32_t size) override;
  void cancel_write(const canopen::Entry& entry) override;

  // Functions of ReceiverOwner.
  [[nodiscard]] broadcast::ModuleCondition condition() const override { return {flags_, node_}; }
  [[nodiscard]] std::span<const std::uint8_t> image_header() const override {
    return (flags_ & broadcast::module_flag::has_image) != 0
               ? ports_.flash.contents(FlashSlot::a).first(image::header_size)
               : std::span<const std::uint8_t>();
  }

  void receive_lss(Microseconds now, const CanFrame& frame);
  void receive_network_command(Microseconds now, const CanFrame& frame);
  void start_network(Microseconds now, std::uint8_t node);
  void install_broadcast();
  [[nodiscard]] InstallResult write_image(std::span<const std::uint8_t> image);
  void look_at_slot();
  void leave(Microseconds now);
  void send(const CanFrame& frame) { static_cast<void>(queue_.push(frame)); }

  const image::Place place_;
  const canopen::LssAddress address_;
  const Ports ports_;
  Slots slots_;
  TransmitQueue queue_;
  broadcast::ImageReceiver receiver_;
  canopen::SdoServer sdo_;
  canopen::LssSlave lss_;

  Microseconds now_ = 0;   ///< time of the present event
  std::uint8_t node_ = 0;  ///< node id; 0: none
  Microseconds heartbeat_at_ = never;
  Microseconds idle_at_ = never;
  std::uint8_t flags_ = 0;        ///< bits of broadcast::module_flag
  std::uint32_t status_ = 0;      ///< object 0x1F57:1
  bool is_downloading_ = false;   ///< an image is being received by SDO, into the buffer
  std::uint32_t downloaded_ = 0;  ///< bytes of an image from SDO that waits to be installed
  bool ends_line_ = false;        ///< ImageInRam::ends_line
  bool leaves_ = false;
  Microseconds leave_at_ = never;  ///< latest time at which the bootloader ends
};

}  // namespace proleg::bootloader
