#include "host/transport/serial_device.hpp"

#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <vector>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

struct Speed {
  unsigned baud;
  speed_t code;
};

constexpr std::array<Speed, 17> speeds{{
    {9'600, B9600},
    {19'200, B19200},
    {38'400, B38400},
    {57'600, B57600},
    {115'200, B115200},
    {230'400, B230400},
    {460'800, B460800},
    {500'000, B500000},
    {576'000, B576000},
    {921'600, B921600},
    {1'000'000, B1000000},
    {1'152'000, B1152000},
    {1'500'000, B1500000},
    {2'000'000, B2000000},
    {2'500'000, B2500000},
    {3'000'000, B3000000},
    {4'000'000, B4000000},
}};

namespace fs = std::filesystem;

std::string group_name(gid_t group) {
  const ::group* entry = getgrgid(group);
  return entry != nullptr ? entry->gr_name : std::to_string(group);
}

bool is_in_group(gid_t group) {
  if (getegid() == group) {
    return true;
  }
  const int count = getgroups(0, nullptr);
  std::vector<gid_t> groups(static_cast<std::size_t>(std::max(count, 0)));
  const int read = getgroups(static_cast<int>(groups.size()), groups.data());
  return std::find(groups.begin(), groups.begin() + std::max(read, 0), group) != groups.begin() + std::max(read, 0);
}

/// Whether a process has the device open. Only the links of the process are read: a file on a network that does not
/// answer must not block this program.
bool has_open(const fs::path& process, dev_t device) {
  std::error_code error;
  for (fs::directory_iterator place(process / "fd", error); !error && place != fs::directory_iterator();
       place.increment(error)) {
    std::error_code gone;
    const fs::path file = fs::read_symlink(place->path(), gone);
    struct stat status {};
    if (!gone && file.string().starts_with("/dev/") && ::stat(file.c_str(), &status) == 0 && S_ISCHR(status.st_mode) &&
        status.st_rdev == device) {
      return true;
    }
  }
  return false;
}

std::vector<std::string> programs_with(dev_t device) {
  std::vector<std::string> programs;
  std::error_code error;
  // A process that ends while its folder is read has no file open.
  for (fs::directory_iterator place("/proc", error); !error && place != fs::directory_iterator();
       place.increment(error)) {
    const std::string number = place->path().filename();
    if (parse_whole<unsigned>(number) && has_open(place->path(), device)) {
      std::string name;
      std::getline(std::ifstream(place->path() / "comm"), name);
      programs.push_back(one_line(name) + " (process " + number + ")");
    }
  }
  return programs;
}

}  // namespace

std::optional<speed_t> serial_speed(unsigned baud) {
  for (const Speed& speed : speeds) {
    if (speed.baud == baud) {
      return speed.code;
    }
  }
  return std::nullopt;
}

std::string serial_speeds_text() {
  std::vector<std::string> texts;
  texts.reserve(speeds.size());
  for (const Speed& speed : speeds) {
    texts.push_back(std::to_string(speed.baud));
  }
  return listed(texts);
}

SerialDevice read_serial_device(const std::string& path) {
  SerialDevice device;
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return device;
  }
  device.exists = true;
  device.is_character_device = S_ISCHR(status.st_mode);
  device.may_use = access(path.c_str(), R_OK | W_OK) == 0;
  device.group = group_name(status.st_gid);
  device.is_user_in_group = is_in_group(status.st_gid);
  if (device.is_character_device) {
    device.programs = programs_with(status.st_rdev);
  }
  return device;
}

}  // namespace proleg::host
