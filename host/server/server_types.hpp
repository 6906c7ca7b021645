#pragma once

#include <chrono>
#include <cstdint>

namespace proleg::host {

/// Number of a viewer, from 1; a server uses no number twice.
using ClientId = std::uint32_t;

/// Time since any fixed moment, on a steady clock. The state machines of the server receive it as an argument.
using ServerTime = std::chrono::milliseconds;
inline constexpr ServerTime no_deadline = ServerTime::max();

}  // namespace proleg::host
