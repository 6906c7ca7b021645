#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace proleg::sim {

/// Prepares the Open Dynamics Engine for the calling thread. An error of the engine throws PhysicsError and does not
/// end the process; its messages are counted, not printed.
void prepare_engine_for_this_thread();

/// Number of messages of the engine on this thread so far.
[[nodiscard]] std::size_t engine_messages();
/// The first messages that differ, at most ten.
[[nodiscard]] std::span<const std::string> engine_message_texts();

}  // namespace proleg::sim
