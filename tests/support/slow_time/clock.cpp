// Slow time for programs as they are: a library that is loaded before the C library (LD_PRELOAD). One second of the
// monotonic clock takes PROLEG_SLOW_TIME seconds of the computer, and so does each wait of one second. A program that a
// person or a browser drives then waits that much longer for them than it does for a user, and needs as much less of a
// busy computer. The calendar is as it is.
//
// For programs that wait by poll, select, epoll, sleep, timer descriptors, or condition variables and semaphores with a
// steady clock.

#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}
#define PROLEG_REAL(function) (real<decltype(&(function))>(#function))

/// How many seconds of the computer a second of the program takes.
std::int64_t slowness() {
  static const std::int64_t value = [] {
    const char* text = std::getenv("PROLEG_SLOW_TIME");
    const std::int64_t number = text == nullptr ? 1 : std::strtoll(text, nullptr, 10);
    return number < 1 ? 1 : number;
  }();
  return value;
}

bool is_slow(clockid_t clock) {
  return clock == CLOCK_MONOTONIC || clock == CLOCK_MONOTONIC_RAW || clock == CLOCK_BOOTTIME ||
         clock == CLOCK_MONOTONIC_COARSE;
}

std::int64_t nanoseconds(const timespec& time) { return time.tv_sec * second_ns + time.tv_nsec; }
timespec time_of(std::int64_t ns) { return {ns / second_ns, ns % second_ns}; }
/// Of the program, as the computer has it: both clocks are 0 at the same moment.
timespec longer(const timespec& time) { return time_of(nanoseconds(time) * slowness()); }
timespec shorter(const timespec& time) { return time_of(nanoseconds(time) / slowness()); }

/// A wait that has to be given in whole milliseconds.
int longer(int ms) {
  const std::int64_t time = ms * slowness();
  return ms < 0 ? ms : static_cast<int>(time > INT_MAX ? INT_MAX : time);
}

}  // namespace

// NOLINTBEGIN: the names and parameters are those of the C library
extern "C" {

int clock_gettime(clockid_t clock, timespec* time) {
  const int result = static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  if (result == 0 && is_slow(clock)) {
    *time = shorter(*time);
  }
  return result;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  const auto sleep = PROLEG_REAL(clock_nanosleep);
  if (!is_slow(clock)) {
    return sleep(clock, flags, time, left);
  }
  const timespec limit = longer(*time);
  const int error = sleep(clock, flags, &limit, left);
  if (error == EINTR && left != nullptr && (flags & TIMER_ABSTIME) == 0) {
    *left = shorter(*left);
  }
  return error;
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

int ppoll(pollfd* files, nfds_t count, const timespec* time, const sigset_t* mask) {
  const timespec limit = time == nullptr ? timespec{} : longer(*time);
  return PROLEG_REAL(ppoll)(files, count, time == nullptr ? nullptr : &limit, mask);
}

int poll(pollfd* files, nfds_t count, int ms) { return PROLEG_REAL(poll)(files, count, longer(ms)); }

int __poll_chk(pollfd* files, nfds_t count, int ms, std::size_t) { return poll(files, count, ms); }
int __ppoll_chk(pollfd* files, nfds_t count, const timespec* time, const sigset_t* mask, std::size_t) {
  return ppoll(files, count, time, mask);
}

int pselect(int count, fd_set* reads, fd_set* writes, fd_set* others, const timespec* time, const sigset_t* mask) {
  const timespec limit = time == nullptr ? timespec{} : longer(*time);
  return PROLEG_REAL(pselect)(count, reads, writes, others, time == nullptr ? nullptr : &limit, mask);
}

int select(int count, fd_set* reads, fd_set* writes, fd_set* others, timeval* time) {
  const timespec limit = time == nullptr ? timespec{} : timespec{time->tv_sec, time->tv_usec * 1'000};
  return pselect(count, reads, writes, others, time == nullptr ? nullptr : &limit, nullptr);
}

int epoll_pwait(int epoll, epoll_event* events, int count, int ms, const sigset_t* mask) {
  return PROLEG_REAL(epoll_pwait)(epoll, events, count, longer(ms), mask);
}

int epoll_wait(int epoll, epoll_event* events, int count, int ms) {
  return epoll_pwait(epoll, events, count, ms, nullptr);
}

// Boost.Asio has its timers on the monotonic clock, from now on or as times of it: both become longer alike.
int timerfd_settime(int descriptor, int flags, const itimerspec* time, itimerspec* old) {
  const itimerspec limit{longer(time->it_interval), longer(time->it_value)};
  const int result = PROLEG_REAL(timerfd_settime)(descriptor, flags, &limit, old);
  if (result == 0 && old != nullptr) {
    *old = {shorter(old->it_interval), shorter(old->it_value)};
  }
  return result;
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  const timespec limit = is_slow(clock) ? longer(*until) : *until;
  return PROLEG_REAL(pthread_cond_clockwait)(condition, mutex, clock, &limit);
}

// The locks of Python.
int sem_clockwait(sem_t* semaphore, clockid_t clock, const timespec* until) {
  const timespec limit = is_slow(clock) ? longer(*until) : *until;
  return PROLEG_REAL(sem_clockwait)(semaphore, clock, &limit);
}

}  // extern "C"
// NOLINTEND
