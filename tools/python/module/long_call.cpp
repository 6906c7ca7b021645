#include "tools/python/module/long_call.hpp"

#include <pybind11/pybind11.h>

namespace proleg::python {
namespace {

constexpr std::chrono::milliseconds between_checks{50};

}  // namespace

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

}  // namespace proleg::python
