#pragma once

#include <cstdint>
#include <ostream>
#include <string>

namespace proleg::tools {

/// "0x1F", of at least so many digits.
[[nodiscard]] std::string hexadecimal(std::uint32_t value, unsigned digits);

/// The object dictionary as an Electronic Data Sheet (CiA 306-1), which CANopen tools read. It holds no date of its
/// making, so that equal dictionaries give equal files. Units, for which the format has no key, are in comments.
void print_eds(std::ostream& out);

}  // namespace proleg::tools
