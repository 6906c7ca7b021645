#include "host/remote/device_listener.hpp"

#include <algorithm>
#include <cmath>

namespace proleg::host {

double normalised(const AxisRange& range, std::int32_t value) {
  const double half = (static_cast<double>(range.maximum) - range.minimum) / 2;
  if (half <= 0) {
    return 0;  // some drivers declare axes without a range
  }
  const double flat = std::clamp<double>(range.flat, 0, half / 2);
  const double offset = static_cast<double>(value) - (static_cast<double>(range.maximum) + range.minimum) / 2;
  const double size = std::clamp((std::abs(offset) - flat) / (half - flat), 0.0, 1.0);
  return std::copysign(size, size > 0 ? offset : 1.0);
}

bool is_pressed(double position, bool was_pressed) {
  constexpr double press = 0.5;
  constexpr double release = 0.4;
  return position >= (was_pressed ? release : press);
}

}  // namespace proleg::host
