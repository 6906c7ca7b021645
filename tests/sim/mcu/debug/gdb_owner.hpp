#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "gdb_process.hpp"
#include "sim/mcu/debug/gdb_server.hpp"

namespace proleg::sim {

/// The owner of a target, as in gdb_server.hpp, until the debugger has ended.
/// Program: step(); run_slice(), true if it came to a breakpoint.
template <typename Program>
Resume run_under(GdbServer& server, Program& program, GdbProcess& gdb, int slices_until_control_c = 20'000) {
  const auto interrupted = [&] { return gdb.ended(); };
  if (!server.wait_for_client(interrupted)) {
    return Resume::interrupted;
  }
  Resume resume = server.serve(StopReason::attached, interrupted);
  while (resume == Resume::step || resume == Resume::run) {
    StopReason reason = StopReason::step;
    if (resume == Resume::step) {
      program.step();
    } else {
      reason = StopReason::interrupt;
      int slices = 0;
      bool has_interrupted = false;
      const auto start = std::chrono::steady_clock::now();
      // The user's control-C, when the program does not stop by itself.
      for (bool requested = false; !requested; requested = server.interrupt_requested()) {
        if (program.run_slice()) {
          reason = StopReason::breakpoint;
          break;
        }
        // A user reacts long after gdb has begun to wait; a signal before that would end gdb's wait.
        constexpr std::chrono::milliseconds reaction_time(500);
        if (++slices >= slices_until_control_c && !has_interrupted &&
            std::chrono::steady_clock::now() - start >= reaction_time) {
          gdb.interrupt();
          has_interrupted = true;
        }
        if (gdb.ended()) {
          return Resume::interrupted;
        }
      }
    }
    resume = server.serve(reason, interrupted);
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
