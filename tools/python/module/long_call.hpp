#pragma once

// Calls that take long: they hold no lock of the interpreter, and a Ctrl-C ends them.

#include <atomic>
#include <chrono>
#include <mutex>

#include "sim/scenario/scenario.hpp"

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

/// The lock behind EngineTurn, for another extension module of this process: each has its own copy of this code, and
/// all must have one lock.
[[nodiscard]] std::timed_mutex* solver_lock();
/// Takes the lock of another module. To be called before anything is simulated.
void use_solver_lock(std::timed_mutex* lock);

/// The right to simulate a scenario in this process. Worlds of ODE with the iterative solver share a random generator:
/// two of them at the same time would not repeat (docs/physics.md), so one waits for the other. All other scenarios
/// have the right at once. A child that fork() makes has the right again, whatever other threads of its parent did.
class EngineTurn {
 public:
  /// Waits for the right. watch: null for a thread that Python did not call, which stops waiting when `stops` is true;
  /// it has no right then.
  EngineTurn(const sim::Scenario& scenario, SignalWatch* watch, const std::atomic<bool>* stops = nullptr);

 private:
  std::unique_lock<std::timed_mutex> lock_;
};

}  // namespace proleg::python
