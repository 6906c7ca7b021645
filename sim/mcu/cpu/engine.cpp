#include "sim/mcu/cpu/engine.hpp"

#include <algorithm>
#include <cstring>

namespace proleg::sim {
namespace {

bool lies_in(std::uint32_t address, std::uint64_t size, std::uint32_t start, std::uint32_t length) {
  return address >= start && std::uint64_t{address} + size <= std::uint64_t{start} + length;
}

}  // namespace

std::uint32_t Engine::read(CoreRegister name) const {
  switch (name) {
    case CoreRegister::pc:
      return pc();
    case CoreRegister::xpsr:
      return core_.xpsr();
    case CoreRegister::msp:
    case CoreRegister::psp:
      return core_.stack_pointer_of(name == CoreRegister::psp);
    case CoreRegister::primask:
      return core_.primask;
    case CoreRegister::basepri:
      return core_.basepri;
    case CoreRegister::faultmask:
      return core_.faultmask;
    case CoreRegister::control:
      return core_.control;
    default:
      return core_.r.at(static_cast<std::size_t>(name));
  }
}

void Engine::write(CoreRegister name, std::uint32_t value) {
  switch (name) {
    case CoreRegister::pc:
      set_pc(value);
      break;
    case CoreRegister::xpsr:
      core_.set_xpsr(value);
      break;
    case CoreRegister::msp:
    case CoreRegister::psp:
      core_.set_stack_pointer_of(name == CoreRegister::psp, value);
      break;
    case CoreRegister::primask:
      core_.primask = value;
      break;
    case CoreRegister::basepri:
      core_.basepri = value;
      break;
    case CoreRegister::faultmask:
      core_.faultmask = value;
      break;
    case CoreRegister::control:
      core_.control = value;
      core_.select_stack();
      break;
    default:
      core_.r.at(static_cast<std::size_t>(name)) = name == CoreRegister::sp ? value & ~3U : value;
      break;
  }
}

std::uint8_t* Engine::ram(std::uint32_t address, std::uint32_t size) const {
  if (lies_in(address, size, ChipMemory::ram_start, ChipMemory::ram_size)) {
    return core_.memory->ram.data() + (address - ChipMemory::ram_start);
  }
  if (lies_in(address, size, ChipMemory::ccm_start, ChipMemory::ccm_size)) {
    return core_.memory->ccm.data() + (address - ChipMemory::ccm_start);
  }
  return nullptr;
}

std::uint8_t* Engine::memory(std::uint32_t address, std::uint64_t size) const {
  if (lies_in(address, size, ChipMemory::flash_start, ChipMemory::flash_size)) {
    return core_.memory->flash.data() + (address - ChipMemory::flash_start);
  }
  if (lies_in(address, size, ChipMemory::system_memory_start, ChipMemory::system_memory_size)) {
    return core_.memory->system.data() + (address - ChipMemory::system_memory_start);
  }
  return size <= ChipMemory::ram_size ? ram(address, static_cast<std::uint32_t>(size)) : nullptr;
}

bool Engine::is_memory(std::uint32_t address, std::uint64_t size) {
  return lies_in(address, size, ChipMemory::ram_start, ChipMemory::ram_size) ||
         lies_in(address, size, ChipMemory::ccm_start, ChipMemory::ccm_size) ||
         lies_in(address, size, ChipMemory::flash_start, ChipMemory::flash_size) ||
         lies_in(address, size, ChipMemory::system_memory_start, ChipMemory::system_memory_size);
}

bool Engine::read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const {
  const std::uint8_t* const place = memory(address, bytes.size());
  if (place != nullptr) {
    std::copy_n(place, bytes.size(), bytes.begin());
  }
  return place != nullptr;
}

bool Engine::write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  std::uint8_t* const place = memory(address, bytes.size());
  if (place == nullptr) {
    return false;
  }
  std::copy(bytes.begin(), bytes.end(), place);
  if (!bytes.empty() && lies_in(address, bytes.size(), ChipMemory::flash_start, ChipMemory::flash_size)) {
    core_.pages.discard(address - ChipMemory::flash_start, static_cast<std::uint32_t>(bytes.size()));
  }
  return true;
}

void Engine::set_breakpoints(std::span<const std::uint32_t> addresses) {
  breakpoints_.clear();
  for (const std::uint32_t address : addresses) {
    breakpoints_.push_back(address & ~1U);
  }
}

bool Engine::ends_before(const Instruction& next) {
  if (step_limit_) {
    if (core_.instructions() >= *step_limit_) {
      core_.end = End::stepped;
    }
  } else if (pass_ == next.address) {
    pass_.reset();
  } else if (std::find(breakpoints_.begin(), breakpoints_.end(), next.address) != breakpoints_.end()) {
    core_.end = End::breakpoint;
  }
  return core_.end != End::none;
}

template <bool watches>
End Engine::execute() {
  // A chain of calls has a bound, for compilers that make no jumps of them.
  constexpr std::uint64_t longest_chain = watches ? 1 : 256;
  const Instruction* next = core_.begin(pc_);
  core_.present = next;
  running_ = true;
  for (;;) {
    if (core_.instructions() >= core_.limit) [[unlikely]] {
      if (core_.end == End::none && !step_limit_ && core_.client.stops()) {
        core_.end = End::stopped;
      }
      if (core_.end != End::none) {
        break;
      }
    }
    if constexpr (watches) {
      if (ends_before(*next)) {
        break;
      }
    }
    const std::uint64_t until_limit = core_.limit - core_.instructions();
    core_.set_left(static_cast<std::uint32_t>(std::min(until_limit, longest_chain)));
    next = core_.go_on(next);
  }
  running_ = false;
  pc_ = next->address;
  if (core_.end >= End::breakpoint_instruction) {  // it was not executed
    --core_.end_of_chain;
  }
  return core_.end;
}

End Engine::run() {
  core_.end = End::none;
  return breakpoints_.empty() && !step_limit_ ? execute<false>() : execute<true>();
}

End Engine::step() {
  step_limit_ = core_.instructions() + 1;
  const std::uint64_t limit = core_.limit;
  core_.limit = ~std::uint64_t{0};
  const End end = run();
  core_.limit = limit;
  step_limit_.reset();
  return end;
}

}  // namespace proleg::sim
