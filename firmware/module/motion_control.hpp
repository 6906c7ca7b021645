#pragma once

// Effects of the messages that move the robot. At TICK and SYNC the joint's state of each tick is computed and sent,
// and the servo gets its set-point. COMMIT and the command by PDO are requests of the host while the robot moves.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Must be called when Operational was entered. together: all modules were started, so that tick 0 follows. A module
/// that is started alone joins a robot that moves.
void start_gait(Parts& parts, bool together);
/// Must be called when Operational was left: the tick is lost, and the joint returns to state 0.
void stop_gait(Parts& parts);

void receive_tick(Parts& parts, const CanFrame& frame);
void receive_sync(Parts& parts, Microseconds now, const CanFrame& frame);

void receive_commit(Parts& parts, const CanFrame& frame);
/// Executes a command to this module, in Operational.
void receive_command(Parts& parts, const CanFrame& frame);

}  // namespace proleg::firmware
