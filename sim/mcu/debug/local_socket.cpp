#include "sim/mcu/debug/local_socket.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>

namespace proleg::sim {
namespace {

[[noreturn]] void fail(std::uint16_t port, int error) {
  throw std::runtime_error("127.0.0.1:" + std::to_string(port) + ": " + std::generic_category().message(error) +
                           "; expected a TCP port that is free, for a debugger");
}

// The kernel's interface distinguishes kinds of addresses by their first member.
sockaddr* general(sockaddr_in& address) { return reinterpret_cast<sockaddr*>(&address); }

void set_option(int socket, int level, int option) {
  const int on = 1;
  // The socket works without the option, only slower.
  static_cast<void>(setsockopt(socket, level, option, &on, sizeof on));
}

}  // namespace

FileDescriptor::~FileDescriptor() {
  if (number_ >= 0) {
    close(number_);
  }
}

LocalConnection::LocalConnection(FileDescriptor socket) : socket_(std::move(socket)) {
  // Packets are small, and each waits for its answer.
  set_option(descriptor(), IPPROTO_TCP, TCP_NODELAY);
}

std::size_t LocalConnection::send(std::string_view bytes) {
  return result(::send(descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
}

std::size_t LocalConnection::receive(std::span<char> bytes) {
  const std::ptrdiff_t length = recv(descriptor(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  open_ = open_ && length != 0;
  return result(length);
}

std::size_t LocalConnection::result(std::ptrdiff_t length) {
  if (length >= 0) {
    return static_cast<std::size_t>(length);
  }
  open_ = open_ && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  return 0;
}

LocalListener::LocalListener(std::uint16_t port)
    : socket_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (descriptor() < 0) {
    fail(port, errno);
  }
  // A port that was closed a moment ago can be used again at once.
  set_option(descriptor(), SOL_SOCKET, SO_REUSEADDR);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(descriptor(), general(address), size) != 0 || listen(descriptor(), 1) != 0 ||
      getsockname(descriptor(), general(address), &size) != 0) {
    fail(port, errno);
  }
  port_ = ntohs(address.sin_port);
}

std::optional<LocalConnection> LocalListener::accept() {
  FileDescriptor socket(accept4(descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (socket.number() < 0) {
    return std::nullopt;
  }
  return LocalConnection(std::move(socket));
}

Ready wait(const LocalListener& listener, const LocalConnection* connection, bool to_send, int milliseconds) {
  const short wanted = to_send ? POLLOUT : POLLIN;
  std::array<pollfd, 2> watched{
      {{listener.descriptor(), POLLIN, 0}, {connection == nullptr ? -1 : connection->descriptor(), wanted, 0}}};
  if (poll(watched.data(), watched.size(), milliseconds) <= 0) {
    return {};
  }
  return {watched[0].revents != 0, watched[1].revents != 0};
}

}  // namespace proleg::sim
