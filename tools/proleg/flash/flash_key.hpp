#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/proleg/robot/bus_access.hpp"

namespace proleg::tools {

/// proleg flash --public-key without --bare: gives modules their first key, over the bus. file: the public key. nodes:
/// only these. Returns the exit status. Throws InputError, and std::runtime_error if no module is found.
int run_flash_key(BusAccess& bus, const std::string& file, const std::optional<std::vector<std::uint8_t>>& nodes);

}  // namespace proleg::tools
