#pragma once

// Network management (CiA 301, section 7.3.2): which changes of state the module makes, and what they entail.

#include "firmware/module/parts.hpp"

namespace proleg::firmware {

/// Start, stop or enter Pre-operational, sent to this module or to all. Resets are Module's.
void change_state(Parts& parts, const canopen::NmtRequest& request);
/// Another node has sent with an identifier of this one: the module stops until a reset.
void stop_after_collision(Parts& parts, std::uint16_t identifier);

}  // namespace proleg::firmware
