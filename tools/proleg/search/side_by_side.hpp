#pragma once

// Work that is divided among processes of this computer, with one progress line for all of them.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

namespace proleg::tools {

/// Takes the next number to work on; nothing if none is left.
using NextNumber = std::function<std::optional<std::uint32_t>()>;

/// Forks processes that call work(process, next) at the same time: process counts from 0, and each number is given to
/// one of them. started() is called in this process when all are forked. Returns when all have ended. Their standard
/// output is printed on standard error, line by line; their standard error is progress, of which the latest lines are
/// shown. An exception ends its process with one line. If the user interrupts, the processes
/// are interrupted, too. They end with this process in any case. This process must have one thread. If the system can
/// start only some of the processes, these do the work. Throws std::system_error if it can start none.
void work_side_by_side(std::uint32_t processes, std::span<const std::uint32_t> numbers,
                       const std::function<void(std::uint32_t process, const NextNumber& next)>& work,
                       const std::function<void()>& started);

}  // namespace proleg::tools
