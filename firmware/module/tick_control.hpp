#pragma once

// Effects of TICK and SYNC: the joint's state of each tick is computed and sent, and the servo gets its set-point.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Must be called when Operational was entered. together: all modules were started, so that tick 0 follows. A module
/// that is started alone joins a robot that moves.
void start_gait(Parts& parts, bool together);
/// Must be called when Operational was left: the tick is lost, and the joint returns to state 0.
void stop_gait(Parts& parts);

void receive_tick(Parts& parts, const CanFrame& frame);
void receive_sync(Parts& parts, Microseconds now, const CanFrame& frame);

}  // namespace proleg::firmware
