#pragma once

#include <ostream>

namespace proleg::tools {

/// Writes the object dictionary as an Electronic Data Sheet (CiA 306-1), which CANopen tools read. The date is fixed,
/// so that equal dictionaries give equal files. Factor, unit and help text, for which the format has no keys, have the
/// keys that python-canopen reads.
void print_eds(std::ostream& out);

}  // namespace proleg::tools
