#include "shared/computer/algorithm_library/kept_signals.hpp"

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
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

std::atomic<bool> are_changed = false;

/// Needs the lock.
void restore(const Kept& kept) {
  for (std::size_t i = 0; i < ending_signals.size() && kept.are_known; ++i) {
    struct sigaction now {};
    if (sigaction(ending_signals[i], nullptr, &now) == 0 && now.sa_handler != kept.actions[i].sa_handler) {
      are_changed = true;
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

bool do_libraries_change_signals() { return are_changed; }

void lock_ending_signals() {
  static_assert(ending_signals == std::array{SIGINT, SIGTERM, SIGHUP});
  const auto load = [](std::size_t offset) {
    return sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset));
  };
  const auto go_if_equal = [](std::uint32_t value, std::uint8_t equal, std::uint8_t other) {
    return sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, equal, other);
  };
  constexpr std::size_t new_action = offsetof(seccomp_data, args) + sizeof(std::uint64_t);
  // Reading an action, without a new one, is allowed. The number of a system call counts for one architecture: this
  // program makes no calls of another one.
  std::array filter{load(offsetof(seccomp_data, nr)),
                    go_if_equal(SYS_rt_sigaction, 0, 9),
                    load(new_action),
                    go_if_equal(0, 0, 2),
                    load(new_action + sizeof(std::uint32_t)),
                    go_if_equal(0, 5, 0),
                    load(offsetof(seccomp_data, args)),
                    go_if_equal(SIGINT, 2, 0),
                    go_if_equal(SIGTERM, 1, 0),
                    go_if_equal(SIGHUP, 0, 1),
                    sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO),
                    sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  const sock_fprog program{filter.size(), filter.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) {
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
  }
}

}  // namespace proleg
