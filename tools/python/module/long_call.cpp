#include "tools/python/module/long_call.hpp"

#include <pthread.h>
#include <pybind11/pybind11.h>

#include <new>

#include "sim/loop/plant.hpp"

namespace proleg::python {
namespace {

constexpr std::chrono::milliseconds between_checks{50};

/// Never destroyed: threads may use it while the program ends. A child replaces it, since the thread that held it in
/// the parent does not exist there.
alignas(std::timed_mutex) std::byte storage[sizeof(std::timed_mutex)];

/// That of another module, which then replaces it in a child.
std::timed_mutex* foreign_lock = nullptr;

std::timed_mutex& iterative_solver() {
  if (foreign_lock != nullptr) {
    return *foreign_lock;
  }
  static const bool is_made = [] {
    new (storage) std::timed_mutex;
    pthread_atfork(nullptr, nullptr, [] { new (storage) std::timed_mutex; });
    return true;
  }();
  static_cast<void>(is_made);
  return *std::launder(reinterpret_cast<std::timed_mutex*>(storage));
}

}  // namespace

std::timed_mutex* solver_lock() { return &iterative_solver(); }
void use_solver_lock(std::timed_mutex* lock) { foreign_lock = lock; }

void SignalWatch::check() {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < between_checks) {
    return;
  }
  last_ = now;
  const pybind11::gil_scoped_acquire interpreter;
  if (PyErr_CheckSignals() != 0) {
    throw pybind11::error_already_set();
  }
}

EngineTurn::EngineTurn(const sim::Scenario& scenario, SignalWatch* watch, const std::atomic<bool>* stops) {
  if (!sim::needs_process_of_its_own(scenario)) {
    return;
  }
  lock_ = std::unique_lock(iterative_solver(), std::defer_lock);
  while (!lock_.try_lock_for(between_checks)) {
    if (watch != nullptr) {
      watch->check();
    }
    if (stops != nullptr && *stops) {
      return;
    }
  }
}

}  // namespace proleg::python
