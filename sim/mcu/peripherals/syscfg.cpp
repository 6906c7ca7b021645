#include "sim/mcu/peripherals/syscfg.hpp"

namespace proleg::sim {
namespace {

constexpr RegisterName registers[] = {{0x00, "MEMRMP"},  {0x04, "PMC"},     {0x08, "EXTICR1"}, {0x0C, "EXTICR2"},
                                      {0x10, "EXTICR3"}, {0x14, "EXTICR4"}, {0x20, "CMPCR"}};

}  // namespace

Syscfg::Syscfg(ChipServices& chip) : RegisterBlock(chip, "SYSCFG", 0x4001'3800, 0x400, registers) {}

std::uint32_t Syscfg::read(std::uint32_t offset) {
  for (const RegisterName& known : registers) {
    if (known.offset == offset) {
      return 0;  // MEMRMP: main flash is at address 0
    }
  }
  reject_read(offset);
}

void Syscfg::write(std::uint32_t offset, std::uint32_t value) {
  if (value != 0) {
    reject_write(offset, value, "remapping, EXTI lines and the compensation cell are not modelled");
  }
  static_cast<void>(read(offset));
}

}  // namespace proleg::sim
