#include "shared/fixed/polar.hpp"

#include <algorithm>
#include <iterator>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {
namespace {

/// Arc tangents of 2^-i, as binary angles.
constexpr std::int32_t arcs[] = {536870912, 316933406, 167458907, 85004756, 42667331, 21354465, 10679838,
                                 5340245,   2670163,   1335087,   667544,   333772,   166886,   83443,
                                 41722,     20861,     10430,     5215,     2608,     1304};
/// Inverse of the factor by which all steps together lengthen the vector, 1.64676, in Q30.
constexpr std::int32_t inverse_gain = 652032874;

}  // namespace

Polar polar(std::int32_t x, std::int32_t y) {
  constexpr std::int32_t largest = 1 << 29;
  x = std::clamp(x, -largest, largest);
  y = std::clamp(y, -largest, largest);
  // The steps turn the vector by at most 99 degrees, so a vector in the left half plane is turned by half a turn first.
  std::uint32_t angle = 0;
  if (x < 0) {
    x = -x;
    y = -y;
    angle = 0x80000000U;
  }
  for (unsigned i = 0; i < std::size(arcs); ++i) {
    const std::int32_t across = x >> i;
    const std::int32_t along = y >> i;
    if (y > 0) {
      x += along;
      y -= across;
      angle += static_cast<std::uint32_t>(arcs[i]);
    } else {
      x -= along;
      y += across;
      angle -= static_cast<std::uint32_t>(arcs[i]);
    }
  }
  return {static_cast<std::int32_t>(angle), std::max(multiply(x, inverse_gain, 30), std::int32_t{0})};
}

}  // namespace proleg
