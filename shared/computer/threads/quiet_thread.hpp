#pragma once

// Threads that take no signals, so that these stay with the threads of the program that know what to do.

#include <functional>
#include <span>
#include <thread>

namespace proleg {

/// Starts a thread that takes no signals but those in `taken`, and those of its own mistakes (a bad access, for
/// example), which no thread can block. Throws std::system_error if there are no more threads; the caller's signals
/// are as before in any case.
[[nodiscard]] std::thread start_quiet_thread(std::function<void()> work, std::span<const int> taken = {});

}  // namespace proleg
