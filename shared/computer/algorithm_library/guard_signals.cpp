#include "shared/computer/algorithm_library/guard_signals.hpp"

#include <array>
#include <csetjmp>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <mutex>

#include "shared/computer/algorithm_library/program_end.hpp"
#include "shared/computer/algorithm_library/thread_guard.hpp"

namespace proleg {
namespace {

constexpr std::array caught_signals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, time_out_signal};

std::array<struct sigaction, NSIG> previous_actions;

void on_signal(int signal, siginfo_t* info, void* /*context*/) {
  ThreadGuard* const guard = current_guard;
  if (guard != nullptr && guard->is_active) {
    if (signal == time_out_signal && guard->expired != guard->call) {
      return;  // that call has just returned
    }
    guard->signal = signal;
    guard->address.reset();
    if (is_bad_access(signal) && info->si_code > 0) {
      guard->address = info->si_addr;
    }
    guard->is_active = false;
    siglongjmp(guard->jump, 1);
  }
  if (signal == time_out_signal) {
    return;
  }
  if (guard != nullptr && guard->is_checked) {
    end_program_after(*guard, text_of(*guard), left_damaged);
  }
  const struct sigaction& previous = previous_actions[static_cast<std::size_t>(signal)];
  if (blamed_file() != nullptr && previous.sa_handler == SIG_DFL) {
    end_program_after_crash(signal);
  }
  // It is not from a guarded call: what had been set before takes effect. A bad instruction is executed once more.
  sigaction(signal, &previous, nullptr);
  if (info->si_code <= 0) {
    raise(signal);
  }
}

std::terminate_handler previous_terminate = nullptr;

/// The usual handler would print a second line about what is reported anyway.
[[noreturn]] void on_terminate() {
  ThreadGuard* const guard = current_guard;
  if (guard != nullptr && guard->is_active) {
    guard->is_terminated = true;
    std::abort();
  }
  if (previous_terminate != nullptr) {
    previous_terminate();
  }
  std::abort();
}

}  // namespace

bool is_bad_access(int signal) { return signal == SIGSEGV || signal == SIGBUS; }

void catch_guard_signals() {
  static std::once_flag once;
  std::call_once(once, [] {
    previous_terminate = std::set_terminate(on_terminate);
    for (const int signal : caught_signals) {
      sigaction(signal, nullptr, &previous_actions[static_cast<std::size_t>(signal)]);
    }
    set_guard_handlers();
  });
}

void set_guard_handlers() {
  struct sigaction action {};
  action.sa_sigaction = on_signal;
  // After a jump out of the handler the signal must not be blocked, and a full stack has no room for the handler.
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER | SA_RESTART;
  for (const int signal : caught_signals) {
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_sigaction != on_signal) {
      sigaction(signal, &action, nullptr);
    }
  }
}

}  // namespace proleg
