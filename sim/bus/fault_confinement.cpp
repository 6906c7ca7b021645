#include "sim/bus/fault_confinement.hpp"

namespace proleg::sim {
namespace {

constexpr unsigned error_active_up_to = 127;
constexpr unsigned on_the_bus_up_to = 255;

}  // namespace

ErrorState ErrorCounters::state() const {
  if (transmit_ > on_the_bus_up_to) {
    return ErrorState::bus_off;
  }
  return transmit_ > error_active_up_to || receive_ > error_active_up_to ? ErrorState::passive : ErrorState::active;
}

void ErrorCounters::transmitter_error() { transmit_ += transmit_ > on_the_bus_up_to ? 0 : 8; }

void ErrorCounters::receiver_error() { receive_ += receive_ > error_active_up_to ? 0 : 1; }

void ErrorCounters::transmitted() { transmit_ -= transmit_ > 0 ? 1 : 0; }

void ErrorCounters::received() {
  if (receive_ > error_active_up_to) {
    receive_ = error_active_up_to;
  } else if (receive_ > 0) {
    --receive_;
  }
}

}  // namespace proleg::sim
