#pragma once

// What Python gives as numbers, words and lists, as what the rooms below take; and the reverse.

#include <pybind11/numpy.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::python {

/// A number as a word of a command line: the shortest decimal that reads back as the same number; 0 for what is nearer
/// to it than any unit can tell, since a decimal of a parameter has no such exponents; "nan" and "inf" for what no
/// reader accepts, so that its message shows them.
[[nodiscard]] inline std::string word_of(double number) {
  if (std::isnan(number)) {
    return "nan";
  }
  constexpr double smallest = 1e-40;
  if (std::abs(number) < smallest) {
    return "0";
  }
  return std::isinf(number) ? (number > 0 ? "inf" : "-inf") : exact_text(number);
}

/// An array that owns the numbers of a vector, without a copy. shape: its product is the size of the vector.
template <typename Number>
[[nodiscard]] pybind11::array_t<Number> array_of(std::vector<Number> numbers, std::vector<std::size_t> shape) {
  auto owner = std::make_unique<std::vector<Number>>(std::move(numbers));
  const Number* const data = owner->data();
  const pybind11::capsule keeper(owner.get(), [](void* kept) { delete static_cast<std::vector<Number>*>(kept); });
  static_cast<void>(owner.release());
  return pybind11::array_t<Number>(std::move(shape), data, keeper);
}

/// Gives a class of Python a __reduce__() that says why its objects are not copied and not pickled. Without it, the
/// protocols 0 and 1 of pickle end the process.
inline void refuse_copies(const pybind11::object& type) {
  const auto refuse = [](const pybind11::object& self) -> pybind11::object {
    throw pybind11::type_error(pybind11::type::of(self).attr("__name__").cast<std::string>() +
                               ": found a copy or a pickle of one, expected a new one");
  };
  type.attr("__reduce__") = pybind11::cpp_function(refuse, pybind11::name("__reduce__"), pybind11::is_method(type));
}

}  // namespace proleg::python

namespace pybind11::detail {

/// Loads only objects that __init__ has made. For one of __new__ alone, pybind11 would give out memory with nothing in
/// it.
template <typename Class>
class caster_of_made : public type_caster_base<Class> {
 public:
  bool load(handle source, bool convert) {
    const type_info* const type = get_type_info(typeid(Class));
    const bool is_made = type == nullptr || !isinstance(source, reinterpret_cast<PyObject*>(type->type)) ||
                         reinterpret_cast<instance*>(source.ptr())->get_value_and_holder(type).holder_constructed();
    return is_made && type_caster_base<Class>::load(source, convert);
  }
};

template <>
class type_caster<proleg::sim::Scenario> : public caster_of_made<proleg::sim::Scenario> {};

}  // namespace pybind11::detail
