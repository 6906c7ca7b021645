#pragma once

#include <pybind11/pybind11.h>

namespace proleg::python {

/// Adds the class Scenario of the module: the files of a robot, its gait and its world, read and checked; and what
/// makes one.
void add_scenario(pybind11::module_& module);

}  // namespace proleg::python
