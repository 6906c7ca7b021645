#pragma once

#include <poll.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

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
[[nodiscard]] inline double normalised(const AxisRange& range, std::int32_t value) {
  const double half = (static_cast<double>(range.maximum) - range.minimum) / 2;
  if (half <= 0) {
    return 0;  // some drivers declare axes without a range
  }
  const double flat = std::clamp<double>(range.flat, 0, half / 2);
  const double offset = static_cast<double>(value) - (static_cast<double>(range.maximum) + range.minimum) / 2;
  const double size = std::clamp((std::abs(offset) - flat) / (half - flat), 0.0, 1.0);
  return std::copysign(size, size > 0 ? offset : 1.0);
}

/// Whether an element counts as pressed. The position of a button is 0 or 1; an axis is pressed beyond a half.
/// was_pressed: the last result. The limit has a hysteresis, so that a trembling hand presses once.
[[nodiscard]] inline bool is_pressed(double position, bool was_pressed) {
  constexpr double press = 0.5;
  constexpr double release = 0.4;
  return position >= (was_pressed ? release : press);
}

/// Number that a device gets when it is plugged in, from 1; no number is used twice.
using DeviceId = std::uint32_t;

/// A device, and the index of one of its elements in InputDevice::elements.
using ElementPlace = std::pair<DeviceId, std::size_t>;

struct InputDevice {
  DeviceId id = 0;
  std::string name;  ///< name that the kernel reports; two devices of a kind have the same name
  std::vector<Element> elements;
  std::vector<double> positions;  ///< present positions of the elements
};

/// Receives events of input devices.
class DeviceListener {
 public:
  virtual ~DeviceListener() = default;

  virtual void plugged(const InputDevice& device) = 0;
  virtual void moved(const ElementPlace& element, double position) = 0;
  virtual void unplugged(DeviceId device) = 0;
  /// problems: one line for each device that cannot be used, which says what to do.
  virtual void problems_changed(const std::vector<std::string>& problems) = 0;
};

/// Finds input devices and reads them. It calls a DeviceListener within read().
class DeviceSource {
 public:
  virtual ~DeviceSource() = default;

  /// Adds the descriptors that can be read when read() must be called again.
  virtual void add_descriptors(std::vector<pollfd>& descriptors) const = 0;
  /// Whether a descriptor reports new devices. If not, read() must be called from time to time to look for them.
  [[nodiscard]] virtual bool is_watching() const = 0;
  /// Reports devices that were plugged in or out, and elements that have moved. Does not wait.
  virtual void read() = 0;
};

}  // namespace proleg::host
