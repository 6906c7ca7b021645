#pragma once

// The thread that ends guarded calls (guarded_call.hpp) which take too long.

#include "shared/computer/algorithm_library/thread_guard.hpp"

namespace proleg {

/// Watches the calls of this thread, whose guard it is, until forget_calls(). At most 64 threads are watched.
void watch_calls(ThreadGuard& guard);
/// Whether watch_calls() was called in this process: a child that fork() made has to call it again.
[[nodiscard]] bool watches_calls(const ThreadGuard& guard);
void forget_calls(const ThreadGuard& guard);

/// Waits until the C library is seen to be usable after a signal has ended a call of this thread. Ends the program if
/// it is not.
void check_after_signal(ThreadGuard& guard);

}  // namespace proleg
