#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "sim/loop/difference.hpp"
#include "sim/loop/motion_check.hpp"
#include "sim/record/recording.hpp"

namespace proleg::sim {

struct Verification {
  std::uint32_t ticks = 0;
  std::uint64_t setpoints = 0;        ///< compared
  std::uint64_t servo_commands = 0;   ///< compared
  std::uint64_t internal_values = 0;  ///< compared
  std::uint64_t differences = 0;
  /// The end of the comparison in a run with faults: only the ticks before this one were compared.
  std::optional<std::uint32_t> first_fault_tick;
  std::optional<Difference> first;
  std::string setpoint_hash;  ///< of the recomputed set-points
  std::string servo_hash;     ///< of the recomputed servo commands
};

/// Recomputes every set-point, internal value and servo command of a recording with this program's core, from the
/// recorded start values, changes, contacts, losses and restarts. Throws InputError for a recording that does not start
/// at tick 0, or has an algorithm that this program does not have. progress: called with every tick. motion: of the
/// same recording; checks the same ticks. Null: no world is simulated.
[[nodiscard]] Verification verify(const Recording& recording,
                                  const std::function<void(std::uint32_t tick)>& progress = {},
                                  MotionCheck* motion = nullptr);

}  // namespace proleg::sim
