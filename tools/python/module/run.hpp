#pragma once

#include <pybind11/pybind11.h>

namespace proleg::python {

/// Adds the function simulate() of the module, and the declarations of the measures.
void add_run(pybind11::module_& module);

}  // namespace proleg::python
