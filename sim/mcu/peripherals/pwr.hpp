#pragma once

// Power controller PWR (RM0090, 5.4), as far as a program that never stops its clocks needs it, with the voltage
// detector (5.2.3).

#include "sim/mcu/peripherals/exti.hpp"
#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Pwr final : public RegisterBlock {
 public:
  static constexpr std::uint32_t nominal_supply_mv = 3'300;

  /// exti: receives the detector's output; may be null.
  explicit Pwr(ChipServices& chip, Exti* exti = nullptr);

  /// Reads a register. VOSRDY is always set, also after reset: the manual (rev 21) gives no condition and no time for
  /// it.
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

  /// The maximum HCLK at the core voltage, in MHz (DS8626, general operating conditions).
  [[nodiscard]] std::uint32_t max_core_mhz() const;

  /// Sets VDD at ChipServices::now(); it lasts over a reset.
  void set_supply(std::uint32_t mv);

 private:
  void detect();

  Exti* exti_;
  std::uint32_t cr_ = 0;
  std::uint32_t supply_mv_ = nominal_supply_mv;
  bool is_low_ = false;  ///< PVDO
};

}  // namespace proleg::sim
