#pragma once

// The signals of a robot that the page can show, and their values of a tick (docs/page-interface.md, Telemetry).

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "shared/fixed/unit.hpp"
#include "sim/record/recorder.hpp"
#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// In a row for values that do not exist.
inline constexpr std::int32_t no_value = std::numeric_limits<std::int32_t>::min();

/// What one step of a raw value is worth in its unit.
[[nodiscard]] double value_of_step(Unit unit);

struct Signal {
  enum class Of : std::uint8_t { joint, link, robot };
  std::string name;
  std::string unit;
  double scale;                  ///< what one step of a raw value is worth in the unit
  std::vector<unsigned> places;  ///< the joint or link of each of its values
  Of of;
};

/// The signals of a robot. Their values follow each other in a row, in this order.
[[nodiscard]] std::vector<Signal> signals_of(const sim::Scenario& scenario);

/// The values of a tick, in the order of signals_of(). The row is overwritten.
void fill_row(const sim::TickSample& sample, const sim::Scenario& scenario, std::vector<std::int32_t>& row);

/// The same of a recording. scenario: scenario_of() the recording.
void fill_row(const sim::RecordedTick& tick, const sim::Scenario& scenario, std::vector<std::int32_t>& row);

}  // namespace proleg::tools
