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

}  // namespace proleg
