#pragma once

#include <pybind11/pybind11.h>

namespace proleg::python {

/// Adds the function evaluate() of the module: many candidates of one scenario, on several cores.
void add_evaluation(pybind11::module_& module);

}  // namespace proleg::python
