#include <sys/socket.h>

#include <cerrno>

#include "host/transport/link.hpp"

namespace proleg::host {
namespace {

// The kernel's interface (include/net/bluetooth/bluetooth.h and rfcomm.h of Linux). Its C library is GPL and not used.
constexpr int bluetooth_family = 31;  // AF_BLUETOOTH
constexpr int rfcomm_protocol = 3;    // BTPROTO_RFCOMM

struct RfcommAddress {
  sa_family_t family;
  std::uint8_t device[6];  // address, the least significant byte first
  std::uint8_t channel;
};
static_assert(sizeof(RfcommAddress) == 10);

class BluetoothLink final : public Link {
 public:
  explicit BluetoothLink(const BusAddress& address) : address_(address) {}

  [[nodiscard]] Opened open() override {
    Descriptor socket(::socket(bluetooth_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, rfcomm_protocol));
    if (!socket.is_open()) {
      throw TransportError(connect_failure(errno));
    }
    RfcommAddress peer{};
    peer.family = bluetooth_family;
    for (std::size_t i = 0; i < address_.bluetooth.size(); ++i) {
      peer.device[i] = address_.bluetooth[address_.bluetooth.size() - 1 - i];
    }
    peer.channel = static_cast<std::uint8_t>(address_.number);
    const int result = connect(socket.number(), reinterpret_cast<const sockaddr*>(&peer), sizeof peer);
    if (result != 0 && errno != EINPROGRESS && errno != EAGAIN) {
      throw TransportError(connect_failure(errno));
    }
    return {std::move(socket), result != 0};
  }
  [[nodiscard]] std::string connect_failure(int error) const override {
    const std::string text = system_text(error);
    switch (error) {
      case EAFNOSUPPORT:
      case EPROTONOSUPPORT:
        return text + ": the kernel has no Bluetooth (sudo modprobe rfcomm)";
      case EHOSTUNREACH:
      case ENETDOWN:
      case ENODEV:
        return text + ": no Bluetooth adapter of this computer is on (bluetoothctl power on)";
      case EHOSTDOWN:
      case ETIMEDOUT:
        return text + ": the device is off or out of range";
      case ECONNREFUSED:
        return text + ": the device offers no serial port on channel " + std::to_string(address_.number) +
               " (sdptool browse shows channels)";
      case EACCES:
      case EPERM:
      case EBADE:
        return text + ": pair the device first (bluetoothctl pair)";
      default:
        return text;
    }
  }
  [[nodiscard]] std::string end_text(int error) override {
    return error == 0 || error == ECONNRESET || error == ETIMEDOUT
               ? "the radio connection is lost: the device is off or out of range"
               : Link::end_text(error);
  }
  [[nodiscard]] std::string silence_hint() const override {
    return "does the device serve slcan on channel " + std::to_string(address_.number) + "?";
  }
  [[nodiscard]] Microseconds connect_timeout() const override { return 15'000'000; }
  [[nodiscard]] SlcanClient::Settings client_settings() const override {
    // The radio can be silent for a second and then continue; more unconfirmed frames compensate its latency.
    SlcanClient::Settings settings;
    settings.answer_timeout = 1'000'000;
    settings.start_timeout = 6'000'000;
    settings.frame_timeout = 2'000'000;
    settings.window = 64;
    return settings;
  }

 private:
  const BusAddress address_;
};

}  // namespace

std::unique_ptr<Link> make_bluetooth_link(const BusAddress& address) {
  return std::make_unique<BluetoothLink>(address);
}

}  // namespace proleg::host
