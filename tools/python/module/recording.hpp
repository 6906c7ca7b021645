#pragma once

#include <pybind11/pybind11.h>

namespace proleg::python {

/// Adds the function read_recording() of the module: the table of a recording, and what it says of its run.
void add_recording(pybind11::module_& module);

}  // namespace proleg::python
