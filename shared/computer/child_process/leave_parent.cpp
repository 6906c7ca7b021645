#include "shared/computer/child_process/leave_parent.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <vector>

namespace proleg {
namespace {

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

void leave_parent(std::span<const int> kept, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) {
    _exit(0);  // the parent ended before the call of prctl()
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    std::signal(signal, SIG_IGN);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // The other children's sockets must be closed above all: while this process held them, those children would not
  // notice the parent's end.
  close_all_but(kept);
  if (const int nothing = open("/dev/null", O_RDWR); nothing >= 0) {
    dup2(nothing, STDIN_FILENO);
    dup2(nothing, STDOUT_FILENO);
    close(nothing);
  }
}

}  // namespace proleg
