#pragma once

#include <linux/can.h>

#include "shared/can/can_port.hpp"

namespace proleg::host {

/// What an error frame of SocketCAN says (linux/can/error.h).
struct CanErrorReport {
  CanStatus status;  ///< what was known before, changed by the frame
  CanErrors errors;
  bool was_restarted = false;  ///< the controller has left bus-off
};

/// frame: one with CAN_ERR_FLAG. before: the state that is known.
[[nodiscard]] CanErrorReport read_can_error(const can_frame& frame, const CanStatus& before);

}  // namespace proleg::host
