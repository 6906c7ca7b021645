#include "tests/host/dynamixel/pty_servos.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <stdexcept>

namespace proleg::test {
namespace {

std::uint64_t now_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

}  // namespace

PtyServos::PtyServos(ServoEmulator& servos) : servos_(servos), terminal_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
  std::array<char, 256> name{};
  if (terminal_ < 0 || grantpt(terminal_) != 0 || unlockpt(terminal_) != 0 ||
      ptsname_r(terminal_, name.data(), name.size()) != 0) {
    throw std::runtime_error("no pseudo terminal");
  }
  device_ = name.data();
  thread_ = std::thread([this] { serve(); });
}

PtyServos::~PtyServos() { stop(); }

void PtyServos::stop() {
  if (thread_.joinable()) {
    must_end_ = true;
    thread_.join();
    close(terminal_);
  }
}

void PtyServos::serve() {
  while (!must_end_) {
    pollfd request{terminal_, POLLIN, 0};
    const int ready = poll(&request, 1, 5);
    servos_.advance(now_us());
    if (ready <= 0 || (request.revents & POLLIN) == 0) {
      if (ready > 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // no program has the device open
      }
      continue;
    }
    std::array<std::uint8_t, 512> bytes{};
    const ssize_t count = read(terminal_, bytes.data(), bytes.size());
    if (count <= 0) {
      continue;
    }
    for (const auto& answer : servos_.receive(std::span(bytes).first(static_cast<std::size_t>(count)), now_us())) {
      static_cast<void>(!write(terminal_, answer.bytes.data(), answer.bytes.size()));
    }
  }
}

}  // namespace proleg::test
