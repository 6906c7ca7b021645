#include "shared/canopen/power_state.hpp"

namespace proleg::canopen {
namespace {

/// Bits of the controlword (CiA 402).
constexpr unsigned switch_on_bit = 1U << 0U;
constexpr unsigned enable_voltage_bit = 1U << 1U;
constexpr unsigned no_quick_stop_bit = 1U << 2U;
constexpr unsigned enable_operation_bit = 1U << 3U;
constexpr unsigned fault_reset_bit = 1U << 7U;

/// Bits of the statusword that are always set: the supply of the servo cannot be switched off (voltage enabled), and
/// the module obeys the controlword (remote).
constexpr unsigned always = 1U << 4U | 1U << 9U;

/// The bits of drive_state_bits that stand for a state.
constexpr unsigned state_bits(PowerState state) {
  switch (state) {
    case PowerState::switch_on_disabled:
      return 0x40;
    case PowerState::ready_to_switch_on:
      return 0x21;
    case PowerState::switched_on:
      return 0x23;
    case PowerState::operation_enabled:
      return drive_operation_enabled;
    case PowerState::quick_stop_active:
      return drive_quick_stop_active;
    case PowerState::fault:
      break;
  }
  return 0x08;
}

/// Commands of the controlword (CiA 402, command coding). Each command includes those before it: `enable` in Ready to
/// switch on passes through Switched on.
enum class PowerCommand : std::uint8_t { disable_voltage, quick_stop, shut_down, switch_on, enable };

constexpr PowerCommand command_of(unsigned controlword) {
  if ((controlword & enable_voltage_bit) == 0) {
    return PowerCommand::disable_voltage;
  }
  if ((controlword & no_quick_stop_bit) == 0) {
    return PowerCommand::quick_stop;
  }
  if ((controlword & switch_on_bit) == 0) {
    return PowerCommand::shut_down;
  }
  return (controlword & enable_operation_bit) == 0 ? PowerCommand::switch_on : PowerCommand::enable;
}

/// The next state, by the transitions 2 to 12 of CiA 402. Transition 16, from Quick stop active back to Operation
/// enabled, is left out: hosts repeat the controlword, which would start the robot without a decision.
constexpr PowerState next(PowerState state, PowerCommand command) {
  switch (state) {
    case PowerState::fault:
      return state;
    case PowerState::switch_on_disabled:
      return command == PowerCommand::shut_down ? PowerState::ready_to_switch_on : state;
    case PowerState::quick_stop_active:
      return command == PowerCommand::disable_voltage ? PowerState::switch_on_disabled : state;
    default:
      break;
  }
  switch (command) {
    case PowerCommand::disable_voltage:
      return PowerState::switch_on_disabled;
    case PowerCommand::quick_stop:
      return state == PowerState::operation_enabled ? PowerState::quick_stop_active : PowerState::switch_on_disabled;
    case PowerCommand::shut_down:
      return PowerState::ready_to_switch_on;
    case PowerCommand::switch_on:
      return PowerState::switched_on;
    case PowerCommand::enable:
      break;
  }
  return PowerState::operation_enabled;
}

}  // namespace

void PowerControl::command(std::uint16_t controlword) {
  const bool rising = (controlword & ~unsigned{controlword_} & fault_reset_bit) != 0;
  controlword_ = controlword;
  if ((controlword & fault_reset_bit) == 0) {
    state_ = next(state_, command_of(controlword));
  } else if (rising && (state_ == PowerState::fault || state_ == PowerState::quick_stop_active)) {
    state_ = PowerState::switch_on_disabled;
  }
}

void PowerControl::quick_stop() {
  if (state_ == PowerState::operation_enabled) {
    state_ = PowerState::quick_stop_active;
  }
}

void PowerControl::disable_voltage() {
  if (state_ != PowerState::fault) {
    state_ = PowerState::switch_on_disabled;
  }
}

void PowerControl::fault() { state_ = PowerState::fault; }

void PowerControl::reset() { *this = PowerControl(); }

std::uint16_t PowerControl::statusword() const { return static_cast<std::uint16_t>(state_bits(state_) | always); }

}  // namespace proleg::canopen
