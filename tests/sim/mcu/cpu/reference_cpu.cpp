#include "tests/sim/mcu/cpu/reference_cpu.hpp"

#include <stdexcept>
#include <string>

#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t page = 4096;
constexpr std::array<int, ReferenceCpu::register_count> ids{
    UC_ARM_REG_R0,  UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R4,  UC_ARM_REG_R5,
    UC_ARM_REG_R6,  UC_ARM_REG_R7, UC_ARM_REG_R8, UC_ARM_REG_R9, UC_ARM_REG_R10, UC_ARM_REG_R11,
    UC_ARM_REG_R12, UC_ARM_REG_SP, UC_ARM_REG_LR, UC_ARM_REG_PC, UC_ARM_REG_XPSR};

void check(uc_err error) {
  if (error != UC_ERR_OK) {
    throw std::runtime_error(std::string("Unicorn: ") + uc_strerror(error));
  }
}

}  // namespace

ReferenceCpu::ReferenceCpu(std::uint32_t start, std::size_t size) : buffer_(size + page) {
  const std::size_t rest = reinterpret_cast<std::uintptr_t>(buffer_.data()) % page;
  memory_ = std::span(buffer_).subspan((page - rest) % page, size);
  check(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &uc_));
  // The mode for microcontrollers would silently choose a Cortex-M33.
  check(uc_ctl_set_cpu_model(uc_, UC_CPU_ARM_CORTEX_M4));
  check(uc_mem_map_ptr(uc_, start, size, UC_PROT_ALL, memory_.data()));
  check(uc_mem_map(uc_, ChipMemory::flash_start, ChipMemory::flash_size, UC_PROT_READ));
  check(uc_mem_map(uc_, ChipMemory::ccm_start, ChipMemory::ccm_size, UC_PROT_READ | UC_PROT_WRITE));
  check(uc_mem_map(uc_, ChipMemory::system_memory_start, ChipMemory::system_memory_size, UC_PROT_READ));
}

ReferenceCpu::~ReferenceCpu() { uc_close(uc_); }

ReferenceCpu::Step ReferenceCpu::execute(const Registers& registers, std::uint32_t size) {
  constexpr std::size_t flags = register_count - 1;
  for (std::size_t i = 0; i < flags; ++i) {
    check(uc_reg_write(uc_, ids[i], &registers[i]));
  }
  check(uc_reg_write(uc_, UC_ARM_REG_XPSR_NZCVQG, &registers[flags]));
  // Unicorn keeps a digest of its state, which this brings up to date.
  check(uc_reg_write(uc_, UC_ARM_REG_APSR_NZCV, &registers[flags]));
  const std::uint32_t address = registers[15];
  check(uc_ctl_remove_cache(uc_, std::uint64_t{address}, std::uint64_t{address} + 4));
  // With a number alone it would count the instructions of IT blocks that are executed.
  Step step{uc_emu_start(uc_, address | 1U, address + size, 0, 1) == UC_ERR_OK, {}};
  for (std::size_t i = 0; i < register_count; ++i) {
    check(uc_reg_read(uc_, ids[i], &step.registers[i]));
  }
  return step;
}

}  // namespace proleg::sim
