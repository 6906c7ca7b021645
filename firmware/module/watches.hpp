#pragma once

// Watches over the bus, the host's heartbeat, SYNC, the servo's current, its sensors and the supply. A failure is
// reported by EMCY and stops the servo: a quick stop, or a fault for over-current, sensors and supply. EMCY `none`
// reports its end.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Must be called when the controller is bus-off.
void leave_bus(Parts& parts, Microseconds now);
/// Must be called when the controller takes part in the bus again.
void return_to_bus(Parts& parts, Microseconds now);

void receive_heartbeat(Parts& parts, Microseconds now, const CanFrame& frame);

/// Takes a reading and checks the current.
void read_servo(Parts& parts, Microseconds now);

/// Must be called when the supply voltage is good again.
void end_supply_low(Parts& parts);

void poll_bus(Parts& parts, Microseconds now);
void poll_host(Parts& parts, Microseconds now);
void poll_sync(Parts& parts, Microseconds now);

/// These functions must be called after each event. They decide whether over-current is over, whether supply, sensors
/// and stored settings allow power, what the servo does, and whether SYNC is expected. Before SYNC 0 a joint ramps in,
/// if the host has set a speed for that (0x200E) and the module measures its angle.
void clear_over_current(Parts& parts);
void require_good_hardware(Parts& parts);
void require_known_settings(Parts& parts);
void update_drive(Parts& parts, Microseconds now);
void update_watches(Parts& parts, Microseconds now);

}  // namespace proleg::firmware
