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

namespace proleg::python {

/// A number as a word of a command line: the shortest decimal that reads back as the same number; "nan" and "inf" for
/// what no reader accepts, so that its message shows them.
[[nodiscard]] inline std::string word_of(double number) {
  if (std::isnan(number)) {
    return "nan";
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

}  // namespace proleg::python
