#pragma once

// Files about the object dictionary for other tools.

#include <ostream>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// Writes the object dictionary as an Electronic Data Sheet (CiA 306-1), which CANopen tools read. The date is fixed,
/// so that equal dictionaries give equal files. Factor, unit and help text, for which the format has no keys, have the
/// keys that python-canopen reads.
void print_eds(std::ostream& out);

/// Writes the frames of the protocol as a DBC file, with names, places, units and values of their signals. They follow
/// from the declarations of the messages, the process data objects and the algorithms.
///
/// The file describes the robot of a scenario: its node ids, names of joints, and the broadcasts of each joint's
/// algorithm.
void print_dbc(std::ostream& out, const sim::Scenario& scenario);
/// Writes the frames for any robot with the node ids 1 to `nodes`.
void print_dbc(std::ostream& out, unsigned nodes);

}  // namespace proleg::tools
