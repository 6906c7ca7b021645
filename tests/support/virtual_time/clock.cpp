// Virtual time for programs as they are: a library that is loaded before the C library (LD_PRELOAD). It replaces the
// clocks and all waits that have an end. A wait is written into the memory of the SharedClock; keeper.cpp lets time
// pass when no thread of the test runs, and wakes those whose time has come. A computer that is slow or busy makes such
// a test longer, but not different.

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "tests/support/virtual_time/shared_clock.hpp"

namespace {

using proleg::virtual_time::never;
using proleg::virtual_time::SharedClock;
using proleg::virtual_time::Wait;

constexpr std::int64_t second_ns = 1'000'000'000;
/// Virtual time is in whole microseconds.
constexpr std::int64_t tick_ns = 1'000;
/// A program that looks for events so many times at one time, without success, waits for the next microsecond:
/// Boost.Asio does so for the rest of a microsecond, which would not pass.
constexpr int most_looks = 10;
constexpr std::int64_t look_again_ns = 1'000'000;  // of the computer's time

SharedClock* shared = nullptr;
std::atomic<std::uint32_t> notifications{0};  // number of those of all condition variables of this process

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}
#define PROLEG_REAL(function) (real<decltype(&(function))>(#function))

std::int64_t nanoseconds(const timespec& time) { return time.tv_sec * second_ns + time.tv_nsec; }
timespec time_of(std::int64_t ns) { return {ns / second_ns, ns % second_ns}; }

bool is_virtual(clockid_t clock) {
  return shared != nullptr &&
         (clock == CLOCK_MONOTONIC || clock == CLOCK_MONOTONIC_RAW || clock == CLOCK_BOOTTIME ||
          clock == CLOCK_MONOTONIC_COARSE || clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE);
}
bool is_calendar(clockid_t clock) { return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE; }

std::int64_t now() { return shared->now_ns.load(); }
std::int64_t now(clockid_t clock) { return now() + (is_calendar(clock) ? shared->calendar_offset_ns : 0); }
/// End on the virtual monotonic clock of a wait until a time of another clock.
std::int64_t end_of(clockid_t clock, const timespec& until) {
  return nanoseconds(until) - (is_calendar(clock) ? shared->calendar_offset_ns : 0);
}
std::int64_t end_after(std::int64_t ns) { return ns > never - now() ? never : now() + std::max<std::int64_t>(ns, 0); }

/// Takes a free entry; without one the program ends, since its time would stand still.
Wait& take_entry(int descriptor) {
  for (Wait& wait : shared->wait) {
    int is_free = 0;
    if (wait.thread.compare_exchange_strong(is_free, -1)) {
      wait.process = getpid();
      wait.descriptor = descriptor;
      wait.looks_again = false;
      wait.end_ns = never;
      wait.thread = gettid();
      return wait;
    }
  }
  std::fputs("virtual time: more waits at once than the shared memory has entries for\n", stderr);
  std::abort();
}

void begin(Wait& wait, std::int64_t end_ns) {
  ++wait.number;
  wait.end_ns = end_ns > never - tick_ns ? never : (end_ns + tick_ns - 1) / tick_ns * tick_ns;
  ++shared->waits;
  syscall(SYS_futex, &shared->waits, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

/// A wait of this thread, for the length of a call.
class ThreadWait {
 public:
  explicit ThreadWait(std::int64_t end_ns, bool looks_again = false) : wait_(take_entry(-1)), end_ns_(end_ns) {
    wait_.looks_again = looks_again;
    begin(wait_, end_ns);
  }
  ~ThreadWait() {
    wait_.end_ns = never;
    wait_.thread = 0;
  }
  ThreadWait(const ThreadWait&) = delete;
  ThreadWait& operator=(const ThreadWait&) = delete;

  [[nodiscard]] bool is_over() const { return now() >= end_ns_; }

 private:
  Wait& wait_;
  std::int64_t end_ns_;
};

/// The keeper's signal has ended a system call of this thread.
thread_local volatile bool is_woken = false;

/// Calls a function of the system that returns -1 and EINTR when a signal ends it, without an end of its own. Returns 0
/// at the end of the virtual wait.
template <typename Call>
int until(std::int64_t end_ns, Call call) {
  const ThreadWait wait(end_ns);
  while (true) {
    is_woken = false;
    const int result = call();
    if (result >= 0 || errno != EINTR || !is_woken) {
      return result;
    }
    if (wait.is_over()) {
      return 0;
    }
  }
}

/// Enters a descriptor from which this process reads, if it is that of a terminal.
void note_reader(int descriptor) {
  const int error = errno;
  if (isatty(descriptor) == 1) {
    for (proleg::virtual_time::Terminal& terminal : shared->terminal) {
      int process = 0;
      if (terminal.process.compare_exchange_strong(process, getpid())) {
        terminal.descriptor = descriptor;
        break;
      }
      if (process == getpid() && terminal.descriptor.load() == descriptor) {
        break;
      }
    }
  }
  errno = error;
}

void note_write(int descriptor) {
  const int error = errno;
  if (isatty(descriptor) == 1) {
    ++shared->terminal_writes;
  }
  errno = error;
}

/// Polls the terminals of this process if the keeper wants it.
void poll_terminals() {
  static std::atomic<std::uint32_t> made{0};
  const std::uint32_t wanted = shared->polls_wanted.load();
  if (made.exchange(wanted) == wanted) {
    return;
  }
  for (const proleg::virtual_time::Terminal& terminal : shared->terminal) {
    if (terminal.process.load() == getpid()) {
      pollfd file{terminal.descriptor.load(), POLLIN, 0};
      const timespec at_once{};
      syscall(SYS_ppoll, &file, 1, &at_once, nullptr, 0);
    }
  }
  ++shared->polls_made;
  syscall(SYS_futex, &shared->polls_made, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

/// Calls a function of the system that looks for events and does not wait.
template <typename Look, typename Call>
int look(Look at_once, Call call) {
  thread_local std::int64_t time_ns = 0;
  thread_local int looks = 0;
  looks = time_ns == now() ? looks + 1 : 0;
  time_ns = now();
  return looks < most_looks ? at_once() : until(time_ns + tick_ns, call);
}

/// Entry of a timer descriptor, or nullptr.
Wait* timer_of(int descriptor) {
  const auto found = std::find_if(shared->wait.begin(), shared->wait.end(), [descriptor](const Wait& wait) {
    return wait.thread.load() > 0 && wait.descriptor.load() == descriptor && wait.process.load() == getpid();
  });
  return found == shared->wait.end() ? nullptr : found;
}

void fire(int descriptor) {
  const std::uint64_t one = 1;
  if (syscall(SYS_write, descriptor, &one, sizeof one) < 0) {
    return;  // it is closed, or has fired already
  }
}

/// The keeper wakes this thread: the system call that waits ends with EINTR. Timers that are due fire.
void on_wake(int) {
  const int error = errno;
  is_woken = true;
  poll_terminals();
  for (Wait& wait : shared->wait) {
    if (wait.thread.load() > 0 && wait.descriptor.load() >= 0 && wait.process.load() == getpid() &&
        wait.end_ns.load() <= now()) {
      wait.end_ns = never;
      fire(wait.descriptor.load());
    }
  }
  errno = error;
}

[[gnu::constructor]] void join_virtual_time() {
  const char* name = std::getenv(proleg::virtual_time::file_variable);
  const int file = name == nullptr ? -1 : open(name, O_RDWR | O_CLOEXEC);
  if (file < 0) {
    return;
  }
  void* memory = mmap(nullptr, sizeof(SharedClock), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  if (memory == MAP_FAILED) {
    return;
  }
  struct sigaction action {};
  action.sa_handler = on_wake;
  action.sa_flags = SA_RESTART;  // reads, writes and waits without an end go on
  sigaction(proleg::virtual_time::wake_signal, &action, nullptr);
  shared = static_cast<SharedClock*>(memory);
  // Of the program that this process ran before.
  for (Wait& wait : shared->wait) {
    if (wait.process.load() == getpid()) {
      wait.thread = 0;
    }
  }
  for (proleg::virtual_time::Terminal& terminal : shared->terminal) {
    int process = getpid();
    terminal.process.compare_exchange_strong(process, 0);
  }
}

}  // namespace

// NOLINTBEGIN: the names and parameters are those of the C library
extern "C" {

int clock_gettime(clockid_t clock, timespec* time) {
  if (!is_virtual(clock)) {
    return static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  }
  *time = time_of(now(clock));
  return 0;
}

int gettimeofday(timeval* time, void*) {
  timespec precise{};
  clock_gettime(CLOCK_REALTIME, &precise);
  *time = {precise.tv_sec, precise.tv_nsec / 1'000};
  return 0;
}

time_t time(time_t* copy) {
  timespec precise{};
  clock_gettime(CLOCK_REALTIME, &precise);
  if (copy != nullptr) {
    *copy = precise.tv_sec;
  }
  return precise.tv_sec;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  if (!is_virtual(clock)) {
    return PROLEG_REAL(clock_nanosleep)(clock, flags, time, left);
  }
  const std::int64_t end_ns = (flags & TIMER_ABSTIME) != 0 ? end_of(clock, *time) : end_after(nanoseconds(*time));
  if (end_ns <= now()) {
    return 0;
  }
  if (until(end_ns, [] { return PROLEG_REAL(ppoll)(nullptr, 0, nullptr, nullptr); }) == 0) {
    return 0;
  }
  if (left != nullptr && (flags & TIMER_ABSTIME) == 0) {
    *left = time_of(std::max<std::int64_t>(end_ns - now(), 0));
  }
  return EINTR;
}

int nanosleep(const timespec* time, timespec* left) {
  const int error = clock_nanosleep(CLOCK_MONOTONIC, 0, time, left);
  if (error != 0) {
    errno = error;
    return -1;
  }
  return 0;
}

int usleep(useconds_t us) {
  const timespec time = time_of(std::int64_t{us} * 1'000);
  return nanosleep(&time, nullptr);
}

unsigned sleep(unsigned seconds) {
  const timespec time{static_cast<time_t>(seconds), 0};
  timespec left{};
  return nanosleep(&time, &left) == 0 ? 0 : static_cast<unsigned>(left.tv_sec + 1);
}

int ppoll(pollfd* files, nfds_t count, const timespec* time, const sigset_t* mask) {
  const auto call = [=](const timespec* limit) { return PROLEG_REAL(ppoll)(files, count, limit, mask); };
  if (shared == nullptr) {
    return call(time);
  }
  std::for_each(files, files + count, [](const pollfd& file) { note_reader(file.fd); });
  if (time != nullptr && nanoseconds(*time) <= 0) {
    return look([&] { return call(time); }, [&] { return call(nullptr); });
  }
  return until(time == nullptr ? never : end_after(nanoseconds(*time)), [&] { return call(nullptr); });
}

int poll(pollfd* files, nfds_t count, int ms) {
  const timespec time = time_of(std::int64_t{ms} * 1'000'000);
  return ppoll(files, count, ms < 0 ? nullptr : &time, nullptr);
}

int __poll_chk(pollfd* files, nfds_t count, int ms, std::size_t) { return poll(files, count, ms); }
int __ppoll_chk(pollfd* files, nfds_t count, const timespec* time, const sigset_t* mask, std::size_t) {
  return ppoll(files, count, time, mask);
}

int pselect(int count, fd_set* reads, fd_set* writes, fd_set* others, const timespec* time, const sigset_t* mask) {
  const auto call = [=](const timespec* limit) {
    return PROLEG_REAL(pselect)(count, reads, writes, others, limit, mask);
  };
  if (shared == nullptr) {
    return call(time);
  }
  for (int descriptor = 0; reads != nullptr && descriptor < count; ++descriptor) {
    if (FD_ISSET(descriptor, reads)) {
      note_reader(descriptor);
    }
  }
  const auto call_without_end = [&] { return call(nullptr); };
  const int result = time != nullptr && nanoseconds(*time) <= 0
                         ? look([&] { return call(time); }, call_without_end)
                         : until(time == nullptr ? never : end_after(nanoseconds(*time)), call_without_end);
  if (result == 0) {  // the interrupted call has left the sets as they were
    for (fd_set* set : {reads, writes, others}) {
      if (set != nullptr) {
        FD_ZERO(set);
      }
    }
  }
  return result;
}

int select(int count, fd_set* reads, fd_set* writes, fd_set* others, timeval* time) {
  const timespec limit = time == nullptr ? timespec{} : timespec{time->tv_sec, time->tv_usec * 1'000};
  return pselect(count, reads, writes, others, time == nullptr ? nullptr : &limit, nullptr);
}

int epoll_pwait(int epoll, epoll_event* events, int count, int ms, const sigset_t* mask) {
  const auto call = [=](int limit) { return PROLEG_REAL(epoll_pwait)(epoll, events, count, limit, mask); };
  if (shared == nullptr) {
    return call(ms);
  }
  if (ms == 0) {
    return look([&] { return call(0); }, [&] { return call(-1); });
  }
  return until(ms < 0 ? never : end_after(std::int64_t{ms} * 1'000'000), [&] { return call(-1); });
}

int epoll_wait(int epoll, epoll_event* events, int count, int ms) {
  return epoll_pwait(epoll, events, count, ms, nullptr);
}

int epoll_ctl(int epoll, int operation, int descriptor, epoll_event* event) {
  if (shared != nullptr && operation == EPOLL_CTL_ADD) {
    note_reader(descriptor);
  }
  return PROLEG_REAL(epoll_ctl)(epoll, operation, descriptor, event);
}

ssize_t read(int descriptor, void* bytes, std::size_t count) {
  if (shared != nullptr) {
    note_reader(descriptor);
  }
  return PROLEG_REAL(read)(descriptor, bytes, count);
}

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  const ssize_t written = PROLEG_REAL(write)(descriptor, bytes, count);
  if (shared != nullptr) {
    note_write(descriptor);
  }
  return written;
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  const ssize_t written = PROLEG_REAL(writev)(descriptor, parts, count);
  if (shared != nullptr) {
    note_write(descriptor);
  }
  return written;
}

// A timer descriptor is an event descriptor to which this library writes.
int timerfd_create(int clock, int flags) {
  if (!is_virtual(clock)) {
    return PROLEG_REAL(timerfd_create)(clock, flags);
  }
  const int descriptor = eventfd(0, EFD_NONBLOCK | ((flags & TFD_CLOEXEC) != 0 ? EFD_CLOEXEC : 0));
  if (descriptor >= 0) {
    if (Wait* old = timer_of(descriptor)) {  // of a timer that is closed
      old->thread = 0;
    }
    take_entry(descriptor);
  }
  return descriptor;
}

int timerfd_settime(int descriptor, int flags, const itimerspec* time, itimerspec* old) {
  Wait* timer = shared == nullptr ? nullptr : timer_of(descriptor);
  if (timer == nullptr) {
    return PROLEG_REAL(timerfd_settime)(descriptor, flags, time, old);
  }
  timer->end_ns = never;
  std::uint64_t count = 0;
  syscall(SYS_read, descriptor, &count, sizeof count);  // it has not fired yet
  const std::int64_t value = nanoseconds(time->it_value);
  if (value == 0) {
    return 0;
  }
  timer->thread = gettid();
  const std::int64_t end_ns = (flags & TFD_TIMER_ABSTIME) != 0 ? value : end_after(value);
  if (end_ns <= now()) {
    fire(descriptor);
  } else {
    begin(*timer, end_ns);
  }
  return 0;
}

// The keeper wakes threads that take no other signals, too.
int pthread_sigmask(int how, const sigset_t* signals, sigset_t* old) {
  sigset_t others{};
  if (shared != nullptr && signals != nullptr && how != SIG_UNBLOCK) {
    others = *signals;
    sigdelset(&others, proleg::virtual_time::wake_signal);
    signals = &others;
  }
  return PROLEG_REAL(pthread_sigmask)(how, signals, old);
}

int sigprocmask(int how, const sigset_t* signals, sigset_t* old) {
  const int error = pthread_sigmask(how, signals, old);
  if (error != 0) {
    errno = error;
    return -1;
  }
  return 0;
}

int pthread_cond_signal(pthread_cond_t* condition) {
  ++notifications;
  return PROLEG_REAL(pthread_cond_signal)(condition);
}

int pthread_cond_broadcast(pthread_cond_t* condition) {
  ++notifications;
  return PROLEG_REAL(pthread_cond_broadcast)(condition);
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  const auto call = PROLEG_REAL(pthread_cond_clockwait);
  if (!is_virtual(clock)) {
    return call(condition, mutex, clock, until);
  }
  const std::uint32_t before = notifications.load();
  const ThreadWait wait(end_of(clock, *until), true);
  while (!wait.is_over()) {
    timespec soon{};
    syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &soon);
    soon = time_of(nanoseconds(soon) + look_again_ns);
    if (const int result = call(condition, mutex, CLOCK_MONOTONIC, &soon); result != ETIMEDOUT) {
      return result;
    }
    if (notifications.load() != before) {
      return 0;  // the caller looks at its condition: a thread with the mutex may have notified after this wait ended
    }
  }
  return ETIMEDOUT;
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* until) {
  // Bit 1 of the flags of a condition variable of glibc 2.36: its clock is CLOCK_MONOTONIC.
  const clockid_t clock = (condition->__data.__wrefs & 2U) != 0 ? CLOCK_MONOTONIC : CLOCK_REALTIME;
  return pthread_cond_clockwait(condition, mutex, clock, until);
}

int sem_clockwait(sem_t* semaphore, clockid_t clock, const timespec* until) {
  const auto call = PROLEG_REAL(sem_clockwait);
  if (!is_virtual(clock)) {
    return call(semaphore, clock, until);
  }
  const ThreadWait wait(end_of(clock, *until), true);
  while (!wait.is_over()) {
    timespec soon{};
    syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &soon);
    soon = time_of(nanoseconds(soon) + look_again_ns);
    if (call(semaphore, CLOCK_MONOTONIC, &soon) == 0) {
      return 0;
    }
    if (errno != ETIMEDOUT) {
      return -1;
    }
  }
  errno = ETIMEDOUT;
  return -1;
}

int sem_timedwait(sem_t* semaphore, const timespec* until) { return sem_clockwait(semaphore, CLOCK_REALTIME, until); }

}  // extern "C"
// NOLINTEND
