#pragma once

#include <string>
#include <vector>

namespace proleg::tools {

/// The addresses of the CAN interfaces and serial adapters of this computer, whatever is behind them.
[[nodiscard]] std::vector<std::string> present_buses();

/// The address of the only adapter of this computer that has joint modules behind it: CAN interfaces that are up, and
/// serial adapters. Throws std::runtime_error, which names what was looked at, if there is none, or more than one.
[[nodiscard]] std::string find_bus();

}  // namespace proleg::tools
