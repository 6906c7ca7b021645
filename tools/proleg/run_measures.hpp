#pragma once

// How programs show the measures of a run (docs/gait-measures.md).

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

/// Prints the measures that the run defines on standard output, one a line.
void print_measures(const sim::MeasureValues& values);

/// Adds the measures that the run defines, and the duty factors of the links, to the results of a recording.
void append_results(const RunMeasures& measures, const sim::RobotModel& robot,
                    std::vector<std::pair<std::string, std::string>>& results);

}  // namespace proleg::tools
