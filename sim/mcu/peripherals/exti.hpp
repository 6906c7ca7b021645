#pragma once

// External interrupt controller EXTI (RM0090, section 12.2): line 16, from the voltage detector. Lines of pins and of
// other peripherals are rejected.

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Exti final : public RegisterBlock {
 public:
  static constexpr unsigned detector_line = 16;
  static constexpr unsigned detector_interrupt = 1;  ///< RM0090, table 61: PVD

  explicit Exti(ChipServices& chip);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  /// Resets the registers; the lines keep their level.
  void reset() override;

  /// The level of line 16: 1 while the supply is below the detector's threshold.
  void set_detector(bool high);

 private:
  void update_interrupt();

  InterruptLine interrupt_;
  bool is_high_ = false;
  std::uint32_t mask_ = 0;
  std::uint32_t rising_ = 0;
  std::uint32_t falling_ = 0;
  std::uint32_t pending_ = 0;
};

}  // namespace proleg::sim
