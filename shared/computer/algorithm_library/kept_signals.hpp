#pragma once

// How this program takes signals, which code of a library can change: then Control-C would have no effect while a robot
// moves.

#include <csignal>

#include <array>
#include <functional>

namespace proleg {

/// All handlers of the process, and the mask of this thread.
class SignalState {
 public:
  SignalState();
  /// Sets them again.
  void restore() const;

 private:
  std::array<struct sigaction, NSIG> actions_{};
  sigset_t mask_{};
};

/// Signals that ask a program to end.
inline constexpr std::array ending_signals{SIGINT, SIGTERM, SIGHUP};

/// Sets their handlers by a call of `set`, as those that restore_ending_signals() keeps. This does not hold for a
/// process that is forked later.
void set_ending_signals(const std::function<void()>& set);
/// Sets the kept handlers again, if there are any.
void restore_ending_signals();
/// Whether restore_ending_signals() has ever found another handler: a library changes them, perhaps in each call.
[[nodiscard]] bool do_libraries_change_signals();

/// From now on no code in this process, nor in programs that it starts, changes how it takes these signals: a call that
/// tries has no effect and returns 0. Threads that run already are not bound. Does nothing where the kernel has no
/// filters of system calls (seccomp). Programs that it starts cannot get more rights by their files.
void lock_ending_signals();

}  // namespace proleg
