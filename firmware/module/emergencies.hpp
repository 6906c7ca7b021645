#pragma once

#include <span>

#include "firmware/module/network_node.hpp"
#include "shared/canopen/objects.hpp"

namespace proleg::firmware {

/// Errors that last until they are cleared.
enum class Fault : std::uint8_t {
  identifier_collision,
  sync_lost,
  heartbeat_lost,
  foreign_configuration,
  over_current,
  bus_off,
  supply_low,
  over_temperature,
  sensors_failed,
  newer_settings,
};

/// Sends EMCY and keeps the error register (CiA 301, section 7.2.7). A module that is stopped or has no node id sends
/// no EMCY.
class Emergencies {
 public:
  Emergencies(const ModuleIdentity& identity, const NetworkNode& network, Outbox& outbox)
      : identity_(identity), network_(network), outbox_(outbox) {}

  void reset() {
    faults_ = 0;
    clear_history();
  }
  /// Forgets the errors of the communication, and the history, which is a communication object.
  void reset_communication() {
    faults_ &= bit(Fault::over_current);
    clear_history();
  }
  /// Must be called at power-on: the reset cause is not yet reported.
  void power_on() { is_reset_cause_pending_ = true; }

  /// Reports an event.
  void report(canopen::EmergencyCode code, std::uint32_t detail);
  /// Reports an error that lasts.
  void raise(Fault fault, std::uint32_t detail);
  /// Ends an error that lasts: sends EMCY `none`, with the error's code as the detail. Nothing happens if it was not
  /// raised.
  void clear(Fault fault) {
    if (is_raised(fault)) {
      end(fault);
    }
  }
  /// Reports the cause of the reset if the program did not end as it should; once after power_on(). Must be called
  /// after the boot-up message was sent: EMCY has the lower identifier and would overtake it.
  void report_reset_cause();
  [[nodiscard]] bool is_raised(Fault fault) const { return (faults_ & bit(fault)) != 0; }

  /// Object 0x1003: the last errors, the newest first. The lower half of a number is the emergency code, the upper half
  /// the lower half of the detail.
  [[nodiscard]] std::span<const std::uint32_t> history() const { return {history_.data(), history_size_}; }
  void clear_history() { history_size_ = 0; }

  /// Object 0x1001: the error register.
  [[nodiscard]] std::uint8_t error_register() const;

 private:
  void end(Fault fault);
  void keep(canopen::EmergencyCode code, std::uint32_t detail);
  [[nodiscard]] static std::uint16_t bit(Fault fault) {
    return static_cast<std::uint16_t>(1U << static_cast<unsigned>(fault));
  }

  const ModuleIdentity& identity_;
  const NetworkNode& network_;
  Outbox& outbox_;
  std::uint16_t faults_ = 0;
  std::uint8_t history_size_ = 0;
  std::array<std::uint32_t, canopen::object::recent_error.count> history_{};
  bool is_reset_cause_pending_ = false;
};

}  // namespace proleg::firmware
