#include "sim/mcu/debug/debug_target.hpp"

#include <stdexcept>

#include "sim/mcu/cpu/cpu.hpp"

namespace proleg::sim {

std::uint32_t CpuTarget::core_register(unsigned number) const { return cpu_->core_register(number); }

void CpuTarget::set_core_register(unsigned number, std::uint32_t value) { cpu_->set_core_register(number, value); }

bool CpuTarget::read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const {
  try {
    cpu_->read(address, bytes);
    return true;
  } catch (const std::out_of_range&) {
    return false;
  }
}

bool CpuTarget::write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  try {
    cpu_->write(address, bytes);
    return true;
  } catch (const std::out_of_range&) {
    return false;
  }
}

void CpuTarget::set_breakpoints(std::span<const std::uint32_t> addresses) { cpu_->set_breakpoints(addresses); }

}  // namespace proleg::sim
