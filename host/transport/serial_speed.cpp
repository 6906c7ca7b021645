#include "host/transport/serial_speed.hpp"

#include <array>
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

}  // namespace proleg::host
