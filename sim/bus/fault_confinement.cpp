#include "sim/bus/fault_confinement.hpp"

namespace proleg::sim {
namespace {

constexpr unsigned max_active = 127;
constexpr unsigned max_on_bus = 255;

}  // namespace

ErrorState ErrorCounters::state() const {
  if (transmit_ > max_on_bus) {
    return ErrorState::bus_off;
  }
  return transmit_ > max_active || receive_ > max_active ? ErrorState::passive : ErrorState::active;
}

void ErrorCounters::transmitter_error() { transmit_ += transmit_ > max_on_bus ? 0 : 8; }

void ErrorCounters::receiver_error() { receive_ += receive_ > max_active ? 0 : 1; }

void ErrorCounters::transmitted() { transmit_ -= transmit_ > 0 ? 1 : 0; }

void ErrorCounters::received() {
  if (receive_ > max_active) {
    receive_ = max_active;
  } else if (receive_ > 0) {
    --receive_;
  }
}

}  // namespace proleg::sim
