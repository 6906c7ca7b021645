#pragma once

// Messages between a process and the children that it forks.

#include <sys/types.h>

#include <span>
#include <utility>

#include "sim/optimize/evaluation/message.hpp"

namespace proleg::optimize {

/// Two sockets that are connected and keep messages separate (SOCK_SEQPACKET). Throws std::system_error.
[[nodiscard]] std::pair<int, int> make_message_sockets();

/// Waits for the next message; empty if the other end is closed. No message is empty.
[[nodiscard]] Bytes receive_message(int socket);
/// False if the other end is closed.
bool send_message(int socket, const Bytes& message);

/// In a child that was forked: separates it from its parent, with whom it shares no signals, files, database
/// connections or terminal. It ends with the parent. sockets: those that stay open.
void leave_parent(std::span<const int> sockets, pid_t parent);

}  // namespace proleg::optimize
