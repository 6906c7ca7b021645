#pragma once

// The gamepads, joysticks and Wiimotes of this computer, through the kernel's event devices.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/remote/device_listener.hpp"
#include "host/transport/descriptor.hpp"

struct libevdev;

namespace proleg::host {

/// Capabilities of an input device that the kernel reports in /sys/class/input/eventN/device. Every user may read this
/// folder, so keyboards and mice are never opened.
struct InputCapabilities {
  std::string name;
  std::string keys;       ///< text of the file capabilities/key
  std::string relatives;  ///< text of the file capabilities/rel
};

/// Reads the capabilities; the text of a file that is absent is empty.
[[nodiscard]] InputCapabilities read_capabilities(const std::filesystem::path& device_folder);

/// Whether a bit is set in a bitmap as the kernel writes it: hexadecimal numbers of the size of a long, the highest
/// first. False for any other text.
[[nodiscard]] bool has_bit(std::string_view bitmap, unsigned bit);

/// Whether the device is a gamepad, a joystick, or a part of a Wiimote.
[[nodiscard]] bool is_remote_control(const InputCapabilities& capabilities);

/// One event device of the kernel, /dev/input/eventN.
class EventDevice {
 public:
  /// Opens the device. Throws std::system_error if it cannot be opened.
  explicit EventDevice(const std::filesystem::path& path);

  [[nodiscard]] int descriptor() const { return descriptor_.number(); }
  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  [[nodiscard]] std::vector<double> positions() const;

  /// Calls the function for each movement that was received, and does not wait. If the kernel has dropped events, the
  /// positions are read again. Returns false if the device has gone.
  [[nodiscard]] bool read(const std::function<void(std::size_t element, double position)>& moved);

 private:
  using Code = std::pair<unsigned, unsigned>;  ///< type and code of an event

  void add_elements(unsigned type, unsigned codes, ElementKind kind);
  [[nodiscard]] double position(const Code& code, int value) const;

  Descriptor descriptor_;
  std::unique_ptr<libevdev, void (*)(libevdev*)> device_;
  std::vector<Element> elements_;
  std::vector<Code> codes_;  ///< event codes, by element
  std::map<Code, std::size_t> places_;
};

class EventDevices final : public DeviceSource {
 public:
  struct Folders {
    std::filesystem::path devices = "/dev/input";
    std::filesystem::path classes = "/sys/class/input";
  };

  /// listener: must outlive this. The first read() finds the devices. Throws std::system_error without inotify.
  EventDevices(DeviceListener& listener, Folders folders);

  void add_descriptors(std::vector<pollfd>& descriptors) const override;
  /// Whether inotify watches the folder of devices; false if the folder does not exist yet.
  [[nodiscard]] bool is_watching() const override { return watch_ >= 0; }
  void read() override;

 private:
  struct Plugged {
    DeviceId id;
    EventDevice device;
  };

  void watch();
  /// Reads the events of inotify. Returns whether the folder has changed.
  [[nodiscard]] bool take_changes();
  /// Reads all devices. Returns whether one has gone.
  [[nodiscard]] bool read_devices();
  void find_devices();
  /// Opens the device if it is a remote control. Returns a line that says why it cannot be used, or an empty one.
  [[nodiscard]] std::string try_device(const std::filesystem::path& path);

  DeviceListener& listener_;
  Folders folders_;
  Descriptor inotify_;
  int watch_ = -1;
  DeviceId last_id_ = 0;
  std::map<std::string, Plugged> devices_;  ///< devices by file name, such as event7
  std::vector<std::string> problems_;
};

}  // namespace proleg::host
