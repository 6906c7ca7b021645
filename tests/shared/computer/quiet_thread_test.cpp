// A quiet thread takes no signals but those it is told to take, and the thread that starts it takes its own as before.

#include "shared/computer/threads/quiet_thread.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <array>
#include <csignal>

namespace proleg {
namespace {

sigset_t blocked_signals() {
  sigset_t blocked;
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  return blocked;
}

TEST(QuietThread, BlocksAllSignalsThatCanBeBlocked) {
  sigset_t blocked;
  start_quiet_thread([&] { blocked = blocked_signals(); }).join();
  for (const int signal : {SIGINT, SIGTERM, SIGALRM, SIGUSR1, SIGCHLD, SIGHUP}) {
    EXPECT_EQ(sigismember(&blocked, signal), 1) << signal;
  }
}

TEST(QuietThread, TakesTheSignalsThatItIsToldToTake) {
  sigset_t blocked;
  start_quiet_thread([&] { blocked = blocked_signals(); }, std::array{SIGTERM, SIGALRM}).join();
  EXPECT_EQ(sigismember(&blocked, SIGTERM), 0);
  EXPECT_EQ(sigismember(&blocked, SIGALRM), 0);
  EXPECT_EQ(sigismember(&blocked, SIGINT), 1);
}

TEST(QuietThread, LeavesTheSignalsOfItsStarterAsTheyWere) {
  sigset_t wanted;
  sigemptyset(&wanted);
  sigaddset(&wanted, SIGUSR2);
  sigset_t before;
  pthread_sigmask(SIG_SETMASK, &wanted, &before);
  start_quiet_thread([] {}).join();
  const sigset_t after = blocked_signals();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_EQ(sigismember(&after, SIGUSR2), 1);
  EXPECT_EQ(sigismember(&after, SIGINT), 0);
}

}  // namespace
}  // namespace proleg
