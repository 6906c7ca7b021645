#pragma once

// Executes the instructions of a Cortex-M4: registers, memory and the run. Its client has the exceptions and the
// memory-mapped registers.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/mcu/cpu/core.hpp"
#include "sim/mcu/cpu/decoder.hpp"

namespace proleg::sim {

enum class CoreRegister : std::uint8_t {
  r0,
  r1,
  r2,
  r3,
  r4,
  r5,
  r6,
  r7,
  r8,
  r9,
  r10,
  r11,
  r12,
  sp,
  lr,
  pc,
  xpsr,
  msp,
  psp,
  primask,
  basepri,
  faultmask,
  control
};

class Engine {
 public:
  explicit Engine(EngineClient& client) : core_(client, thumb_instructions) {}

  /// Executes from pc() on.
  End run();
  /// As run(), but a single instruction.
  End step();
  /// Whether between run() and its return.
  [[nodiscard]] bool is_running() const { return running_; }

  /// Address of the next instruction, in a callback of the present one; bit 0 clear.
  [[nodiscard]] std::uint32_t pc() const { return running_ ? core_.present->address : pc_; }
  void set_pc(std::uint32_t address) { pc_ = address & ~1U; }
  [[nodiscard]] std::uint32_t exception_return_value() const { return core_.exception_return_value; }
  [[nodiscard]] const MemoryFault& fault() const { return core_.fault; }

  /// Executed since the engine was made, with those that an IT block skips. In a callback: with the present one.
  [[nodiscard]] std::uint64_t instructions() const { return core_.instructions(); }
  /// EngineClient::stops() is called from here on.
  void set_limit(std::uint64_t instructions) {
    core_.limit = running_ && core_.end != End::none ? 0 : instructions;
    if (core_.end_of_chain > core_.limit) {
      core_.set_left(static_cast<std::uint32_t>(std::max(core_.limit, core_.instructions()) - core_.instructions()));
    }
  }
  /// CCR.UNALIGN_TRP and DIV_0_TRP.
  void set_traps(bool unaligned, bool division) {
    core_.traps_unaligned = unaligned;
    core_.traps_division = division;
  }
  /// An exception is entered or has returned (DDI 0403, A3.4.4).
  void clear_exclusive() { core_.is_exclusive = false; }

  template <std::size_t count>
  void read(const std::array<CoreRegister, count>& names, std::array<std::uint32_t, count>& values) const {
    for (std::size_t i = 0; i < count; ++i) {
      values[i] = read(names[i]);
    }
  }
  /// Writes registers in the order given. Writing xpsr or control selects the stack pointer of the new mode.
  template <std::size_t count>
  void write(const std::array<CoreRegister, count>& names, const std::array<std::uint32_t, count>& values) {
    for (std::size_t i = 0; i < count; ++i) {
      write(names[i], values[i]);
    }
  }
  [[nodiscard]] std::uint32_t read(CoreRegister name) const;
  void write(CoreRegister name, std::uint32_t value);

  /// Where RAM is kept; null if not all of these bytes are RAM or core-coupled memory.
  [[nodiscard]] std::uint8_t* ram(std::uint32_t address, std::uint32_t size) const;
  /// Flash, system memory, RAM; false if not all of these bytes are memory. Writing is not possible in a callback, but
  /// for RAM.
  [[nodiscard]] bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const;
  [[nodiscard]] bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes);
  [[nodiscard]] static bool is_memory(std::uint32_t address, std::uint64_t size);

  void set_breakpoints(std::span<const std::uint32_t> addresses);
  /// Whether the next run ignores a breakpoint at pc() once.
  void pass_breakpoint(bool pass) { pass_ = pass ? std::optional(pc_) : std::nullopt; }

 private:
  template <bool watches>
  End execute();
  /// Before an instruction, if a breakpoint or a single step may end the run there.
  [[nodiscard]] bool ends_before(const Instruction& next);
  [[nodiscard]] std::uint8_t* memory(std::uint32_t address, std::uint64_t size) const;

  Core core_;
  std::vector<std::uint32_t> breakpoints_;
  std::uint32_t pc_ = 0;
  bool running_ = false;
  std::optional<std::uint32_t> pass_;        ///< a breakpoint here is ignored once
  std::optional<std::uint64_t> step_limit_;  ///< a single step ends at this number of instructions
};

}  // namespace proleg::sim
