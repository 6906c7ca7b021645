#pragma once

// The bootloader as a node on the bus: it receives an image, by broadcast or from a CiA 302 tool, checks it, and
// installs it. Like the module's program it is a state machine: events come in, frames go out; it never waits, except
// in the flash. The servo has no pulses. Its object dictionary has the entries of CiA 302-3 (program download), and the
// identity.

#include <array>

#include "firmware/bootloader/handover.hpp"
#include "shared/broadcast/image_receiver.hpp"
#include "shared/can/transmit_queue.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/lss_slave.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/sdo_server.hpp"

namespace proleg::bootloader::object {

using canopen::DataType;
using canopen::Object;

/// A host recognises the bootloader by this value: it has no device profile.
inline constexpr Object device_type = canopen::constant({0x1000, 0}, "Device type", DataType::unsigned32, 0,
                                                        "0: the bootloader, which is no servo drive");
inline constexpr Object error_register = canopen::constant({0x1001, 0}, "Error register", DataType::unsigned8, 0);

/// Program data (CiA 302-3, 1F50h): an image as a file contains it, header included.
inline constexpr Object program_data{
    {{0x1F50, 1}, DataType::domain, canopen::Access::write_only, false, 0, 1, 0xFFFFFFFF, {}},
    "Program data",
    "an image; it is installed when it is complete and right"};
/// Values of the program control (CiA 302-3, 1F51h).
inline constexpr std::uint8_t control_stop = 0;
inline constexpr std::uint8_t control_start = 1;
inline constexpr std::uint8_t control_reset = 2;
inline constexpr std::uint8_t control_clear = 3;
inline constexpr Object program_control = canopen::read_write(
    {0x1F51, 1}, "Program control", DataType::unsigned8, control_stop, {control_stop, control_clear},
    "1 and 2: starts the program; 0 and 3 have no effect: the old program stays until a new one is complete");
/// Identification of the program (CiA 302-3, 1F56h).
inline constexpr Object program_identification =
    canopen::read_only({0x1F56, 1}, "Program software identification", DataType::unsigned32,
                       "CRC-32 of the header of the image in slot A; 0: there is none");
/// Bits of the flash status (CiA 302-3, 1F57h): bit 0: in progress, bits 1 to 7: error.
inline constexpr std::uint32_t status_in_progress = 1;
inline constexpr std::uint32_t status_unknown_format = 2U << 1U;
inline constexpr std::uint32_t status_wrong_data = 3U << 1U;
inline constexpr std::uint32_t status_write_error = 5U << 1U;
inline constexpr std::uint32_t status_other_error = 63U << 1U;
inline constexpr Object flash_status =
    canopen::read_only({0x1F57, 1}, "Flash status identification", DataType::unsigned32,
                       "bit 0: in progress; bits 1 to 7: error; bits 8 to 15: why the image was refused");

/// All entries, without texts, for which a bootloader has no room.
inline constexpr std::array<canopen::Entry, 14> entries{
    device_type,
    error_register,
    canopen::object::heartbeat_period,
    canopen::object::vendor,
    canopen::object::product,
    canopen::object::revision,
    canopen::object::serial,
    program_data,
    program_control,
    program_identification,
    flash_status,
    canopen::object::version,
    canopen::object::board_id,
    canopen::object::update_key,
};

}  // namespace proleg::bootloader::object

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
  [[nodiscard]] broadcast::TrustSummary trust() const override { return slots_.trust().summary(); }

  void receive_lss(Microseconds now, const CanFrame& frame);
  void receive_network_command(Microseconds now, const CanFrame& frame);
  void start_network(Microseconds now, std::uint8_t node);
  void install_broadcast();
  [[nodiscard]] image::Error check_key(const image::PublicKey& key) const;
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
  Microseconds key_until_ = 0;    ///< the module takes its first key before this time
  std::uint8_t flags_ = 0;        ///< bits of broadcast::module_flag
  std::uint32_t status_ = 0;      ///< object 0x1F57:1
  bool is_downloading_ = false;   ///< an image is being received by SDO, into the buffer
  std::uint32_t downloaded_ = 0;  ///< bytes of an image from SDO that waits to be installed
  bool ends_line_ = false;        ///< ImageInRam::ends_line
  bool leaves_ = false;
  Microseconds leave_at_ = never;  ///< latest time at which the bootloader ends
};

}  // namespace proleg::bootloader
