#pragma once

// The measures of a robot of modules, from the recording of its run (proleg drive --record). Such a recording has no
// path, no torques and no forces: modules do not measure them. Their measured angles come every tenth tick, and a
// recording does not say of which tick one is, so it says nothing about tracking either.

#include <span>

#include "sim/measure/measure.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The measures that such a recording can have: those of the measured currents, of the touch sensors, and of the
/// angles that the gait commands.
[[nodiscard]] std::span<const Measure> measures_of_modules();

/// Whether a measure comes from sensors of modules. It is then defined for each run of a robot that has them.
[[nodiscard]] bool is_sensed_by_modules(Measure measure);

/// Those of one run, from its first tick to its last; all others are not defined. A current that is 0 in all joints all
/// the time was not measured, and touch sensors of which none was ever pressed are not there: what they would give is
/// not defined. Touch sensors are those that the gait gets, debounced. scenario: of the recording. Throws InputError if
/// the recording has other joints or links, and as Recording does.
[[nodiscard]] MeasureValues measure_modules(const Recording& recording, const Scenario& scenario);

}  // namespace proleg::sim
