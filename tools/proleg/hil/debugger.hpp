#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "sim/mcu/chip/stm32f405.hpp"
#include "sim/mcu/debug/gdb_server.hpp"

namespace proleg::tools {

/// Attaches gdb to one virtual module of `proleg hil`. While the program is stopped, the simulation is stopped too.
class Debugger {
 public:
  /// Keeps the arguments; attach() opens the port.
  Debugger(std::uint16_t port, unsigned joint, std::filesystem::path image);

  [[nodiscard]] unsigned joint() const { return joint_; }
  /// Opens the port and waits until gdb connects or the user interrupts. The program then stops at its first
  /// instruction. Throws std::runtime_error if the port is not free.
  void attach(sim::Stm32f405& chip);

 private:
  /// Handles an event. Returns true to execute a single step. Throws std::runtime_error if gdb ended the program.
  [[nodiscard]] bool on_debug_event(sim::Stm32f405::DebugEvent event);

  std::uint16_t port_;
  unsigned joint_;
  std::filesystem::path image_;
  std::optional<sim::CpuTarget> target_;
  std::optional<sim::GdbServer> server_;
  bool must_stop_first_ = false;  ///< gdb has connected and has not seen the first stop yet
  std::chrono::steady_clock::time_point last_poll_;
};

}  // namespace proleg::tools
