#include "host/remote/event_devices.hpp"

#include <fcntl.h>
#include <libevdev/libevdev.h>
#include <linux/input-event-codes.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

std::string first_line(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

[[noreturn]] void fail(int error) { throw std::system_error(error, std::generic_category()); }

}  // namespace

InputCapabilities read_capabilities(const std::filesystem::path& device_folder) {
  return {first_line(device_folder / "name"), first_line(device_folder / "capabilities/key"),
          first_line(device_folder / "capabilities/rel")};
}

bool has_bit(std::string_view bitmap, unsigned bit) {
  constexpr unsigned word_bits = sizeof(long) * CHAR_BIT;
  const std::vector<std::string_view> groups = words(bitmap);
  const std::size_t place = bit / word_bits;
  if (place >= groups.size()) {
    return false;
  }
  const std::optional<std::uint64_t> group = parse_whole<std::uint64_t>(groups[groups.size() - 1 - place], 16);
  return group && ((*group >> (bit % word_bits)) & 1U) != 0;
}

bool is_remote_control(const InputCapabilities& capabilities) {
  // The kernel's driver hid-wiimote makes several devices whose names begin so.
  if (capabilities.name.starts_with("Nintendo Wii Remote")) {
    return true;
  }
  if (has_bit(capabilities.relatives, REL_X)) {
    return false;  // a mouse
  }
  for (unsigned button = BTN_JOYSTICK; button <= BTN_THUMBR; ++button) {
    if (has_bit(capabilities.keys, button)) {
      return true;
    }
  }
  return false;
}

EventDevice::EventDevice(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)), device_(nullptr, libevdev_free) {
  if (!descriptor_.is_open()) {
    fail(errno);
  }
  libevdev* device = nullptr;
  const int result = libevdev_new_from_fd(descriptor_.number(), &device);
  if (result < 0) {
    fail(-result);
  }
  device_.reset(device);
  add_elements(EV_ABS, ABS_MISC, ElementKind::axis);  // axes above ABS_MISC are contacts of touch screens
  add_elements(EV_KEY, KEY_CNT, ElementKind::button);
}

void EventDevice::add_elements(unsigned type, unsigned codes, ElementKind kind) {
  for (unsigned code = 0; code < codes; ++code) {
    const char* const name = libevdev_event_code_get_name(type, code);
    if (name == nullptr || libevdev_has_event_code(device_.get(), type, code) == 0) {
      continue;
    }
    places_[{type, code}] = elements_.size();
    elements_.push_back({name, kind});
    codes_.emplace_back(type, code);
  }
}

double EventDevice::position(const Code& code, int value) const {
  if (code.first == EV_KEY) {
    return value != 0 ? 1 : 0;  // the value 2 repeats a key that is still pressed
  }
  const input_absinfo* const info = libevdev_get_abs_info(device_.get(), code.second);
  return normalised({info->minimum, info->maximum, info->flat}, value);
}

std::vector<double> EventDevice::positions() const {
  std::vector<double> positions;
  positions.reserve(codes_.size());
  for (const Code& code : codes_) {
    positions.push_back(position(code, libevdev_get_event_value(device_.get(), code.first, code.second)));
  }
  return positions;
}

bool EventDevice::read(const std::function<void(std::size_t element, double position)>& moved) {
  unsigned flag = LIBEVDEV_READ_FLAG_NORMAL;
  while (true) {
    input_event event{};
    const int result = libevdev_next_event(device_.get(), flag, &event);
    if (result == -EAGAIN && flag == LIBEVDEV_READ_FLAG_SYNC) {
      flag = LIBEVDEV_READ_FLAG_NORMAL;
      continue;
    }
    if (result == -EAGAIN || result == -EINTR) {
      return true;
    }
    if (result < 0) {
      return false;
    }
    if (result == LIBEVDEV_READ_STATUS_SYNC) {
      flag = LIBEVDEV_READ_FLAG_SYNC;
    }
    const auto place = places_.find({event.type, event.code});
    if (place != places_.end()) {
      moved(place->second, position(place->first, event.value));
    }
  }
}

EventDevices::EventDevices(DeviceListener& listener, Folders folders)
    : listener_(listener), folders_(std::move(folders)), inotify_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (!inotify_.is_open()) {
    throw std::system_error(errno, std::generic_category(), "inotify");
  }
}

void EventDevices::add_descriptors(std::vector<pollfd>& descriptors) const {
  descriptors.push_back({inotify_.number(), POLLIN, 0});
  for (const auto& [name, plugged] : devices_) {
    descriptors.push_back({plugged.device.descriptor(), POLLIN, 0});
  }
}

void EventDevices::read() {
  bool is_changed = take_changes();
  if (!is_watching()) {
    watch();
    is_changed = is_changed || is_watching();
  }
  // The name of a device that has gone may already belong to another device.
  is_changed = read_devices() || is_changed;
  if (is_changed) {
    find_devices();
  }
}

void EventDevices::watch() {
  // IN_ATTRIB is needed because udev grants the rights after the device has appeared.
  watch_ = inotify_add_watch(inotify_.number(), folders_.devices.c_str(),
                             IN_CREATE | IN_MOVED_TO | IN_DELETE | IN_ATTRIB | IN_ONLYDIR);
}

bool EventDevices::take_changes() {
  alignas(inotify_event) std::array<char, 4096> buffer{};
  bool is_changed = false;
  while (true) {
    const ssize_t size = ::read(inotify_.number(), buffer.data(), buffer.size());
    if (size <= 0) {
      return is_changed;
    }
    is_changed = true;
    for (const char* place = buffer.data(); place < buffer.data() + size;) {
      const auto* const event = reinterpret_cast<const inotify_event*>(place);
      if ((event->mask & IN_IGNORED) != 0) {
        watch_ = -1;  // the folder has gone with the last device
      }
      place += sizeof(inotify_event) + event->len;
    }
  }
}

bool EventDevices::read_devices() {
  bool has_gone = false;
  for (auto entry = devices_.begin(); entry != devices_.end();) {
    Plugged& plugged = entry->second;
    const auto moved = [&](std::size_t element, double position) { listener_.moved({plugged.id, element}, position); };
    if (plugged.device.read(moved)) {
      ++entry;
      continue;
    }
    listener_.unplugged(plugged.id);
    entry = devices_.erase(entry);
    has_gone = true;
  }
  return has_gone;
}

void EventDevices::find_devices() {
  std::vector<std::string> problems;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folders_.devices, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with("event") && !devices_.contains(name)) {
      std::string problem = try_device(entry->path());
      if (!problem.empty()) {
        problems.push_back(std::move(problem));
      }
    }
  }
  if (problems != problems_) {
    problems_ = std::move(problems);
    listener_.problems_changed(problems_);
  }
}

std::string EventDevices::try_device(const std::filesystem::path& path) {
  const std::string file = path.filename().string();
  const InputCapabilities capabilities = read_capabilities(folders_.classes / file / "device");
  if (!is_remote_control(capabilities)) {
    return {};
  }
  try {
    EventDevice device(path);
    const DeviceId id = ++last_id_;
    const InputDevice shown{id, one_line(capabilities.name), device.elements(), device.positions()};
    devices_.emplace(file, Plugged{id, std::move(device)});
    listener_.plugged(shown);
    return {};
  } catch (const std::system_error& error) {
    const int number = error.code().value();
    if (number == ENOENT || number == ENODEV) {
      return {};  // the device was pulled out in this moment
    }
    const std::string device = path.string() + " (" + shortened(one_line(capabilities.name)) + ")";
    if (number == EACCES || number == EPERM) {
      return device +
             ": found no right to read it, expected one: `sudo usermod -aG input $USER` and a new login, or "
             "the udev rules 70-proleg.rules (docs/installing.md)";
    }
    return device + ": " + system_text(number);
  }
}

}  // namespace proleg::host
