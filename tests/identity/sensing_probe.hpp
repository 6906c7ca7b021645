#pragma once

#include "shared/gait/sensing_module.hpp"

namespace proleg::identity {

/// An algorithm for tests only: its output depends on the contacts of all links up to now, so that a single
/// contact of a wrong age shows in every later set-point.
[[nodiscard]] const SensingModule& sensing_probe();

}  // namespace proleg::identity
