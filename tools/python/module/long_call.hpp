#pragma once

// Calls that take long: they hold no lock of the interpreter, a Ctrl-C ends them, and so does the end of Python.

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::python {

/// The calls of all modules of the package that do not hold the interpreter's lock.
struct LongCalls {
  std::atomic<int> open = 0;
  std::atomic<bool> have_ended = false;
  std::thread::id ender;  ///< the thread that may still call
};
/// Those of this module, or of the one with which it shares them.
[[nodiscard]] LongCalls& long_calls();
void share_long_calls(LongCalls& calls);

/// Ends the calls of all other threads, and waits for them, as the last thing that Python does before its end. These
/// threads never get the interpreter's lock again. A Ctrl-C ends the wait.
void end_long_calls();
/// In a child of fork(), which has only the thread that called it.
void forget_long_calls();

/// The time in which a call does not hold the interpreter's lock. Made by a thread that has it. At the end of Python
/// the thread stays in here: the interpreter would unwind its stack with all frames of C++.
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// A call of an object that belongs to one thread at a time. Made while the thread has the lock of the interpreter.
class OneThread {
 public:
  /// Throws InputError if another thread makes a call. name: of the class.
  OneThread(bool& is_used, const char* name) : is_used_(is_used) {
    if (is_used_ && !long_calls().have_ended) {
      throw InputError(name, 0, "a call while another thread makes one", "one thread at a time");
    }
    is_used_ = true;
  }
  ~OneThread() { is_used_ = false; }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  bool& is_used_;
};

/// Looks often enough, and not too often, for a signal that ends the call. Only for the thread that Python called,
/// while it does not hold the interpreter's lock.
class SignalWatch {
 public:
  /// Throws pybind11::error_already_set if a signal handler of Python raised an exception, such as KeyboardInterrupt;
  /// and what nothing but Unlocked sees if Python ends. May be called at every tick: it reads a clock, and calls Python
  /// twenty times a second.
  void check();

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace proleg::python
