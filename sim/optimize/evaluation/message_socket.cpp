#include "sim/optimize/evaluation/message_socket.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <system_error>

namespace proleg::optimize {
namespace {

/// Bytes. The largest batch of candidates with the most dimensions takes a quarter of a million; the system's default
/// is less.
constexpr int max_message = 400'000;

}  // namespace

std::pair<int, int> make_message_sockets() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "opening a socket");
  }
  for (const int end : ends) {
    if (setsockopt(end, SOL_SOCKET, SO_SNDBUF, &max_message, sizeof max_message) != 0) {
      const int error = errno;
      std::ranges::for_each(ends, close);
      throw std::system_error(error, std::generic_category(), "giving a socket its room");
    }
  }
  return {ends[0], ends[1]};
}

Bytes receive_message(int socket) {
  while (true) {
    std::byte none{};
    const ssize_t size = recv(socket, &none, 1, MSG_PEEK | MSG_TRUNC);
    if (size > 0) {
      Bytes message(static_cast<std::size_t>(size));
      const ssize_t received = recv(socket, message.data(), message.size(), 0);
      if (received == size) {
        return message;
      }
    } else if (size == 0 || errno != EINTR) {
      return {};
    }
  }
}

bool send_message(int socket, const Bytes& message) {
  ssize_t sent = -1;
  do {
    sent = ::send(socket, message.data(), message.size(), MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent < 0 && errno == EMSGSIZE) {
    throw std::system_error(errno, std::generic_category(),
                            "sending " + std::to_string(message.size()) + " bytes to a process");
  }
  return sent == static_cast<ssize_t>(message.size());
}

}  // namespace proleg::optimize
