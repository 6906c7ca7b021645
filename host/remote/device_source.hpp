#pragma once

#include <poll.h>

#include <vector>

namespace proleg::host {

/// Where input devices come from. It reports to a DeviceListener, within read().
class DeviceSource {
 public:
  virtual ~DeviceSource() = default;

  /// Adds what to wait for before read() is called again.
  virtual void add_descriptors(std::vector<pollfd>& descriptors) const = 0;
  /// False: read() has to look for devices from time to time.
  [[nodiscard]] virtual bool is_watching() const = 0;
  /// Devices that were plugged in or out, and what has moved. Does not wait.
  virtual void read() = 0;
};

}  // namespace proleg::host
