#include "host/transport/pseudo_terminal.hpp"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <utility>

#include "host/transport/transport.hpp"

namespace proleg::host {
namespace {

constexpr Microseconds look_period = 20'000;

[[noreturn]] void fail() { throw TransportError(std::string("no pseudo terminal: ") + system_text(errno)); }

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

}  // namespace proleg::host
