#include "host/robot/state_text.hpp"

#include <array>
#include <cstdio>

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

std::string_view fault_advice(canopen::EmergencyCode code) {
  using enum canopen::EmergencyCode;
  switch (code) {
    case none:
    case rejoined:
      break;
    case over_current:
      return "Look whether the joint is blocked; give it less amplitude, or a higher limit (object 0x200A).";
    case supply_low:
      return "Charge the battery, or look at the supply and its cable.";
    case over_temperature:
      return "Switch the power off and let the module cool.";
    case sensors_failed:
      return "Switch the module off and on; if it comes back, look at its board.";
    case clock_failure:
      return "Look at the crystal of the board.";
    case watchdog_reset:
    case software_fault:
      return "Start again; if it comes back, flash the module and report it.";
    case not_configured:
    case foreign_configuration:
      return "Start again: another program may have changed the module.";
    case frames_lost:
      return "Look for another program that sends on the bus.";
    case heartbeat_lost:
      return "Look at the connection of this computer to the bus.";
    case bus_off_recovered:
    case wrong_length:
      return "Look at cable, termination and plugs: proleg doctor.";
    case identifier_collision:
      return "Two modules have one node id: proleg assign.";
    case sync_lost:
    case early_sync:
      return "Look at the cable to the first joint, and for another program that drives the robot.";
    case newer_settings:
      return "Flash the later program again, or store default settings: proleg recover --reset-settings.";
    case commit_too_late:
    case commit_not_staged:
    case unknown_label:
      return "Start again; if it comes back, look at cable and termination: proleg doctor.";
  }
  return "docs/protocol.md explains the code. Start again; if it comes back, look at its cause.";
}

std::string image_key_text(std::uint32_t key_id) {
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%08x", static_cast<unsigned>(key_id));
  return key_id == 0 ? "takes any image" : std::string("key ") + digits.data();
}

}  // namespace proleg::host
