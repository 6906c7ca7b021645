// Links over sockets: TCP, and RFCOMM of Bluetooth.

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "host/transport/open_transport.hpp"

namespace proleg::host {
namespace {

class TcpLink final : public Link {
 public:
  TcpLink(std::string host, unsigned port) : host_(std::move(host)), port_(port) {}

  [[nodiscard]] Opened open() override {
    if (addresses_.empty()) {
      resolve();
    }
    const Address& address = addresses_[next_];
    next_ = (next_ + 1) % addresses_.size();
    Descriptor socket(::socket(address.bytes.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (!socket.is_open()) {
      throw TransportError(connect_failure(errno));
    }
    // Frames are short and must not wait for others, so Nagle's algorithm is switched off.
    const int on = 1;
    setsockopt(socket.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    notice_dead_peers(socket.number());
    const int result = connect(socket.number(), reinterpret_cast<const sockaddr*>(&address.bytes), address.size);
    if (result != 0 && errno != EINPROGRESS) {
      const int error = errno;
      throw TransportError(connect_failure(error), connect_problem(error));
    }
    return {std::move(socket), result != 0};
  }
  [[nodiscard]] TransportProblem connect_problem(int error) const override {
    return error == ECONNREFUSED ? TransportProblem::no_listener : TransportProblem::other;
  }
  [[nodiscard]] std::string connect_failure(int error) const override {
    const std::string text = system_text(error);
    if (error == ECONNREFUSED) {
      return text + ": no program listens there (proleg bus FILE --tcp " + std::to_string(port_) + ")";
    }
    return text + ": is the host on, and is there a way to it?";
  }
  [[nodiscard]] std::string silence_hint() const override { return "is it an slcan server that listens there?"; }
  [[nodiscard]] std::size_t alternatives() const override { return std::max<std::size_t>(addresses_.size(), 1); }
  [[nodiscard]] SlcanClient::Settings client_settings() const override {
    SlcanClient::Settings settings;
    settings.answer_timeout = 1'000'000;
    settings.start_timeout = 5'000'000;
    return settings;
  }

 private:
  struct Address {
    sockaddr_storage bytes;
    socklen_t size;
  };

  void resolve() {
    int error = add_addresses(host_);
    if (error != 0 && host_ == "localhost") {
      // A computer need not have a file that says so; the name always means this computer (RFC 6761, section 6.3).
      error = add_addresses("127.0.0.1");
      static_cast<void>(add_addresses("::1"));
    }
    if (error != 0) {
      throw TransportError(std::string("no address of the host is known: ") + gai_strerror(error));
    }
  }

  /// Adds the addresses of a host. Returns the error of getaddrinfo(), or 0.
  int add_addresses(const std::string& host) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* results = nullptr;
    const int error = getaddrinfo(host.c_str(), std::to_string(port_).c_str(), &hints, &results);
    if (error != 0) {
      return error;
    }
    for (const addrinfo* result = results; result != nullptr; result = result->ai_next) {
      Address address{{}, result->ai_addrlen};
      std::memcpy(&address.bytes, result->ai_addr, std::min<std::size_t>(result->ai_addrlen, sizeof address.bytes));
      addresses_.push_back(address);
    }
    freeaddrinfo(results);
    return 0;
  }

  /// Notices within 5 + 3 * 2 s a peer that has lost its power, and so does not close the connection.
  static void notice_dead_peers(int socket) {
    const int on = 1;
    const int idle_s = 5;
    const int interval_s = 2;
    const int probes = 3;
    setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &idle_s, sizeof idle_s);
    setsockopt(socket, IPPROTO_TCP, TCP_KEEPINTVL, &interval_s, sizeof interval_s);
    setsockopt(socket, IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
  }

  const std::string host_;
  const unsigned port_;
  std::vector<Address> addresses_;
  std::size_t next_ = 0;
};

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

std::unique_ptr<Link> make_tcp_link(const std::string& host, unsigned port) {
  return std::make_unique<TcpLink>(host, port);
}

std::unique_ptr<Link> make_bluetooth_link(const BusAddress& address) {
  return std::make_unique<BluetoothLink>(address);
}

}  // namespace proleg::host
