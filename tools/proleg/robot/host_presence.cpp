#include "tools/proleg/robot/host_presence.hpp"

#include "shared/canopen/messages.hpp"
#include "shared/computer/master/master.hpp"

namespace proleg::tools {

void HostPresence::poll(Microseconds now) {
  constexpr Microseconds period_us = canopen::Master::heartbeat_period_us;
  constexpr Microseconds until_next_try_us = 1'000;
  if (is_active_ && now >= next_) {
    const bool is_sent =
        bus_.send(canopen::encode(canopen::Heartbeat{canopen::host_node, canopen::NmtState::operational}));
    next_ = now + (is_sent ? period_us : until_next_try_us);
  }
}

}  // namespace proleg::tools
