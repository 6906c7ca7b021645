#include "host/robot/state_text.hpp"

#include "shared/canopen/power_state.hpp"

namespace proleg::host {
namespace {

constexpr unsigned without_quick_stop_bit = 0x4F;

}  // namespace

std::string_view state_text(canopen::NmtState state) {
  switch (state) {
    case canopen::NmtState::boot_up:
      return "booting";
    case canopen::NmtState::stopped:
      return "stopped";
    case canopen::NmtState::operational:
      return "operational";
    case canopen::NmtState::pre_operational:
      return "pre-operational";
  }
  return "unknown state";
}

std::string_view drive_text(std::uint16_t statusword) {
  switch (statusword & without_quick_stop_bit) {
    case 0x00:
      return "not ready";
    case 0x40:
      return "no power";
    case 0x0F:
      return "fault, stopping";
    case 0x08:
      return "fault";
    default:
      break;
  }
  switch (statusword & canopen::drive_state_bits) {
    case 0x21:
      return "ready to switch on";
    case 0x23:
      return "switched on";
    case canopen::drive_operation_enabled:
      return "operation enabled";
    case canopen::drive_quick_stop_active:
      return "quick stop";
    default:
      return "unknown state";
  }
}

}  // namespace proleg::host
