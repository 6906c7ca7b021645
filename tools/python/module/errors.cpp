#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <variant>

#include "shared/computer/algorithm_library/guarded_algorithm.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/ode/engine.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/physics/physics_error.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/python/module/long_call.hpp"
#include "tools/python/module/parts.hpp"

namespace proleg::python {
namespace {

// The interpreter keeps them as long as it runs.
PyObject* input_error = nullptr;
PyObject* file_error = nullptr;
PyObject* run_error = nullptr;

constexpr const char* lock_name = "proleg._core._solver_lock";
constexpr const char* calls_name = "proleg._core._long_calls";

void refuse_fault() {
  PyErr_SetString(run_error, "found a fault in Proleg itself, expected none: please report the call that did this");
}

PyObject* add(pybind11::module_& module, const char* name, const char* text, const pybind11::tuple& bases) {
  const std::string full_name = std::string("proleg.") + name;
  PyObject* const made = PyErr_NewExceptionWithDoc(full_name.c_str(), text, bases.ptr(), nullptr);
  if (made == nullptr) {
    throw pybind11::error_already_set();
  }
  module.add_object(name, made);
  return made;
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    PyErr_SetString(input_error, error.what());
  } catch (const tools::BadInput& error) {
    PyErr_SetString(input_error, error.what());
  } catch (const FileError& error) {
    PyErr_SetString(file_error, error.what());
  } catch (const optimize::StoreError& error) {
    PyErr_SetString(file_error, error.what());
  } catch (const sim::PhysicsError& error) {
    PyErr_SetString(run_error, error.what());
  } catch (const RunFailure& error) {
    PyErr_SetString(run_error, error.what());
  } catch (const AlgorithmFailure& error) {
    PyErr_SetString(run_error, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    PyErr_SetString(input_error,
                    InputError(error.path1().string(), 0,
                               "a path that cannot be looked at (" + error.code().message() + ")", "another one")
                        .what());
  } catch (const std::bad_alloc&) {
    PyErr_SetString(PyExc_MemoryError, "found too little memory, expected more, or a shorter or smaller call");
  } catch (const std::logic_error&) {
    refuse_fault();
  } catch (const std::bad_variant_access&) {
    refuse_fault();
  } catch (const std::bad_optional_access&) {
    refuse_fault();
  } catch (const pybind11::builtin_exception&) {
    throw;
  } catch (const std::runtime_error& error) {
    PyErr_SetString(run_error, error.what());
  }
}

}  // namespace

void add_errors(pybind11::module_& module) {
  const pybind11::handle base =
      add(module, "Error", "What Proleg cannot do. str(): one line that says what was found and what was expected.",
          pybind11::make_tuple(pybind11::handle(PyExc_Exception)));
  const auto with = [&](PyObject* other) { return pybind11::make_tuple(base, pybind11::handle(other)); };
  input_error = add(module, "InputError", "A file, a name or a value cannot be used.", with(PyExc_ValueError));
  file_error = add(module, "FileError", "A file cannot be written, or read to its end.", with(PyExc_OSError));
  run_error = add(module, "RunError", "A simulation failed: the robot flew off, or the engine broke down.",
                  with(PyExc_RuntimeError));
  pybind11::register_local_exception_translator(translate);
  module.attr("_solver_lock") = pybind11::capsule(&sim::SolverRandomNumbers::lock(), lock_name);
  module.attr("_long_calls") = pybind11::capsule(&long_calls(), calls_name);
  module.def("end_long_calls", &end_long_calls);
  module.def("forget_long_calls", &forget_long_calls);
}

void share_with_core(pybind11::module_& module) {
  const pybind11::module_ core = pybind11::module_::import("proleg._core");
  input_error = core.attr("InputError").ptr();  // the interpreter keeps them with the module
  file_error = core.attr("FileError").ptr();
  run_error = core.attr("RunError").ptr();
  pybind11::register_local_exception_translator(translate);
  const pybind11::capsule lock = core.attr("_solver_lock");
  sim::SolverRandomNumbers::use_lock(*lock.get_pointer<std::mutex>());
  const pybind11::capsule calls = core.attr("_long_calls");
  share_long_calls(*calls.get_pointer<LongCalls>());
  module.attr("_core") = core;
}

}  // namespace proleg::python
