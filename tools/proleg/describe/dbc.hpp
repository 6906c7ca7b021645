#pragma once

#include <ostream>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Writes the frames of the protocol as a DBC file, with names, places, units and values of their signals. They follow
/// from the declarations of the messages, the process data objects and the algorithms.
///
/// The file describes the robot of a scenario: its node ids, names of joints, and the broadcasts of each joint's
/// algorithm.
void print_dbc(std::ostream& out, const sim::Scenario& scenario);
/// Writes the frames for any robot with the node ids 1 to `nodes`.
void print_dbc(std::ostream& out, unsigned nodes);

}  // namespace proleg::tools
