// The module proleg._core: what the package proleg (tools/python/proleg) is made of. Only the package calls it, with
// arguments of the right types and shapes; docs/python.md is for those who use the package.

#include <pybind11/pybind11.h>

#include "tools/proleg/common/build_id.hpp"
#include "tools/python/module/parts.hpp"

PYBIND11_MODULE(_core, module) {
  module.attr("build_id") = proleg::tools::build_id;
  proleg::python::add_errors(module);
  proleg::python::add_scenario(module);
  proleg::python::add_run(module);
  proleg::python::add_evaluation(module);
  proleg::python::add_recording(module);
  proleg::python::add_worlds(module);
}
