#pragma once

#include "firmware/module/ports.hpp"
#include "firmware/stm32f405/servo.hpp"

namespace proleg::stm32f405 {

/// The program in slot A of the flash, and the bootloader in sectors 0 and 1 if it has started the program. With the
/// start stub in its place (docs/board.md) no image can be installed over the bus.
class ProgramPlace final : public firmware::ProgramPort {
 public:
  /// servo: ends its last pulse before a restart; must outlive the object.
  explicit ProgramPlace(const Servo& servo) : servo_(servo) {}

  [[nodiscard]] std::span<std::uint8_t> buffer() override;
  [[nodiscard]] std::span<const std::uint8_t> header() const override;
  [[nodiscard]] bool has_bootloader() const override;
  [[nodiscard]] bool is_confirmed() const override;
  void confirm() override;
  void note_good_start() override;
  [[nodiscard]] broadcast::TrustSummary trust_summary() const override;
  void install(const firmware::Installation& what) override;
  void enter_bootloader() override;

 private:
  const Servo& servo_;
};

}  // namespace proleg::stm32f405
