#include "shared/computer/algorithm_library/call_watchdog.hpp"

#include <pthread.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <system_error>
#include <thread>

#include "shared/computer/algorithm_library/guard_signals.hpp"
#include "shared/computer/algorithm_library/kept_signals.hpp"
#include "shared/computer/algorithm_library/program_end.hpp"
#include "shared/computer/threads/quiet_thread.hpp"

namespace proleg {
namespace {

/// Processor time after which a call counts as an endless loop, and time after which it counts as stuck.
constexpr double longest_call_cpu_s = 1.0;
constexpr double longest_call_wall_s = 20.0;

constexpr auto watchdog_period = std::chrono::milliseconds(20);
/// What an interrupted call may have left locked must be free after so many periods, 3 s. A clock would also count the
/// time for which a whole computer was suspended.
constexpr unsigned most_looks = 150;

/// Of the process: a fork() makes the next one.
std::atomic<unsigned> generation = 1;

double seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Ends calls that take too long. Its thread sends a signal to the thread of such a call, and none otherwise, so that
/// no system call of the program is interrupted. It also ends the program if an interrupted call has left a lock of the
/// C library behind: printing the reason would wait for ever then, and SIGTERM would have no effect.
class Watchdog {
 public:
  /// Never destroyed: its thread runs until the process ends.
  static Watchdog& instance() {
    static Watchdog& watchdog = *new Watchdog;
    return watchdog;
  }

  void watch(ThreadGuard& guard) {
    const std::lock_guard lock(mutex_);
    guard.is_watched = false;
    for (Watched& watched : watched_) {
      if (watched.guard == nullptr) {
        watched = {&guard, 0, 0, 0, 0};
        guard.is_watched = true;
        break;
      }
    }
    guard.generation = generation;
    if (!runs_) {
      start();
    }
  }

  void check_after_signal(ThreadGuard& guard) {
    guard.looks = 0;
    guard.memory_is_free = false;
    guard.streams_are_free = !runs_ || !guard.is_watched;
    guard.is_checked = true;
    // The locks of memory are those of this thread's arena. A damaged list ends in a signal.
    for (const std::size_t size : {24U, 1000U, 100000U}) {
      void* const volatile memory = std::malloc(size);
      std::free(memory);
    }
    guard.memory_is_free = true;
    // A lock of a stream is taken again by the thread that has it: only another thread sees it.
    while (!guard.streams_are_free) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    guard.is_checked = false;
  }

  void forget(const ThreadGuard& guard) {
    const std::lock_guard lock(mutex_);
    for (Watched& watched : watched_) {
      if (watched.guard == &guard) {
        watched.guard = nullptr;
      }
    }
  }

 private:
  struct Watched {
    ThreadGuard* guard = nullptr;
    std::uint64_t call = 0;  ///< number of the call that the watchdog has seen last
    double cpu_s = 0;        ///< processor time when the call was seen first
    double wall_s = 0;
    unsigned signals = 0;  ///< that were sent to this call
  };

  Watchdog() {
    // A fork() copies the memory but not the thread.
    pthread_atfork([] { instance().mutex_.lock(); }, [] { instance().mutex_.unlock(); },
                   [] {
                     // The child would do what the program does, and drive its robot on when that has ended.
                     if (current_guard != nullptr && current_guard->is_active) {
                       end_program_after(*current_guard, "calls fork()", "; the copy of the program ends");
                     }
                     instance().runs_ = false;
                     instance().watched_ = {};
                     ++generation;
                     instance().mutex_.unlock();
                   });
  }

  void start() {
    try {
      // The thread takes these signals if a library blocks them in all other threads.
      start_quiet_thread([this] { run(); }, ending_signals).detach();
      runs_ = true;
    } catch (const std::system_error&) {
      // Without a thread an endless loop is not found; all else works.
    }
  }

  void run() {
    while (true) {
      std::this_thread::sleep_for(watchdog_period);
      look_at_program_end();
      restore_ending_signals();
      set_guard_handlers();
      const std::lock_guard lock(mutex_);
      for (Watched& watched : watched_) {
        if (watched.guard != nullptr) {
          look_at(watched);
        }
      }
    }
  }

  /// Results are written before exit() is called, so what then still runs is of the library.
  void look_at_program_end() {
    if (program_is_ending() && blamed_file() != nullptr && ++looks_at_end_ > most_looks) {
      end_program_that_stays();
    }
  }

  static bool is_free(std::FILE* stream) {
    if (ftrylockfile(stream) != 0) {
      return false;
    }
    funlockfile(stream);
    return true;
  }

  static void look_at(Watched& watched) {
    ThreadGuard& guard = *watched.guard;
    guard.is_look_due = true;
    if (guard.is_checked) {
      const bool streams_are_free = is_free(stdout) && is_free(stderr);
      if (!(streams_are_free && guard.memory_is_free) && ++guard.looks > most_looks) {
        end_program_after(guard, text_of(guard), left_damaged);
      }
      guard.streams_are_free = streams_are_free;
      return;
    }
    const std::uint64_t call = guard.call;
    clockid_t clock = 0;
    if (!guard.is_active || pthread_getcpuclockid(guard.thread, &clock) != 0) {
      return;
    }
    const double cpu_s = seconds(clock);
    const double wall_s = seconds(CLOCK_MONOTONIC);
    if (call != watched.call) {
      watched.call = call;
      watched.cpu_s = cpu_s;
      watched.wall_s = wall_s;
      watched.signals = 0;
    } else if (const bool loops = cpu_s - watched.cpu_s > longest_call_cpu_s;
               loops || wall_s - watched.wall_s > longest_call_wall_s) {
      if (watched.signals == 0) {
        guard.waits = !loops;
      } else if (watched.signals > most_looks) {
        guard.signal = time_out_signal;
        end_program_after(guard, text_of(guard), "; it blocks signals, so the program ends without its results");
      }
      ++watched.signals;
      guard.expired = call;
      pthread_kill(guard.thread, time_out_signal);
    }
  }

  std::mutex mutex_;
  std::array<Watched, 64> watched_{};
  std::atomic<bool> runs_ = false;
  unsigned looks_at_end_ = 0;
};

}  // namespace

void watch_calls(ThreadGuard& guard) { Watchdog::instance().watch(guard); }

bool watches_calls(const ThreadGuard& guard) { return guard.generation == generation; }

void forget_calls(const ThreadGuard& guard) { Watchdog::instance().forget(guard); }

void check_after_signal(ThreadGuard& guard) { Watchdog::instance().check_after_signal(guard); }

}  // namespace proleg
