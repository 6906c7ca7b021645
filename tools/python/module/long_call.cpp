#include "tools/python/module/long_call.hpp"

#include <cxxabi.h>
#include <unistd.h>

namespace proleg::python {
namespace {

constexpr std::chrono::milliseconds between_checks{50};

LongCalls own_calls;
LongCalls* shared_calls = &own_calls;

struct PythonEnds {};

/// Whether Python ends, for this thread.
bool must_end() { return long_calls().have_ended && std::this_thread::get_id() != long_calls().ender; }

[[noreturn]] void wait_for_ever() {
  while (true) {
    pause();
  }
}

/// Takes the interpreter's lock by the action. An interpreter that has ended would end the thread instead, and unwind
/// its stack, which must not reach a destructor.
template <typename Action>
auto take_lock(const Action& action) {
  try {
    return action();
  } catch (const abi::__forced_unwind&) {
    wait_for_ever();
  }
}

class Locked {
 public:
  Locked() : state_(take_lock(&PyGILState_Ensure)) {}
  ~Locked() { PyGILState_Release(state_); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;

 private:
  PyGILState_STATE state_;
};

}  // namespace

LongCalls& long_calls() { return *shared_calls; }
void share_long_calls(LongCalls& calls) { shared_calls = &calls; }

void end_long_calls() {
  LongCalls& calls = long_calls();
  calls.ender = std::this_thread::get_id();
  calls.have_ended = true;
  const Unlocked unlocked;
  SignalWatch watch;
  while (calls.open > 1) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    watch.check();
  }
}

void forget_long_calls() { long_calls().open = 0; }

Unlocked::Unlocked() : state_(PyEval_SaveThread()) {
  if (must_end()) {
    wait_for_ever();
  }
  ++long_calls().open;
}

Unlocked::~Unlocked() {
  --long_calls().open;
  if (must_end()) {
    wait_for_ever();
  }
  take_lock([this] { PyEval_RestoreThread(state_); });
}

void SignalWatch::check() {
  if (must_end()) {
    throw PythonEnds();
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < between_checks) {
    return;
  }
  last_ = now;
  const Locked locked;
  if (PyErr_CheckSignals() != 0) {
    throw pybind11::error_already_set();
  }
}

}  // namespace proleg::python
