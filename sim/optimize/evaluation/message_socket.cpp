#include "sim/optimize/evaluation/message_socket.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <vector>

namespace proleg::optimize {
namespace {

/// Bytes. The largest batch of candidates with the most dimensions takes a quarter of a million; the system's default
/// is less.
constexpr int max_message = 400'000;

void close_all_but(std::span<const int> kept) {
  std::vector<int> sorted(kept.begin(), kept.end());
  std::ranges::sort(sorted);
  unsigned first = 3;
  for (const int each : sorted) {
    if (static_cast<unsigned>(each) > first) {
      close_range(first, static_cast<unsigned>(each) - 1, 0);
    }
    first = static_cast<unsigned>(each) + 1;
  }
  close_range(first, ~0U, 0);
}

}  // namespace

std::pair<int, int> make_message_sockets() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "opening a socket");
  }
  for (const int end : ends) {
    setsockopt(end, SOL_SOCKET, SO_SNDBUF, &max_message, sizeof max_message);
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
  return sent == static_cast<ssize_t>(message.size());
}

void leave_parent(std::span<const int> sockets, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) {
    _exit(0);  // the parent ended before prctl()
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    std::signal(signal, SIG_IGN);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // Above all the other children's sockets: while this process held them, those would not see the parent's end.
  close_all_but(sockets);
  if (const int nothing = open("/dev/null", O_RDWR); nothing >= 0) {
    dup2(nothing, STDIN_FILENO);
    dup2(nothing, STDOUT_FILENO);
    close(nothing);
  }
}

}  // namespace proleg::optimize
