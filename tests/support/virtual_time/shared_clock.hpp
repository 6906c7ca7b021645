// The memory that the programs of a test share with the keeper of their virtual time (keeper.cpp, clock.cpp).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>

namespace proleg::virtual_time {

/// Environment variable with the name of the file that holds the SharedClock.
constexpr const char* file_variable = "PROLEG_VIRTUAL_TIME";

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

/// One wait with an end: of a thread that sleeps or polls, or of a timer descriptor.
struct Wait {
  std::atomic<int> thread{0};  ///< thread id of Linux that a signal wakes; 0: this entry is free
  std::atomic<int> process{0};
  std::atomic<int> descriptor{-1};          ///< of a timer; -1: the thread itself waits
  std::atomic<std::int64_t> end_ns{never};  ///< virtual time
  /// The thread looks at the time again and again while it waits (a condition variable cannot be woken from outside).
  std::atomic<bool> looks_again{false};
  /// Counts the waits of this entry: a wait that began anew is another wait.
  std::atomic<std::uint32_t> number{0};
};

/// A terminal from which a process reads. Linux hands on what is written to a pseudo terminal later, in a thread of its
/// own; a poll of the reader makes it do so at once.
struct Terminal {
  std::atomic<int> process{0};  ///< 0: this entry is free
  std::atomic<int> descriptor{-1};
};

struct SharedClock {
  std::atomic<std::int64_t> now_ns{0};  ///< virtual CLOCK_MONOTONIC
  std::int64_t calendar_offset_ns{0};   ///< virtual CLOCK_REALTIME is now_ns plus this
  std::atomic<std::uint32_t> waits{0};  ///< number of waits that began: a futex on which the keeper waits
  std::array<Wait, 512> wait{};

  std::atomic<std::uint32_t> terminal_writes{0};  ///< number of writes to terminals
  std::atomic<std::uint32_t> polls_wanted{
      0};                                    ///< number of times that the keeper had all processes poll their terminals
  std::atomic<std::uint32_t> polls_made{0};  ///< number of processes that did, all times together
  std::array<Terminal, 128> terminal{};
};

/// Signal that ends a wait: one that neither the programs nor the C library use.
inline constexpr int wake_signal = 63;

}  // namespace proleg::virtual_time
