#pragma once

#include <cstddef>

namespace proleg::sim {

/// Makes the Open Dynamics Engine usable on the calling thread. The engine's errors become PhysicsError instead of
/// ending the process; its messages are counted, not printed.
void prepare_engine_for_this_thread();

/// Messages of the engine on this thread so far.
[[nodiscard]] std::size_t engine_messages();

}  // namespace proleg::sim
