#pragma once

// Network management (CiA 301, section 7.3.2): changes of the module's state, and their effects.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Executes a request to start, to stop or to enter Pre-operational, sent to this module or to all. Module itself
/// executes resets.
void change_state(Parts& parts, const canopen::NmtRequest& request);
/// Must be called when another node has sent with an identifier of this one: the module stops until a reset. Before its
/// boot-up message it only notes the collision: the host must see that there are two modules, and no EMCY comes before
/// boot-up (CiA 301, 7.3.2.2).
void stop_after_collision(Parts& parts, std::uint16_t identifier);
/// Reports the collision and stops the module. Must be called after the boot-up message, if there was a collision
/// before.
void report_collision(Parts& parts);

}  // namespace proleg::firmware
