#pragma once

// Calls that take long: they hold no lock of the interpreter, and a Ctrl-C ends them.

#include <chrono>

namespace proleg::python {

/// Looks often enough, and not too often, for a signal that ends the call. Only for the thread that Python called,
/// while it does not hold the interpreter's lock.
class SignalWatch {
 public:
  /// Throws pybind11::error_already_set if a signal handler of Python raised an exception, such as KeyboardInterrupt.
  /// May be called at every tick: it reads a clock, and calls Python twenty times a second.
  void check();

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace proleg::python
