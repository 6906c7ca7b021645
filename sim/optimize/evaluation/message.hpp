#pragma once

// Tasks and results as bytes, for other processes of this program, on this computer or others of its kind. Numbers are
// written with their lowest byte first, doubles as their bit pattern, so that every value arrives unchanged.
// The sockets carry them between a process and the children that it forks.

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

using Bytes = std::vector<std::byte>;

[[nodiscard]] Bytes to_bytes(std::span<const Task> tasks);
[[nodiscard]] Bytes to_bytes(std::span<const TrialResult> results);

/// The tasks that the bytes encode; nothing if the bytes are not exactly tasks.
[[nodiscard]] std::optional<std::vector<Task>> tasks_from(std::span<const std::byte> bytes);
/// The results that the bytes encode; nothing if the bytes are not exactly results.
[[nodiscard]] std::optional<std::vector<TrialResult>> results_from(std::span<const std::byte> bytes);

/// Two sockets that are connected and keep messages separate (SOCK_SEQPACKET). Throws std::system_error.
[[nodiscard]] std::pair<int, int> make_message_sockets();

/// Waits for the next message; empty if the other end is closed. No message is empty.
[[nodiscard]] Bytes receive_message(int socket);
/// False if the other end is closed. Throws std::system_error for a message that is longer than the sockets take.
[[nodiscard]] bool send_message(int socket, const Bytes& message);

}  // namespace proleg::optimize
