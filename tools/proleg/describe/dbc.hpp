#pragma once

#include <ostream>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Writes the frames of the protocol as a DBC file, with names, places, units and values of their signals. They follow
/// from the declarations of the messages, the process data objects and the algorithms.
///
/// Of the robot of a scenario: its node ids, names of joints, and what the algorithm of each joint broadcasts.
void print_dbc(std::ostream& out, const sim::Scenario& scenario);
/// Of any robot with the node ids 1 to `nodes`.
void print_dbc(std::ostream& out, unsigned nodes);

}  // namespace proleg::tools
