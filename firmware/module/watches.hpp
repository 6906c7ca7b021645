#pragma once

// Watching the bus, the host's heartbeat, SYNC, the servo's current, its sensors and the supply. What fails is reported
// by EMCY and stops the servo: a quick stop, or a fault for over-current, sensors and supply. The EMCY `none` reports
// that it is over.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// The controller is bus-off.
void leave_bus(Parts& parts, Microseconds now);
/// The controller takes part in the bus again.
void return_to_bus(Parts& parts, Microseconds now);

void receive_heartbeat(Parts& parts, Microseconds now, const CanFrame& frame);

/// Takes a reading and judges the current.
void read_servo(Parts& parts, Microseconds now);

/// The supply voltage is good again.
void end_supply_low(Parts& parts);

void poll_bus(Parts& parts, Microseconds now);
void poll_host(Parts& parts, Microseconds now);
void poll_sync(Parts& parts, Microseconds now);

/// After each event: whether over-current is over, whether supply and sensors allow power, what the servo does, and
/// whether SYNC is expected. Before SYNC 0 a joint ramps in, if the host has set a speed for that (0x200E) and the
/// module measures its angle.
void clear_over_current(Parts& parts);
void require_good_hardware(Parts& parts);
void update_drive(Parts& parts, Microseconds now);
void update_watches(Parts& parts, Microseconds now);

}  // namespace proleg::firmware
