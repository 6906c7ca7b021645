#pragma once

#include <poll.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/remote/element.hpp"

namespace proleg::host {

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
