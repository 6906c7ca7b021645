#pragma once

// Files about the object dictionary for other tools.

#include <ostream>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The keys of an entry in an Electronic Data Sheet.
enum class EdsKeys {
  of_the_standard,  ///< those of CiA 306-1 alone: strict readers refuse others
  with_units,       ///< also Factor, Unit and Description (the help text), which python-canopen reads
};

/// Writes the object dictionary as an Electronic Data Sheet (CiA 306-1), which CANopen tools read. The date is fixed,
/// so that equal dictionaries give equal files.
void print_eds(std::ostream& out, EdsKeys keys);

/// Writes the frames of the protocol as a DBC file, with names, places, units and values of their signals. They follow
/// from the declarations of the messages, the process data objects and the algorithms.
///
/// The file describes the robot of a scenario: its node ids, names of joints, and the broadcasts of each joint's
/// algorithm.
void print_dbc(std::ostream& out, const sim::Scenario& scenario);
/// Writes the frames for any robot with the node ids 1 to `nodes`.
void print_dbc(std::ostream& out, unsigned nodes);

}  // namespace proleg::tools
