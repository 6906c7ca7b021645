#pragma once

// What TICK and SYNC lead to: the joint's state of each tick is computed and sent, and the servo gets its set-point.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Operational was entered. together: all modules were started, so that tick 0 is to come. A module that is started
/// alone joins a robot that moves.
void start_gait(Parts& parts, bool together);
/// Operational was left: the tick is lost, and the joint goes back to state 0.
void stop_gait(Parts& parts);

void receive_tick(Parts& parts, const CanFrame& frame);
void receive_sync(Parts& parts, Microseconds now, const CanFrame& frame);

}  // namespace proleg::firmware
