#pragma once

#include <string>

namespace proleg::tools {

/// The address of the only adapter of this computer that has joint modules behind it: CAN interfaces that are up, and
/// serial adapters. Throws std::runtime_error, which names what was looked at, if there is none, or more than one.
[[nodiscard]] std::string find_bus();

}  // namespace proleg::tools
