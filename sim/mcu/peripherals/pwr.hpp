#pragma once

// Power controller PWR (RM0090, 5.4), as far as a program that never stops its clocks needs it.

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Pwr final : public RegisterBlock {
 public:
  explicit Pwr(ChipServices& chip);

  /// VOSRDY is set always, by reset too: the manual (rev 21) gives neither a condition nor a time for it.
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

  /// The maximum HCLK at the core voltage, in MHz (DS8626, general operating conditions).
  [[nodiscard]] std::uint32_t max_core_mhz() const;

 private:
  std::uint32_t cr_ = 0;
};

}  // namespace proleg::sim
