#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <vector>

#include "host/transport/open_transport.hpp"
#include "host/transport/serial_device.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

/// The devices in /dev that are serial adapters, for an error.
std::string present_devices() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("ttyUSB") || name.starts_with("ttyACM")) {
      names.push_back("/dev/" + name);
    }
  }
  return names.empty() ? "there is no /dev/ttyUSB* or /dev/ttyACM*; is the adapter plugged in?"
                       : "there is " + listed(names);
}

[[noreturn]] void fail(int error) {
  const std::string text = system_text(error);
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      throw TransportError("no such device; " + present_devices(), TransportProblem::missing);
    case EACCES:
    case EPERM:
      throw TransportError(
          "no permission: add the user to the group that owns it, then log in again: "
          "sudo usermod -aG dialout $USER",
          TransportProblem::no_rights);
    case EBUSY:
    case EWOULDBLOCK:
      throw TransportError("another program uses it (fuser shows which)", TransportProblem::in_use);
    case ENOTTY:
      throw TransportError("it is no serial line", TransportProblem::wrong_kind);
    default:
      throw TransportError(text);
  }
}

class SerialLink final : public Link {
 public:
  SerialLink(std::string device, unsigned baud) : device_(std::move(device)), baud_(baud) {}

  [[nodiscard]] Opened open() override {
    // Without O_NONBLOCK open() waits for a carrier.
    Descriptor line(::open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!line.is_open()) {
      fail(errno);
    }
    lock(line);
    configure(line);
    return {std::move(line), false};
  }
  [[nodiscard]] std::string end_text(int error) override {
    // A USB adapter that is unplugged gives the end of file or EIO.
    return error == 0 || error == EIO ? "the line is gone (was the adapter unplugged?)" : Link::end_text(error);
  }
  [[nodiscard]] std::string silence_hint() const override {
    return "is the baud rate " + std::to_string(baud_) + " right (" + device_ +
           "@BAUD), is the adapter an slcan adapter, and has the robot power?";
  }

 private:
  static void lock(const Descriptor& line) {
    // TIOCEXCL does not keep root out; the lock keeps out programs that lock, too.
    if (!isatty(line.number())) {
      fail(ENOTTY);
    }
    if (flock(line.number(), LOCK_EX | LOCK_NB) != 0) {
      fail(errno);
    }
    ioctl(line.number(), TIOCEXCL);
  }

  void configure(const Descriptor& line) const {
    termios settings{};
    if (tcgetattr(line.number(), &settings) != 0) {
      fail(errno);
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
    settings.c_cc[VMIN] = 1;  // with 0, a read without characters looks like the end of the line
    settings.c_cc[VTIME] = 0;
    const speed_t speed = serial_speed(baud_).value_or(B1000000);
    cfsetispeed(&settings, speed);
    cfsetospeed(&settings, speed);
    if (tcsetattr(line.number(), TCSANOW, &settings) != 0) {
      throw TransportError("it does not offer " + std::to_string(baud_) + " baud: " + system_text(errno));
    }
    // tcsetattr() succeeds if it could make any of the changes.
    termios result{};
    if (tcgetattr(line.number(), &result) != 0 || cfgetospeed(&result) != speed) {
      throw TransportError("it does not offer " + std::to_string(baud_) + " baud");
    }
    tcflush(line.number(), TCIOFLUSH);
    // Without this flag USB chips of FTDI keep received characters for up to 16 ms. Other drivers may refuse it.
    serial_struct serial{};
    if (ioctl(line.number(), TIOCGSERIAL, &serial) == 0) {
      serial.flags = static_cast<int>(static_cast<unsigned>(serial.flags) | ASYNC_LOW_LATENCY);
      ioctl(line.number(), TIOCSSERIAL, &serial);
    }
  }

  const std::string device_;
  const unsigned baud_;
};

}  // namespace

std::unique_ptr<Link> make_serial_link(const std::string& device, unsigned baud) {
  return std::make_unique<SerialLink>(device, baud);
}

}  // namespace proleg::host
