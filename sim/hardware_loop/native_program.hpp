#pragma once

// How a native module is flashed: its slots, its bootloader and its restarts are those of a real module
// (docs/flashing.md). Whatever image is in slot A, the program that runs is that of this computer.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "firmware/bootloader/bootloader.hpp"
#include "firmware/module/module_identity.hpp"
#include "firmware/module/ports.hpp"

namespace proleg::sim {

/// What a program does after its start.
enum class ProgramHealth : std::uint8_t {
  good,
  hangs,   ///< until the watchdog resets the chip
  faults,  ///< resets the chip at once
  deaf,    ///< feeds the watchdog, and never takes part in the bus
};

class NativeProgram final : public firmware::ProgramPort, private bootloader::SlotFlash, private canopen::LssStorage {
 public:
  // Typical times of the data sheet (STM32F405, table 41, words of 32 bits).
  static constexpr Microseconds erase_time_us = 1'000'000;
  static constexpr Microseconds word_time_us = 16;
  /// Typical time from a reset to the start of the program: the checksum of the image at 16 MHz. After power on it is
  /// the window in which the bootloader listens, and takes as long.
  static constexpr Microseconds start_time_us = 96'500;

  /// Slot A holds a confirmed image of the native program, without a body to speak of. port: for the bootloader.
  /// settings: the log of board records. Both must outlive the object.
  NativeProgram(CanPort& port, firmware::FlashPort& settings, const firmware::ModuleIdentity& identity);
  NativeProgram(const NativeProgram&) = delete;
  NativeProgram& operator=(const NativeProgram&) = delete;

  /// Writes the flash as a programmer does: the image in slot A, confirmed or on trial; empty: none.
  void write_image(std::span<const std::uint8_t> image, bool is_confirmed);
  /// Tests: how programs behave, by the header of their image. Without it all are good.
  void set_health(std::function<ProgramHealth(const image::Header& header)> health) { health_ = std::move(health); }

  /// RAM has lost its contents.
  void lose_ram() { handover_ = {}; }
  /// A reset of the chip. Then either bootloader() serves the bus, or the program runs.
  void reset();
  /// The program is to start. Whether this frame asks for the bootloader instead, which then serves the bus.
  [[nodiscard]] bool is_held_by(const CanFrame& frame);
  /// The bootloader while it runs; null while the program runs, or should.
  [[nodiscard]] bootloader::Bootloader* bootloader() { return bootloader_ ? &*bootloader_ : nullptr; }
  /// The bootloader, if it serves the bus, takes part in it from now on.
  void start_bootloader(Microseconds now);
  [[nodiscard]] ProgramHealth health() const;

  /// Whether the chip is to be reset, by program or bootloader; once.
  [[nodiscard]] bool take_reset_request();
  /// How long the flash operations since the last call take.
  [[nodiscard]] Microseconds take_flash_time() { return std::exchange(flash_time_us_, 0); }

  /// The image in slot A; empty: none.
  [[nodiscard]] std::span<const std::uint8_t> image() const { return slots_.image_in(bootloader::FlashSlot::a); }
  /// The image in slot B; empty: none.
  [[nodiscard]] std::span<const std::uint8_t> backup() const { return slots_.image_in(bootloader::FlashSlot::b); }

  // firmware::ProgramPort.
  [[nodiscard]] std::span<std::uint8_t> buffer() override { return buffer_; }
  [[nodiscard]] std::span<const std::uint8_t> header() const override;
  [[nodiscard]] bool has_bootloader() const override { return true; }
  [[nodiscard]] bool is_confirmed() const override { return slots_.is_confirmed(bootloader::FlashSlot::a); }
  void confirm() override { static_cast<void>(slots_.confirm()); }
  void note_good_start() override { handover_ = {bootloader::HandoverAction::runs, 0}; }
  [[nodiscard]] broadcast::TrustSummary trust_summary() const override { return slots_.trust().summary(); }
  void install(const firmware::Installation& what) override;
  void enter_bootloader() override;

 private:
  static constexpr std::uint8_t erased = 0xFF;

  // bootloader::SlotFlash.
  [[nodiscard]] bool erase(bootloader::FlashSlot slot) override;
  [[nodiscard]] bool program(bootloader::FlashSlot slot, std::uint32_t offset,
                             std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::span<const std::uint8_t> contents(bootloader::FlashSlot slot) const override;

  [[nodiscard]] Result store_node(std::uint8_t node) override;
  void make_bootloader() { bootloader_.emplace(place_, serial_, bootloader::Ports{port_, *this, *this, buffer_}); }

  CanPort& port_;
  firmware::FlashPort& settings_;
  const std::uint32_t serial_;
  const image::Place place_;
  std::array<std::vector<std::uint8_t>, 3> slot_bytes_;  ///< by FlashSlot
  std::vector<std::uint8_t> buffer_;
  bootloader::Slots slots_;
  bootloader::Handover handover_;
  bootloader::Handover left_;  ///< by the start before
  std::optional<bootloader::Bootloader> bootloader_;
  std::function<ProgramHealth(const image::Header& header)> health_;
  Microseconds flash_time_us_ = 0;
  bool resets_ = false;
};

/// An image of the native program: its body is a pattern of this many bytes, a multiple of 4.
[[nodiscard]] std::vector<std::uint8_t> make_native_image(std::uint16_t board_id, const image::Version& version,
                                                          std::size_t size);

}  // namespace proleg::sim
