#pragma once

// Tasks and results as bytes, for other processes of this program, on this computer or others of its kind. Numbers are
// written with their lowest byte first, doubles as their bit pattern, so that every value arrives unchanged.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"

namespace proleg::optimize {

using Bytes = std::vector<std::byte>;

[[nodiscard]] Bytes to_bytes(std::span<const Task> tasks);
[[nodiscard]] Bytes to_bytes(std::span<const TrialResult> results);

/// Nothing if the bytes are not exactly tasks.
[[nodiscard]] std::optional<std::vector<Task>> tasks_from(std::span<const std::byte> bytes);
/// Nothing if the bytes are not exactly results.
[[nodiscard]] std::optional<std::vector<TrialResult>> results_from(std::span<const std::byte> bytes);

}  // namespace proleg::optimize
