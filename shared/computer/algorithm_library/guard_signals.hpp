#pragma once

// The handlers of the signals that end a guarded call (guarded_call.hpp).

namespace proleg {

[[nodiscard]] bool is_bad_access(int signal);

/// Sets the handlers and remembers what there was before; once in a program.
void catch_guard_signals();

/// Sets the handlers again, if a library has changed them.
void set_guard_handlers();

}  // namespace proleg
