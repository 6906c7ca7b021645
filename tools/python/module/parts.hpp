#pragma once

// The parts of the module proleg._core. Each adds its classes and functions to it. Other modules, which take longer to
// load, share its exceptions, its classes and its locks.

#include <pybind11/pybind11.h>

#include <stdexcept>

// In an interpreter that is not the main one, pybind11 waits for ever for a lock. So its first step is preceded by a
// check.
#undef PYBIND11_ENSURE_INTERNALS_READY
#define PYBIND11_ENSURE_INTERNALS_READY                                                          \
  if (PyInterpreterState_Get() != PyInterpreterState_Main()) {                                   \
    PyErr_SetString(PyExc_ImportError,                                                           \
                    "proleg: found a sub-interpreter, expected the main interpreter or another " \
                    "process; mod_wsgi: WSGIApplicationGroup %{GLOBAL}");                        \
    return nullptr;                                                                              \
  }                                                                                              \
  pybind11::detail::get_internals();

namespace proleg::python {

/// Becomes a RunError, of a robot that does not move as it should.
class RunFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The exceptions, and what makes them of the errors of the rooms below: InputError (also a ValueError) of what cannot
/// be used, FileError (an OSError) of files that cannot be written, RunError (a RuntimeError) of runs that fail. All
/// are an Error; their text is the one line that a command prints.
void add_errors(pybind11::module_& module);
/// Imports proleg._core, and makes its exceptions and the lock of its simulations those of another module.
void share_with_core(pybind11::module_& module);
/// The class Scenario: the files of a robot, its gait and its world, read and checked; and what makes one.
void add_scenario(pybind11::module_& module);
/// The function simulate(), and the declarations of the measures.
void add_run(pybind11::module_& module);
/// The function evaluate(): many candidates of one scenario, on several cores.
void add_evaluation(pybind11::module_& module);
/// The function read_recording(): the table of a recording, and what it says of its run.
void add_recording(pybind11::module_& module);
/// The class Worlds: robots whose set-points come from Python, tick by tick.
void add_worlds(pybind11::module_& module);

}  // namespace proleg::python
