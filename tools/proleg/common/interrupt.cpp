#include "tools/proleg/common/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace proleg::tools {
namespace {

std::atomic<bool> interrupt_flag = false;  // it is lock-free, so a signal handler may set it

}  // namespace

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // An ignored signal remains ignored: nohup and scripts protect their jobs this way.
    if (std::signal(signal, [](int) { interrupt_flag = true; }) == SIG_IGN) {
      std::signal(signal, SIG_IGN);
    }
  }
}

bool interrupted() { return interrupt_flag; }

}  // namespace proleg::tools
