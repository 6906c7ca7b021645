#pragma once

// The gamepads, joysticks and Wiimotes of this computer, through the kernel's event devices.

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host/remote/device_listener.hpp"
#include "host/remote/device_source.hpp"
#include "host/remote/event_device.hpp"
#include "host/transport/descriptor.hpp"

namespace proleg::host {

class EventDevices final : public DeviceSource {
 public:
  struct Folders {
    std::filesystem::path devices = "/dev/input";
    std::filesystem::path classes = "/sys/class/input";
  };

  /// listener: must outlive this. The first read() finds the devices. Throws std::system_error without inotify.
  EventDevices(DeviceListener& listener, Folders folders);

  void add_descriptors(std::vector<pollfd>& descriptors) const override;
  /// False: the folder of devices does not exist yet.
  [[nodiscard]] bool is_watching() const override { return watch_ >= 0; }
  void read() override;

 private:
  struct Plugged {
    DeviceId id;
    EventDevice device;
  };

  void watch();
  /// Whether the folder has changed.
  [[nodiscard]] bool take_changes();
  /// Whether a device has gone.
  [[nodiscard]] bool read_devices();
  void find_devices();
  /// A line that says why the device cannot be used; empty: it can, or is no remote control.
  [[nodiscard]] std::string try_device(const std::filesystem::path& path);

  DeviceListener& listener_;
  Folders folders_;
  Descriptor inotify_;
  int watch_ = -1;
  DeviceId last_id_ = 0;
  std::map<std::string, Plugged> devices_;  ///< by file name: event7
  std::vector<std::string> problems_;
};

}  // namespace proleg::host
