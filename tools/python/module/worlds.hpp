#pragma once

#include <pybind11/pybind11.h>

namespace proleg::python {

/// Adds the class Worlds of the module: robots whose set-points come from Python, tick by tick.
void add_worlds(pybind11::module_& module);

}  // namespace proleg::python
