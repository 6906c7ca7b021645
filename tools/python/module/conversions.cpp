#include "tools/python/module/conversions.hpp"

#include <cmath>

#include "shared/computer/text/text.hpp"

namespace proleg::python {

std::string word_of(double number) {
  if (std::isnan(number)) {
    return "nan";
  }
  return std::isinf(number) ? (number > 0 ? "inf" : "-inf") : exact_text(number);
}

}  // namespace proleg::python
