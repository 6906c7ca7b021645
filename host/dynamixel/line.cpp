#include "host/dynamixel/line.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>

namespace proleg::host {
namespace {

constexpr std::array<unsigned, 7> rates{9600, 57'600, 115'200, 1'000'000, 2'000'000, 3'000'000, 4'000'000};
constexpr std::array<speed_t, rates.size()> speeds{B9600, B57600, B115200, B1000000, B2000000, B3000000, B4000000};
constexpr std::uint64_t write_timeout_us = 1'000'000;

std::string advice_for(int error) {
  switch (error) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
      return "; plug the adapter in, or correct the parameter 'device' (ls /dev/serial/by-id)";
    case EACCES:
    case EPERM:
      return "; add the user to the group that owns the device (usually dialout), and log in again";
    case EBUSY:
    case EWOULDBLOCK:
      return "; another program uses it: end that program";
    case EIO:
      return "; the adapter was unplugged or lost its power";
    default:
      return "";
  }
}

}  // namespace

std::span<const unsigned> serial_rates() { return rates; }

std::string latency_advice(const std::string& device) {
  std::error_code error;
  const std::string port = std::filesystem::weakly_canonical(device, error).filename();
  return "set the latency timer of the adapter to 1 ms (install 70-proleg.rules, docs/installing.md, or echo 1 > "
         "/sys/bus/usb-serial/devices/" +
         (port.starts_with("ttyUSB") ? port : "ttyUSB0") + "/latency_timer), or use a longer tick";
}

SerialLine::SerialLine(const std::string& device, unsigned rate) : device_(device) {
  descriptor_ = open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) {
    fail("cannot open", errno);
  }
  try {
    configure(rate);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

SerialLine::~SerialLine() { close(descriptor_); }

void SerialLine::configure(unsigned rate) {
  if (isatty(descriptor_) == 0) {
    throw LineError(device_ + " is no serial port; correct the parameter 'device' (ls /dev/serial/by-id)");
  }
  // The lock excludes a second host, the exclusive mode other programs.
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    fail("cannot lock", errno);
  }
  if (ioctl(descriptor_, TIOCEXCL) != 0) {
    fail("cannot take", errno);
  }
  termios settings{};
  if (tcgetattr(descriptor_, &settings) != 0) {
    fail("cannot read the settings of", errno);
  }
  cfmakeraw(&settings);
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | PARENB);
  settings.c_cflag |= static_cast<tcflag_t>(CLOCAL | CREAD | CS8);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  const auto at = static_cast<std::size_t>(std::find(rates.begin(), rates.end(), rate) - rates.begin());
  if (at == rates.size() || cfsetispeed(&settings, speeds[at]) != 0 || cfsetospeed(&settings, speeds[at]) != 0) {
    throw LineError(device_ + " has no rate of " + std::to_string(rate) + " baud");
  }
  if (tcsetattr(descriptor_, TCSANOW, &settings) != 0) {
    fail("cannot set " + std::to_string(rate) + " baud on", errno);
  }
  // tcsetattr() succeeds if it can do anything of what was requested.
  termios effective{};
  if (tcgetattr(descriptor_, &effective) != 0 || cfgetospeed(&effective) != speeds[at]) {
    throw LineError(device_ + " does not support " + std::to_string(rate) + " baud; set another rate in the servos");
  }
  // FTDI adapters keep received bytes for up to 16 ms unless this flag is set. Other drivers do not have it.
  serial_struct driver{};
  if (ioctl(descriptor_, TIOCGSERIAL, &driver) == 0) {
    driver.flags = static_cast<int>(static_cast<unsigned>(driver.flags) | ASYNC_LOW_LATENCY);
    static_cast<void>(ioctl(descriptor_, TIOCSSERIAL, &driver));
  }
  discard_input();
}

void SerialLine::fail(const std::string& action, int error) const {
  throw LineError(action + " " + device_ + ": " + std::strerror(error) + advice_for(error));
}

std::uint64_t SerialLine::now_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

/// Waits for events. Returns false at the deadline.
bool SerialLine::wait_for(short events, std::uint64_t deadline_us) {
  for (;;) {
    const std::uint64_t now = now_us();
    const std::uint64_t left_us = deadline_us > now ? deadline_us - now : 0;
    pollfd request{descriptor_, events, 0};
    const timespec left{static_cast<time_t>(left_us / 1'000'000), static_cast<long>(left_us % 1'000'000 * 1000)};
    const int ready = ppoll(&request, 1, &left, nullptr);
    if (ready > 0) {
      if ((request.revents & events) == 0) {
        fail("lost", EIO);
      }
      return true;
    }
    if (ready < 0 && errno != EINTR) {
      fail("cannot wait for", errno);
    }
    if (left_us == 0) {
      return false;
    }
  }
}

void SerialLine::write(std::span<const std::uint8_t> bytes) {
  const std::uint64_t deadline_us = now_us() + write_timeout_us;
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN) {
      if (!wait_for(POLLOUT, deadline_us)) {
        throw LineError(device_ + " took no bytes for 1 s; unplug the adapter and plug it in again");
      }
    } else if (errno != EINTR) {
      fail("cannot write to", errno);
    }
  }
}

std::size_t SerialLine::read(std::span<std::uint8_t> into, std::uint64_t deadline_us) {
  while (wait_for(POLLIN, deadline_us)) {
    const ssize_t count = ::read(descriptor_, into.data(), into.size());
    if (count > 0) {
      return static_cast<std::size_t>(count);
    }
    if (count == 0) {
      fail("lost", EIO);  // a line that is readable and has no bytes has lost its other end
    }
    if (errno != EAGAIN && errno != EINTR) {
      fail("cannot read from", errno);
    }
  }
  return 0;
}

void SerialLine::discard_input() {
  if (tcflush(descriptor_, TCIFLUSH) != 0) {
    fail("cannot use", errno);
  }
}

}  // namespace proleg::host
