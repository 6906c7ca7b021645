#include "shared/computer/algorithm_library/guarded_call.hpp"

#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csetjmp>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "shared/computer/algorithm_library/floating_point_modes.hpp"
#include "shared/computer/algorithm_library/kept_signals.hpp"
#include "shared/computer/algorithm_library/last_line.hpp"

namespace proleg {
namespace {

/// The signal that the watchdog sends to a thread. No program of the tree uses it for anything else.
constexpr int time_out_signal = SIGVTALRM;
constexpr std::array caught_signals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, time_out_signal};
constexpr std::size_t signal_stack_size = 64 * 1024;
constexpr auto watchdog_period = std::chrono::milliseconds(20);
/// What an interrupted call may have left locked must be free after so many periods, 3 s. A clock would also count the
/// time for which a whole computer was suspended.
constexpr unsigned most_looks = 150;

bool is_bad_access(int signal) { return signal == SIGSEGV || signal == SIGBUS; }

/// What a thread needs to leave a call.
struct ThreadGuard {
  sigjmp_buf jump{};
  std::atomic<bool> is_active = false;
  std::atomic<std::uint64_t> call = 0;     ///< number of the present or last call
  std::atomic<std::uint64_t> expired = 0;  ///< number of the call that took too long
  std::atomic<bool> is_checked = false;    ///< a signal has ended the call: is the C library usable?
  std::atomic<bool> memory_is_free = false;
  std::atomic<bool> streams_are_free = false;
  std::atomic<unsigned> looks = 0;        ///< of the watchdog during the check
  std::atomic<bool> is_look_due = false;  ///< the mask of signals is to be restored after the next call
  std::atomic<bool> waits = false;        ///< the call that took too long took little processor time
  bool is_terminated = false;             ///< std::terminate() was called
  int signal = 0;
  std::optional<const void*> address;  ///< of a bad access to memory; nothing if the process sent itself the signal
  CallSubject subject;
  std::array<char, 200> exception{};
  pthread_t thread = pthread_self();
  sigset_t mask{};  ///< of signals, before the first call
  unsigned generation = 0;
  bool is_watched = false;
};

constinit thread_local ThreadGuard* current_guard = nullptr;
std::array<struct sigaction, NSIG> previous_actions;
std::atomic<unsigned> generation = 1;

const char* text_of(const ThreadGuard& guard) {
  switch (guard.signal) {
    case SIGSEGV:
    case SIGBUS:
      return "uses memory that does not exist or is not its own";
    case SIGFPE:
      return "divides by zero, or the result of a division is too large";
    case SIGILL:
      return "executes an instruction that this processor does not have";
    case SIGABRT:
      return guard.is_terminated ? "throws an exception out of a function that is noexcept" : "calls abort()";
    default:
      return guard.waits ? "does not return within 20 s: does it wait or sleep?"
                         : "does not return within a second of processor time: an endless loop?";
  }
}

[[noreturn]] void end_program_after(const ThreadGuard& guard, const char* what, const char* consequence) {
  LastLine line;
  line << "proleg: " << guard.subject.name << " " << what << ", in " << guard.subject.function << "()" << consequence;
  line.end_program();
}

constexpr const char* without_results = "; the program ends without its results";
constexpr const char* left_damaged =
    "; the C library is locked or damaged after that, so the program ends without its results";

/// The file of a library that is loaded; a fault elsewhere can be the work of its threads. Set once.
std::atomic<const char*> foreign_code = nullptr;
/// exit() has been called: what the library destroys at the end is not guarded.
std::atomic<bool> program_ends = false;

[[noreturn]] void end_program_after_crash(const char* file, int signal) {
  LastLine line;
  if (program_ends) {
    line << "proleg: " << file << ": crashes (SIG" << sigabbrev_np(signal) << ") at the end of the program: "
         << "the destructor of one of its objects?";
  } else {
    line << "proleg: the program has crashed (SIG" << sigabbrev_np(signal) << ") outside of a call of " << file
         << ": a thread that this library started can be the reason, or memory that it has overwritten";
  }
  line.end_program();
}

void on_signal(int signal, siginfo_t* info, void* /*context*/) {
  ThreadGuard* const guard = current_guard;
  if (guard != nullptr && guard->is_active) {
    if (signal == time_out_signal && guard->expired != guard->call) {
      return;  // that call has just returned
    }
    guard->signal = signal;
    guard->address.reset();
    if (is_bad_access(signal) && info->si_code > 0) {
      guard->address = info->si_addr;
    }
    guard->is_active = false;
    siglongjmp(guard->jump, 1);
  }
  if (signal == time_out_signal) {
    return;
  }
  if (guard != nullptr && guard->is_checked) {
    end_program_after(*guard, text_of(*guard), left_damaged);
  }
  const struct sigaction& previous = previous_actions[static_cast<std::size_t>(signal)];
  if (const char* const file = foreign_code; file != nullptr && previous.sa_handler == SIG_DFL) {
    end_program_after_crash(file, signal);
  }
  // It is not from a guarded call: what had been set before takes effect. A bad instruction is executed once more.
  sigaction(signal, &previous, nullptr);
  if (info->si_code <= 0) {
    raise(signal);
  }
}

void on_quick_exit() {
  if (const ThreadGuard* const guard = current_guard; guard != nullptr && guard->is_active) {
    end_program_after(*guard, "calls quick_exit()", without_results);
  }
  LastLine line;
  line << "proleg: " << foreign_code.load() << ": a thread that this library started calls quick_exit()"
       << without_results;
  line.end_program();
}

std::terminate_handler previous_terminate = nullptr;

/// The usual handler would print a second line about what is reported anyway.
[[noreturn]] void on_terminate() {
  ThreadGuard* const guard = current_guard;
  if (guard != nullptr && guard->is_active) {
    guard->is_terminated = true;
    std::abort();
  }
  if (previous_terminate != nullptr) {
    previous_terminate();
  }
  std::abort();
}

/// Sets the handlers of the caught signals, also again if a library has changed them.
void set_handlers() {
  struct sigaction action {};
  action.sa_sigaction = on_signal;
  // After a jump out of the handler the signal must not be blocked, and a full stack has no room for the handler.
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER | SA_RESTART;
  for (const int signal : caught_signals) {
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_sigaction != on_signal) {
      sigaction(signal, &action, nullptr);
    }
  }
}

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

  /// Waits until the C library is seen to be usable after a signal has ended a call of this thread. Ends the program if
  /// it is not.
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
                     instance().runs_ = false;
                     instance().watched_ = {};
                     ++generation;
                     instance().mutex_.unlock();
                   });
  }

  void start() {
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    for (const int signal : ending_signals) {
      sigdelset(&all, signal);  // it takes these if a library blocks them in all other threads
    }
    pthread_sigmask(SIG_SETMASK, &all, &before);
    try {
      std::thread([this] { run(); }).detach();
      runs_ = true;
    } catch (const std::system_error&) {
      // Without a thread an endless loop is not found; all else works.
    }
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  void run() {
    while (true) {
      std::this_thread::sleep_for(watchdog_period);
      end_program_that_stays();
      restore_ending_signals();
      set_handlers();
      const std::lock_guard lock(mutex_);
      for (Watched& watched : watched_) {
        if (watched.guard != nullptr) {
          look_at(watched);
        }
      }
    }
  }

  /// Results are written before exit() is called, so what then still runs is of the library.
  void end_program_that_stays() {
    const char* const file = foreign_code;
    if (program_ends && file != nullptr && ++looks_at_end_ > most_looks) {
      LastLine line;
      line << "proleg: " << file
           << ": does not end with the program: an endless loop in the destructor of one of its objects?";
      line.end_program();
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

void catch_signals() {
  static std::once_flag once;
  std::call_once(once, [] {
    previous_terminate = std::set_terminate(on_terminate);
    for (const int signal : caught_signals) {
      sigaction(signal, nullptr, &previous_actions[static_cast<std::size_t>(signal)]);
    }
    set_handlers();
  });
}

/// The guard of a thread, from its first guarded call to its end.
class GuardOwner {
 public:
  GuardOwner() {
    catch_signals();
    stack_t present{};
    sigaltstack(nullptr, &present);
    if ((present.ss_flags & SS_DISABLE) != 0) {
      void* const memory = mmap(nullptr, signal_stack_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      if (memory != MAP_FAILED) {
        stack_ = memory;
        stack_t stack{};
        stack.ss_sp = memory;
        stack.ss_size = signal_stack_size;
        sigaltstack(&stack, nullptr);
      }
    }
    current_guard = &guard_;
  }
  ~GuardOwner() {
    if (guard_.is_active) {
      end_program_after(guard_, "calls exit()", without_results);
    }
    current_guard = nullptr;
    Watchdog::instance().forget(guard_);
    if (stack_ != nullptr) {
      stack_t none{};
      none.ss_flags = SS_DISABLE;
      sigaltstack(&none, nullptr);
      munmap(stack_, signal_stack_size);
    }
  }
  GuardOwner(const GuardOwner&) = delete;
  GuardOwner& operator=(const GuardOwner&) = delete;

  ThreadGuard& guard() {
    if (guard_.generation != generation) {
      guard_.thread = pthread_self();
      pthread_sigmask(SIG_SETMASK, nullptr, &guard_.mask);
      Watchdog::instance().watch(guard_);
    }
    return guard_;
  }

 private:
  ThreadGuard guard_;
  void* stack_ = nullptr;
};

enum class End : std::uint8_t { returned, exception, signal };

/// Has no objects with destructors: a signal leaves it in the middle.
[[gnu::noinline]] End enter(ThreadGuard& guard, void (*function)(void*), void* context) {
  if (sigsetjmp(guard.jump, 0) != 0) {
    return End::signal;
  }
  ++guard.call;
  guard.is_terminated = false;
  guard.is_active = true;
  try {
    function(context);
    guard.is_active = false;
    return End::returned;
  } catch (const std::exception& error) {
    std::snprintf(guard.exception.data(), guard.exception.size(), "%s", error.what());
  } catch (...) {
    guard.exception[0] = '\0';
  }
  guard.is_active = false;
  return End::exception;
}

}  // namespace

void blame_for_crashes(const char* file) {
  const char* none = nullptr;
  if (!foreign_code.compare_exchange_strong(none, file)) {
    return;
  }
  // Called before the destructors of the library, which was loaded earlier.
  std::atexit([] {
    if (!program_ends && gettid() != getpid()) {  // programs of this tree end with the return from main()
      LastLine line;
      line << "proleg: " << foreign_code.load() << ": a thread that this library started calls exit()"
           << without_results;
      line.end_program();
    }
    program_ends = true;
  });
  std::at_quick_exit(on_quick_exit);
}

void expect_program_end() { program_ends = true; }

bool run_guarded(const CallSubject& subject, void (*function)(void*), void* context, CallFailure& failure) {
  thread_local GuardOwner owner;
  ThreadGuard& guard = owner.guard();
  guard.subject = subject;
  const FloatingPointModes modes;
  const End end = enter(guard, function, context);
  modes.restore();
  if (guard.is_look_due) {  // not after each call: it takes a microsecond
    guard.is_look_due = false;
    pthread_sigmask(SIG_SETMASK, &guard.mask, nullptr);
  }
  switch (end) {
    case End::returned:
      return true;
    case End::exception:
      failure = {guard.exception[0] == '\0' ? "throws an exception"
                                            : std::string("throws an exception: ") + guard.exception.data(),
                 nullptr};
      return false;
    case End::signal:
      break;
  }
  Watchdog::instance().check_after_signal(guard);
  failure = {text_of(guard), guard.address.value_or(nullptr)};
  if (guard.address) {
    std::array<char, 32> address{};
    std::snprintf(address.data(), address.size(), "%p", *guard.address);
    failure.text += std::string(", at the address ") + (*guard.address == nullptr ? "0" : address.data());
  } else if (is_bad_access(guard.signal)) {
    failure.text = std::string("sends itself the signal SIG") + sigabbrev_np(guard.signal);
  }
  return false;
}

}  // namespace proleg
