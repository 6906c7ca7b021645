#include "firmware/module/emergencies.hpp"

namespace proleg::firmware {
namespace {

using canopen::EmergencyCode;

EmergencyCode code_of(Fault fault) {
  switch (fault) {
    case Fault::identifier_collision:
      return EmergencyCode::identifier_collision;
    case Fault::sync_lost:
      return EmergencyCode::sync_lost;
    case Fault::heartbeat_lost:
      return EmergencyCode::heartbeat_lost;
    case Fault::foreign_configuration:
      return EmergencyCode::foreign_configuration;
    case Fault::over_current:
      return EmergencyCode::over_current;
    case Fault::supply_low:
      return EmergencyCode::supply_low;
    case Fault::sensors_failed:
      return EmergencyCode::sensors_failed;
    case Fault::over_temperature:
      return EmergencyCode::over_temperature;
    case Fault::newer_settings:
      return EmergencyCode::newer_settings;
    case Fault::bus_off:
      break;
  }
  return EmergencyCode::bus_off_recovered;
}

}  // namespace

// These functions are not inlined, because report(), raise() and clear() have many callers and rarely run.
[[gnu::noinline]] void Emergencies::report(EmergencyCode code, std::uint32_t detail) {
  if (code != EmergencyCode::none) {
    keep(code, detail);
  }
  if (network_.state() != canopen::NmtState::stopped && !network_.waits_for_node()) {
    outbox_.send(encode(canopen::Emergency{identity_.node, code, error_register(), detail}));
  }
}

void Emergencies::keep(EmergencyCode code, std::uint32_t detail) {
  if (history_size_ < history_.size()) {
    ++history_size_;
  }
  for (std::size_t i = history_size_ - 1U; i > 0; --i) {
    history_[i] = history_[i - 1];
  }
  history_[0] = detail << 16U | static_cast<std::uint32_t>(code);
}

[[gnu::noinline]] void Emergencies::raise(Fault fault, std::uint32_t detail) {
  faults_ = static_cast<std::uint16_t>(faults_ | bit(fault));
  report(code_of(fault), detail);
}

[[gnu::noinline]] void Emergencies::end(Fault fault) {
  faults_ = static_cast<std::uint16_t>(faults_ & ~bit(fault));
  report(EmergencyCode::none, static_cast<std::uint32_t>(code_of(fault)));
}

void Emergencies::report_reset_cause() {
  if (!is_reset_cause_pending_) {
    return;
  }
  is_reset_cause_pending_ = false;
  if (identity_.reset_cause == ResetCause::watchdog) {
    report(EmergencyCode::watchdog_reset, identity_.reset_detail);
  } else if (identity_.reset_cause == ResetCause::fault) {
    report(EmergencyCode::software_fault, identity_.reset_detail);
  } else if (identity_.reset_cause == ResetCause::clock) {
    report(EmergencyCode::clock_failure, identity_.reset_detail);
  }
}

std::uint8_t Emergencies::error_register() const {
  constexpr unsigned generic = 1U << 0U;
  constexpr unsigned current = 1U << 1U;
  constexpr unsigned voltage = 1U << 2U;
  constexpr unsigned temperature = 1U << 3U;
  constexpr unsigned communication = 1U << 4U;
  constexpr unsigned device_profile = 1U << 5U;
  constexpr unsigned manufacturer_specific = 1U << 7U;
  const unsigned over_current = bit(Fault::over_current);
  const unsigned supply_low = bit(Fault::supply_low);
  const unsigned foreign = bit(Fault::foreign_configuration);
  const unsigned sensors = bit(Fault::sensors_failed);
  const unsigned over_temperature = bit(Fault::over_temperature);
  const unsigned of_the_project = foreign | bit(Fault::newer_settings);
  const unsigned others = over_current | supply_low | over_temperature | sensors | of_the_project;
  return static_cast<std::uint8_t>(
      (faults_ != 0 ? generic : 0U) | ((faults_ & over_current) != 0 ? current : 0U) |
      ((faults_ & supply_low) != 0 ? voltage : 0U) | ((faults_ & over_temperature) != 0 ? temperature : 0U) |
      ((faults_ & ~others) != 0 ? communication : 0U) | ((faults_ & sensors) != 0 ? device_profile : 0U) |
      ((faults_ & of_the_project) != 0 ? manufacturer_specific : 0U));
}

}  // namespace proleg::firmware
