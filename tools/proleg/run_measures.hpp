#pragma once

// How programs show what a run was worth (docs/gait-measures.md).

#include <string>
#include <utility>
#include <vector>

#include "sim/measure/measure.hpp"
#include "sim/robot/robot_model.hpp"
#include "tools/proleg/json_output.hpp"

namespace proleg::tools {

struct RunMeasures {
  sim::MeasureValues values;
  std::vector<double> link_duty_factors;  ///< from the head
};

/// An object of all measures by name; null where the run does not define one.
[[nodiscard]] Json measures_object(const sim::MeasureValues& values);

/// The measures that the run defines, on standard output, a line each.
void print_measures(const sim::MeasureValues& values);

/// The same for a recording's table of results, and the duty factors of the links.
void append_results(const RunMeasures& measures, const sim::RobotModel& robot,
                    std::vector<std::pair<std::string, std::string>>& results);

}  // namespace proleg::tools
