#include "shared/computer/algorithm_library/kept_signals.hpp"

#include <pthread.h>

#include <mutex>

namespace proleg {
namespace {

struct Kept {
  std::mutex mutex;
  bool are_known = false;
  std::array<struct sigaction, ending_signals.size()> actions{};
};

Kept& kept() {
  static Kept& instance = *[] {
    pthread_atfork([] { kept().mutex.lock(); }, [] { kept().mutex.unlock(); },
                   [] {
                     kept().are_known = false;
                     kept().mutex.unlock();
                   });
    return new Kept;
  }();
  return instance;
}

/// Needs the lock.
void restore(const Kept& kept) {
  for (std::size_t i = 0; i < ending_signals.size() && kept.are_known; ++i) {
    struct sigaction now {};
    if (sigaction(ending_signals[i], nullptr, &now) == 0 && now.sa_handler != kept.actions[i].sa_handler) {
      sigaction(ending_signals[i], &kept.actions[i], nullptr);
    }
  }
}

}  // namespace

SignalState::SignalState() {
  for (int signal = 1; signal < NSIG; ++signal) {
    sigaction(signal, nullptr, &actions_[static_cast<std::size_t>(signal)]);
  }
  pthread_sigmask(SIG_SETMASK, nullptr, &mask_);
}

void SignalState::restore() const {
  for (int signal = 1; signal < NSIG; ++signal) {
    sigaction(signal, &actions_[static_cast<std::size_t>(signal)], nullptr);  // fails for SIGKILL and SIGSTOP
  }
  pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
}

void set_ending_signals(const std::function<void()>& set) {
  const std::lock_guard lock(kept().mutex);
  restore(kept());
  set();
  for (std::size_t i = 0; i < ending_signals.size(); ++i) {
    sigaction(ending_signals[i], nullptr, &kept().actions[i]);
  }
  kept().are_known = true;
}

void restore_ending_signals() {
  const std::lock_guard lock(kept().mutex);
  restore(kept());
}

}  // namespace proleg
