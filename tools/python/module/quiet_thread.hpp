#pragma once

#include <pthread.h>

#include <csignal>
#include <thread>

namespace proleg::python {

/// A thread that gets no signals: they are for the threads of Python, which raises KeyboardInterrupt.
[[nodiscard]] std::thread start_quiet_thread(const auto& work) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(work);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace proleg::python
