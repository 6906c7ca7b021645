#pragma once

#include <string>
#include <vector>

#include "gdb_process.hpp"
#include "sim/mcu/debug/gdb_server.hpp"

namespace proleg::sim {

/// The owner of a target, as in gdb_server.hpp, until the debugger has left or ended. serve() ends with the connection,
/// and is not interrupted: a debugger does not wait for an answer to its last command, and may have ended before the
/// server reads it.
/// Program: step(); run_slice(), true if it came to a breakpoint.
template <typename Program>
Resume run_under(GdbServer& server, Program& program, GdbProcess& gdb, int slices_until_control_c = 20'000) {
  if (!server.wait_for_client([&] { return gdb.ended(); })) {
    return Resume::interrupted;
  }
  Resume resume = server.serve(StopReason::attached, nullptr);
  while (resume == Resume::step || resume == Resume::run) {
    StopReason reason = StopReason::step;
    if (resume == Resume::step) {
      program.step();
    } else {
      reason = StopReason::interrupt;
      int slices = 0;
      int waits = 0;
      bool has_interrupted = false;
      // The user's control-C, when the program does not stop by itself.
      for (bool requested = false; !requested; requested = server.interrupt_requested()) {
        if (program.run_slice()) {
          reason = StopReason::breakpoint;
          break;
        }
        // A user reacts when gdb waits for the program; a signal before that would end gdb's wait.
        constexpr int enough_waits = 100;
        waits = gdb.is_waiting() ? waits + 1 : 0;
        if (++slices >= slices_until_control_c && !has_interrupted && waits >= enough_waits) {
          gdb.interrupt();
          has_interrupted = true;
        }
        if (gdb.ended()) {
          return Resume::interrupted;
        }
      }
    }
    resume = server.serve(reason, nullptr);
  }
  return resume;
}

/// Whether the lines are in the output, in this order.
inline testing::AssertionResult contains(const std::string& output, const std::vector<std::string>& lines) {
  std::size_t at = 0;
  for (const std::string& line : lines) {
    at = output.find(line, at);
    if (at == std::string::npos) {
      return testing::AssertionFailure() << "'" << line << "' is not, or not there, in:\n" << output;
    }
    at += line.size();
  }
  return testing::AssertionSuccess();
}

}  // namespace proleg::sim
