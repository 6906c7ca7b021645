#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "sim/mcu/chip/stm32f405.hpp"
#include "sim/mcu/debug/gdb_server.hpp"

namespace proleg::tools {

/// gdb at one virtual module of `proleg hil`. While its program stands still, the simulation does too.
class Debugger {
 public:
  /// Listens; throws std::runtime_error if the port is not available.
  Debugger(std::uint16_t port, unsigned joint, std::filesystem::path image);

  [[nodiscard]] unsigned joint() const { return joint_; }
  /// Waits until gdb has connected, or the user interrupts. The program then stops at its first instruction.
  void attach(sim::Stm32f405& chip);

 private:
  /// Whether the program must make a single step. Throws std::runtime_error if gdb ended it.
  [[nodiscard]] bool on_debug_event(sim::Stm32f405::DebugEvent event);

  std::uint16_t port_;
  unsigned joint_;
  std::filesystem::path image_;
  std::optional<sim::CpuTarget> target_;
  std::optional<sim::GdbServer> server_;
  bool attached_ = false;  ///< gdb has connected; the first stop is next
  std::chrono::steady_clock::time_point last_poll_;
};

}  // namespace proleg::tools
