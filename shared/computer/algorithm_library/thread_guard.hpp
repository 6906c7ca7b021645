#pragma once

// What a thread needs to leave a guarded call (guarded_call.hpp) when a signal interrupts it.

#include <pthread.h>

#include <array>
#include <atomic>
#include <csetjmp>
#include <csignal>
#include <cstdint>
#include <optional>

namespace proleg {

/// The signal that the watchdog sends to a thread. No program of the tree uses it for anything else.
inline constexpr int time_out_signal = SIGVTALRM;

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
  const char* subject = "";            ///< what is called; "steep.so: the algorithm 'steep'"
  const char* function = "";           ///< without brackets
  std::array<char, 200> exception{};
  pthread_t thread = pthread_self();
  sigset_t mask{};  ///< of signals, before the first call
  unsigned generation = 0;
  bool is_watched = false;
};

/// The guard of this thread; null before its first guarded call and after its last one.
extern constinit thread_local ThreadGuard* current_guard;

/// How the signal of the guard ended its call, as predicate of a sentence.
[[nodiscard]] const char* text_of(const ThreadGuard& guard);

/// For end_program_after().
inline constexpr const char* without_results = "; the program ends without its results";
inline constexpr const char* left_damaged =
    "; the C library is locked or damaged after that, so the program ends without its results";

/// Prints one line: the subject of the guard's call, what it does, in which function, and the consequence.
[[noreturn]] void end_program_after(const ThreadGuard& guard, const char* what, const char* consequence);

}  // namespace proleg
