#pragma once

#include <cstdint>
#include <span>

namespace proleg::sim {

class Cpu;

/// A stopped program, as a debugger sees it. The owner of the target steps and runs it (gdb_server.hpp). No function
/// may throw.
class DebugTarget {
 public:
  /// Number of registers: r0 to r12, sp, lr, pc, xpsr.
  static constexpr unsigned register_count = 17;
  static constexpr unsigned program_counter = 15;

  /// number: below register_count.
  [[nodiscard]] virtual std::uint32_t core_register(unsigned number) const = 0;
  virtual void set_core_register(unsigned number, std::uint32_t value) = 0;

  /// Both return false if one of the addresses has no memory; then a part of `bytes`, or of the memory, may have
  /// changed.
  [[nodiscard]] virtual bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const = 0;
  [[nodiscard]] virtual bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) = 0;

  /// Replaces the breakpoints: the program stops before these addresses, which are even and ascend without repetition.
  virtual void set_breakpoints(std::span<const std::uint32_t> addresses) = 0;

 protected:
  ~DebugTarget() = default;
};

/// A virtual CPU as a target. Peripheral registers cannot be read: a read would change them.
class CpuTarget final : public DebugTarget {
 public:
  /// The CPU must outlive the target.
  explicit CpuTarget(Cpu& cpu) : cpu_(&cpu) {}

  [[nodiscard]] std::uint32_t core_register(unsigned number) const override;
  void set_core_register(unsigned number, std::uint32_t value) override;
  [[nodiscard]] bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const override;
  [[nodiscard]] bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) override;
  void set_breakpoints(std::span<const std::uint32_t> addresses) override;

 private:
  Cpu* cpu_;
};

}  // namespace proleg::sim
