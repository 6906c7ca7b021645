#pragma once

#include <ostream>

namespace proleg::tools {

/// Writes the object dictionary as an Electronic Data Sheet (CiA 306-1), which CANopen tools read. The date is fixed,
/// so that equal dictionaries give equal files. Units, for which the format has no key, are in comments.
void print_eds(std::ostream& out);

}  // namespace proleg::tools
