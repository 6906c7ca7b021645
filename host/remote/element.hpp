#pragma once

#include <cstdint>
#include <string>

namespace proleg::host {

enum class ElementKind : std::uint8_t { axis, button };

/// An element of an input device: a stick, a trigger, a button. The name is the kernel's: ABS_X, BTN_SOUTH.
struct Element {
  std::string name;
  ElementKind kind = ElementKind::button;
};

/// The range of an absolute axis that the kernel reports (EVIOCGABS).
struct AxisRange {
  std::int32_t minimum = 0;
  std::int32_t maximum = 0;
  std::int32_t flat = 0;  ///< values at most this far from the middle count as the middle
};

/// The position of an axis, -1 to 1; 0 in the middle of its range.
[[nodiscard]] double normalised(const AxisRange& range, std::int32_t value);

/// Whether an element counts as pressed. The position of a button is 0 or 1; an axis is pressed beyond a half.
/// was_pressed: the last result. The limit has a hysteresis, so that a trembling hand presses once.
[[nodiscard]] bool is_pressed(double position, bool was_pressed);

}  // namespace proleg::host
