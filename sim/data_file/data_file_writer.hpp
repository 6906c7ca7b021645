#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Writes a recording as a data file of the thesis (listing B.8): the actuation modules, the touch sensors (`tactile`)
/// and the robot (`robot_data`), a frame for each tick. docs/recordings.md lists the types with their units, and what
/// differs from the print. Joints and links are in the order of the robot's file, as in the thesis's actuation files.
/// Numbers have nine significant digits.
///
/// scenario: the recording's, for masses and gravity; without it energies are "nan".
void write_data_file(const Recording& recording, const std::optional<Scenario>& scenario,
                     const std::function<void(std::string_view)>& write);

/// The thesis's name of an algorithm in its data files; an algorithm that it does not have keeps its name.
[[nodiscard]] std::string thesis_module_name(std::string_view algorithm);

}  // namespace proleg::sim
