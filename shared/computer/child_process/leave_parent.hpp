#pragma once

#include <sys/types.h>

#include <span>

namespace proleg {

/// Separates a forked child from its parent: it shares no signals, files, database connections or terminal. The child
/// ends with its parent, and ignores the signals that ask a program to end (SIGINT, SIGTERM, SIGHUP): a terminal and a
/// batch system send them to both, and the parent decides. Standard error stays.
///
/// kept: files that stay open. parent: process id of the parent, from before the fork.
void leave_parent(std::span<const int> kept, pid_t parent);

}  // namespace proleg
