#pragma once

// Messages between a process and the children that it forks.

#include <utility>

#include "sim/optimize/evaluation/message.hpp"

namespace proleg::optimize {

/// Two sockets that are connected and keep messages separate (SOCK_SEQPACKET). Throws std::system_error.
[[nodiscard]] std::pair<int, int> make_message_sockets();

/// Waits for the next message; empty if the other end is closed. No message is empty.
[[nodiscard]] Bytes receive_message(int socket);
/// False if the other end is closed. Throws std::system_error for a message that is longer than the sockets take.
[[nodiscard]] bool send_message(int socket, const Bytes& message);

}  // namespace proleg::optimize
