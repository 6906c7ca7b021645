#pragma once

#include "shared/gait/sensing_module.hpp"

namespace proleg::identity {

/// An algorithm for tests only: its output depends on the contacts of all links up to now, so that a single
/// contact of a wrong age shows in every later set-point.
[[nodiscard]] const SensingModule& sensing_probe();

/// The same for the readings of the joint's module.
[[nodiscard]] const ActuationModule& reading_probe();

}  // namespace proleg::identity
