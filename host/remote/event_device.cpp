#include "host/remote/event_device.hpp"

#include <fcntl.h>
#include <libevdev/libevdev.h>

#include <cerrno>
#include <system_error>

namespace proleg::host {
namespace {

[[noreturn]] void fail(int error) { throw std::system_error(error, std::generic_category()); }

}  // namespace

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
  add_elements(EV_ABS, ABS_MISC, ElementKind::axis);  // above it: contacts of touch screens
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
    return value != 0 ? 1 : 0;  // 2: the key is still pressed
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

}  // namespace proleg::host
