#pragma once

namespace proleg::tools {

/// After this call SIGINT, SIGTERM and SIGHUP only make interrupted() true. Ignored signals remain ignored (nohup).
void catch_interrupts();
[[nodiscard]] bool interrupted();

}  // namespace proleg::tools
