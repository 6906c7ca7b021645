#pragma once

#include <cstdint>

namespace proleg::sim {

/// A pulse that a servo takes at the start of one of its intervals.
struct ServoPulse {
  std::uint64_t time_us;  ///< since SYNC 0
  std::uint32_t joint;    ///< kernel order
  std::int32_t command;   ///< twelfths of a microsecond
};

}  // namespace proleg::sim
