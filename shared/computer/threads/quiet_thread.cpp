#include "shared/computer/threads/quiet_thread.hpp"

#include <pthread.h>

#include <csignal>
#include <span>
#include <utility>

namespace proleg {
namespace {

/// A thread begins with the blocked signals of the one that starts it.
class BlockedSignals {
 public:
  explicit BlockedSignals(const sigset_t& blocked) { pthread_sigmask(SIG_SETMASK, &blocked, &before_); }
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

std::thread start_quiet_thread(std::function<void()> work, std::span<const int> taken) {
  sigset_t all;
  sigfillset(&all);
  for (const int signal : taken) {
    sigdelset(&all, signal);
  }
  const BlockedSignals blocked(all);
  return std::thread(std::move(work));
}

}  // namespace proleg
