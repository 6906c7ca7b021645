#include "host/transport/listeners.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <utility>

#include "host/transport/bus_address.hpp"
#include "host/transport/transport.hpp"

namespace proleg::host {
namespace {

constexpr Microseconds look_period = 20'000;

[[noreturn]] void fail() { throw TransportError(std::string("no pseudo terminal: ") + system_text(errno)); }

constexpr int backlog = 8;

/// The text of an address and port: "127.0.0.1:20000", "[::1]:20000".
std::string address_text(const sockaddr_storage& address, socklen_t size) {
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  const int error = getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host.data(), host.size(),
                                port.data(), port.size(), NI_NUMERICHOST | NI_NUMERICSERV);
  if (error != 0) {
    return "unknown";
  }
  const std::string name = address.ss_family == AF_INET6 ? "[" + std::string(host.data()) + "]" : host.data();
  return name + ":" + port.data();
}

}  // namespace

PseudoTerminal::PseudoTerminal(boost::asio::io_context& context, std::function<void(Descriptor)> function)
    : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)),
      function_(std::move(function)),
      timer_(context, [this] { look(); }) {
  std::array<char, 256> name{};
  if (!master_.is_open() || grantpt(master_.number()) != 0 || unlockpt(master_.number()) != 0 ||
      ptsname_r(master_.number(), name.data(), name.size()) != 0) {
    fail();
  }
  name_ = name.data();
  prepare();
  client_gone();
}

void PseudoTerminal::client_gone() {
  if (!has_client()) {  // the next client may have opened the terminal already
    prepare();
  }
  timer_.set(steady_now());
}

/// Prepares the terminal for the next client: raw, without echo, and without characters for the previous client.
void PseudoTerminal::prepare() const {
  const Descriptor client(open(name_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  termios settings{};
  if (client.is_open() && tcgetattr(client.number(), &settings) == 0) {
    cfmakeraw(&settings);
    tcsetattr(client.number(), TCSANOW, &settings);
    tcflush(client.number(), TCIFLUSH);
  }
}

bool PseudoTerminal::has_client() const {
  pollfd request{master_.number(), POLLIN, 0};
  return poll(&request, 1, 0) >= 0 && (request.revents & POLLHUP) == 0;
}

/// Looks for a client, because the kernel has no event for a client that opens the terminal.
void PseudoTerminal::look() {
  if (!has_client()) {
    timer_.set(steady_now() + look_period);
    return;
  }
  Descriptor copy(fcntl(master_.number(), F_DUPFD_CLOEXEC, 0));
  if (copy.is_open()) {
    function_(std::move(copy));
  } else {
    timer_.set(steady_now() + look_period);  // this process has too many open files
  }
}

TcpListener::TcpListener(boost::asio::io_context& context, const std::string& host, std::uint16_t port,
                         std::function<void(Descriptor, const std::string&)> function)
    : function_(std::move(function)) {
  listen(host, port);
  watch_ = std::make_unique<DescriptorWatch>(context, socket_.number(), [this] { accept_clients(); });
}

void TcpListener::listen(const std::string& host, std::uint16_t port) {
  const std::string name = bus_address_text({BusAddress::Kind::tcp, host, port, {}}) + ": ";
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  addrinfo* results = nullptr;
  const int error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &results);
  if (error != 0) {
    throw TransportError(name + gai_strerror(error));
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(results, freeaddrinfo);
  socket_ = Descriptor(::socket(results->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  // A port can be used again at once after its program has ended.
  setsockopt(socket_.number(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(socket_.number(), results->ai_addr, results->ai_addrlen) != 0 || ::listen(socket_.number(), backlog) != 0) {
    const int bind_error = errno;
    throw TransportError(name + system_text(bind_error) +
                         (bind_error == EADDRINUSE ? ": another program listens there; choose another port" : ""));
  }
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  getsockname(socket_.number(), reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                              : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

void TcpListener::accept_clients() {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  Descriptor client(
      accept4(socket_.number(), reinterpret_cast<sockaddr*>(&address), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!client.is_open()) {
    return;  // the client has gone again
  }
  const int on = 1;
  setsockopt(client.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  function_(std::move(client), address_text(address, size));
}

}  // namespace proleg::host
