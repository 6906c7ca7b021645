#pragma once

// The commands of the GDB remote serial protocol ("Debugging with GDB", appendix E.2 to E.4) for one ARMv7-M core,
// which is thread 1. They map payload to payload, without sockets.

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/mcu/debug/debug_target.hpp"

namespace proleg::sim {

/// Reasons why a target has stopped.
enum class StopReason : std::uint8_t {
  attached,    ///< before its first instruction, or because a client has connected: SIGTRAP
  breakpoint,  ///< SIGTRAP
  step,        ///< a single step is done: SIGTRAP
  interrupt,   ///< the client asked for it: SIGINT
  fault,       ///< SIGSEGV
};

/// Ways in which the client resumes a stopped target.
enum class Resume : std::uint8_t {
  run,          ///< until a breakpoint, a fault or interrupt_requested()
  step,         ///< one instruction, then serve() again
  detach,       ///< the client has left: run freely, without breakpoints
  kill,         ///< the client ends the program
  interrupted,  ///< `interrupted` was true; the client is still connected
};

/// Answers `monitor TEXT` with a text for the user; lines end with '\n'. Must not throw.
using MonitorCommand = std::function<std::string(std::string_view text)>;

class GdbCommands {
 public:
  explicit GdbCommands(DebugTarget& target) : target_(&target) {}

  struct Answer {
    std::optional<std::string> reply;  ///< payload to send; an empty one means: unknown command
    std::optional<Resume> resume;
  };
  /// Answers a packet. A wrong packet gets an error number.
  [[nodiscard]] Answer answer(std::string_view packet);

  void set_monitor(MonitorCommand monitor) { monitor_ = std::move(monitor); }
  void set_stop_reason(StopReason reason) { reason_ = reason; }
  /// The stop reply packet: the signal, and the registers that a debugger reads first.
  [[nodiscard]] std::string stop_reply() const;
  /// Removes all breakpoints, also from the target.
  void clear_breakpoints();

 private:
  [[nodiscard]] Answer resume(Resume how, std::string_view address);
  [[nodiscard]] Answer resume_threads(std::string_view actions);
  [[nodiscard]] std::string query(std::string_view packet) const;
  [[nodiscard]] std::string features(std::string_view range) const;
  [[nodiscard]] std::string monitor(std::string_view digits) const;
  [[nodiscard]] std::string read_registers() const;
  [[nodiscard]] std::string write_registers(std::string_view digits);
  [[nodiscard]] std::string read_register(std::string_view number) const;
  [[nodiscard]] std::string write_register(std::string_view assignment);
  [[nodiscard]] std::string read_memory(std::string_view range) const;
  [[nodiscard]] std::string write_memory(std::string_view text, bool binary);
  [[nodiscard]] std::string change_breakpoint(std::string_view text, bool insert);
  void apply_breakpoints();

  DebugTarget* target_;
  MonitorCommand monitor_;
  StopReason reason_ = StopReason::attached;
  /// Address and kind (software, hardware): a client may set both at an address, and remove one.
  std::set<std::pair<std::uint32_t, char>> breakpoints_;
  std::vector<std::uint32_t> applied_;  ///< addresses that the target has
};

}  // namespace proleg::sim
