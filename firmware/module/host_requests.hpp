#pragma once

// Requests of the host while the robot moves, other than by SDO: COMMIT, and the command by PDO.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

void receive_commit(Parts& parts, const CanFrame& frame);
/// Executes a command to this module, in Operational.
void receive_command(Parts& parts, const CanFrame& frame);

}  // namespace proleg::firmware
