#pragma once

#include <cstdint>
#include <vector>

#include "shared/kernel/kernel_configuration.hpp"

namespace proleg {

/// Settings that take effect together at a tick, while the robot moves; at most max_staged_values of one joint.
struct Change {
  /// Value of `tick`: the master chooses the tick when all modules have the values. So a slow connection delays the
  /// change.
  static constexpr std::uint32_t soon = 0xFFFF'FFFF;

  std::uint32_t tick = 0;
  std::vector<Setting> settings = {};
  bool dropped = false;  ///< set by the master: the change was not made (see Problem)
};

}  // namespace proleg
