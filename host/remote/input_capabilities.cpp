#include "host/remote/input_capabilities.hpp"

#include <linux/input-event-codes.h>

#include <climits>
#include <cstdint>
#include <fstream>
#include <optional>
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

}  // namespace proleg::host
