#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "host/transport/link.hpp"

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
      throw TransportError(connect_failure(errno));
    }
    return {std::move(socket), result != 0};
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

}  // namespace

std::unique_ptr<Link> make_tcp_link(const std::string& host, unsigned port) {
  return std::make_unique<TcpLink>(host, port);
}

}  // namespace proleg::host
