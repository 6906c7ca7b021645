#include "shared/fixed/exponential.hpp"

#include "shared/fixed/arithmetic.hpp"

namespace proleg {

std::int32_t exponential_decay(std::int32_t x) {
  if (x <= 0) {
    return 1 << 30;
  }
  // Q36 keeps the remainder exact enough after up to 184 multiples of ln 2.
  constexpr std::int64_t ln2 = 47632711549;  // ln 2 in Q36
  const std::int64_t wide = std::int64_t{x} << 12U;
  const std::int64_t halvings = wide / ln2;
  if (halvings >= 32) {
    return 0;
  }
  const auto r = static_cast<std::int32_t>(shift_right_rounding(wide - halvings * ln2, 6));  // Q30, 0 <= r <= ln 2

  // Horner form of 1 - r + r^2/2! - ... - r^11/11!; the next term of the series is 3e-11 at r = ln 2.
  std::int32_t sum = 1 << 30;
  for (std::int32_t n = 11; n >= 1; --n) {
    sum = (1 << 30) - divide_nearest(multiply(r, sum, 30), n);
  }
  return halvings == 0 ? sum : static_cast<std::int32_t>(shift_right_rounding(sum, static_cast<unsigned>(halvings)));
}

}  // namespace proleg
