#pragma once

// System configuration controller SYSCFG (RM0090, section 9): can be read, and written with its present contents only.

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

class Syscfg final : public RegisterBlock {
 public:
  explicit Syscfg(ChipServices& chip);

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override {}
};

}  // namespace proleg::sim
