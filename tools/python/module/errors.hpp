#pragma once

#include <pybind11/pybind11.h>

namespace proleg::python {

/// Adds the exceptions of the module, and makes them of the errors of the rooms below: InputError (also a ValueError)
/// of what cannot be used, FileError (an OSError) of files that cannot be written, RunError (a RuntimeError) of runs
/// that fail. All are an Error; their text is the one line that a command prints.
void add_errors(pybind11::module_& module);

}  // namespace proleg::python
