#pragma once

// The signals of a robot that the page can show, and their values of a tick (docs/page-interface.md, Telemetry).

#include <cstdint>
#include <vector>

#include "host/server/telemetry.hpp"
#include "shared/fixed/unit.hpp"
#include "sim/record/recorder.hpp"
#include "sim/record/recording.hpp"
#include "sim/robot/pose.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Size of one step of a raw value, in its unit.
[[nodiscard]] double value_of_step(Unit unit);

/// An angle in rad as a raw value of the unit degree; no_value if it is not finite.
[[nodiscard]] std::int32_t raw_angle(double angle);

/// Appends a pose as the signal `head` has it: seven values.
void append_pose(const sim::Pose& pose, std::vector<std::int32_t>& row);

/// The signals of a robot, in the order of their values in a row.
[[nodiscard]] std::vector<host::Signal> signals_of(const sim::Scenario& scenario);

/// Overwrites the row with the values of a tick, in the order of signals_of().
void fill_row(const sim::TickSample& sample, const sim::Scenario& scenario, std::vector<std::int32_t>& row);

/// Overwrites the row with the values of a recorded tick. scenario: scenario_of() the recording.
void fill_row(const sim::RecordedTick& tick, const sim::Scenario& scenario, std::vector<std::int32_t>& row);

}  // namespace proleg::tools
