#pragma once

// Calls of code that has not been checked: a mistake in it ends the call, not the program.
//
// The code runs in the program and not in a child process: a simulation of 30 s makes 30,000 calls and takes 0.4 s, and
// an exchange with a child by a futex in shared memory takes 7 us. In the page the program goes on after a failure.

#include <string>
#include <type_traits>

namespace proleg {

/// What is called, for the one line that is printed if the program cannot continue. Both texts must outlive the call.
struct CallSubject {
  const char* name = "";      ///< subject of a sentence: "steep.so: the algorithm 'steep'"
  const char* function = "";  ///< without brackets
};

/// How a call failed.
struct CallFailure {
  std::string text;               ///< "calls abort()"; without the name of what was called
  const void* address = nullptr;  ///< of a bad access to memory
};

/// Calls function(context). Returns false if it throws, breaks a rule of the processor (SIGSEGV, SIGBUS, SIGFPE,
/// SIGILL), calls abort(), or takes too long; `failure` says which. What the function had locked or allocated is then
/// lost: do not call its code again. If that are locks of the C library, or its lists of memory are damaged, or the
/// function calls exit() or quick_exit(), or does not return with all signals blocked, one line is printed and the
/// program ends with status 1. A child that the function makes by fork() ends at once with such a line; the program
/// goes on. Modes of floating point that the function changes are restored after the call; handlers and the mask of
/// signals soon after (kept_signals.hpp). Does not protect from code that overwrites memory of the program, or calls
/// _exit(). Calls may not be nested. Any thread may call it.
[[nodiscard]] bool run_guarded(const CallSubject& subject, void (*function)(void*), void* context,
                               CallFailure& failure);

template <typename Function>
[[nodiscard]] bool run_guarded(const CallSubject& subject, Function&& function, CallFailure& failure) {
  using Callable = std::remove_reference_t<Function>;
  return run_guarded(
      subject, [](void* context) { (*static_cast<Callable*>(context))(); }, &function, failure);
}

}  // namespace proleg
