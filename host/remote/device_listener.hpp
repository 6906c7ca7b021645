#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/remote/element.hpp"

namespace proleg::host {

/// Number of a device since it was plugged in, from 1; not used twice.
using DeviceId = std::uint32_t;

/// An element of a device: its place in InputDevice::elements.
using ElementPlace = std::pair<DeviceId, std::size_t>;

struct InputDevice {
  DeviceId id = 0;
  std::string name;  ///< as the kernel says; two devices of a kind have one name
  std::vector<Element> elements;
  std::vector<double> positions;  ///< of the elements, as they are now
};

/// Receives what input devices do.
class DeviceListener {
 public:
  virtual ~DeviceListener() = default;

  virtual void plugged(const InputDevice& device) = 0;
  virtual void moved(const ElementPlace& element, double position) = 0;
  virtual void unplugged(DeviceId device) = 0;
  /// All devices that cannot be used: one line each, which says what to do.
  virtual void problems_changed(const std::vector<std::string>& problems) = 0;
};

}  // namespace proleg::host
