#include "tools/proleg/hil/debugger.hpp"

#include <iostream>
#include <stdexcept>

#include "tools/proleg/common/scenario_run.hpp"

namespace proleg::tools {

using DebugEvent = sim::Stm32f405::DebugEvent;

Debugger::Debugger(std::uint16_t port, unsigned joint, std::filesystem::path image)
    : port_(port), joint_(joint), image_(std::move(image)) {}

void Debugger::attach(sim::Stm32f405& chip) {
  target_.emplace(chip.cpu());
  server_.emplace(port_, *target_);
  std::cerr << "proleg hil: waits for: gdb-multiarch " << image_.string() << " -ex 'target remote :" << server_->port()
            << "'\n";
  must_stop_first_ = server_->wait_for_client(interrupted);
  chip.set_debug_hook([this](DebugEvent event) { return on_debug_event(event); });
}

bool Debugger::on_debug_event(DebugEvent event) {
  sim::StopReason reason{};
  switch (event) {
    case DebugEvent::about_to_run: {
      constexpr std::chrono::milliseconds poll_period(5);
      const auto now = std::chrono::steady_clock::now();
      if (must_stop_first_) {
        must_stop_first_ = false;
        reason = sim::StopReason::attached;
      } else if (now - last_poll_ >= poll_period) {
        last_poll_ = now;
        if (!server_->interrupt_requested()) {
          return false;
        }
        reason = sim::StopReason::interrupt;
      } else {
        return false;
      }
      break;
    }
    case DebugEvent::breakpoint:
      reason = sim::StopReason::breakpoint;
      break;
    case DebugEvent::step:
      reason = sim::StopReason::step;
      break;
    case DebugEvent::fault:
      reason = sim::StopReason::fault;
      break;
  }
  switch (server_->serve(reason, interrupted)) {
    case sim::Resume::step:
      return true;
    case sim::Resume::kill:
      throw std::runtime_error("gdb ended the program");
    default:
      return false;
  }
}

}  // namespace proleg::tools
