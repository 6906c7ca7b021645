#include "host/transport/can_error_frame.hpp"

#include <linux/can/error.h>

#include <optional>

namespace proleg::host {
namespace {

// Places in the data of an error frame.
constexpr std::size_t controller_byte = 1;
constexpr std::size_t violation_byte = 2;
constexpr std::size_t location_byte = 3;
constexpr std::size_t transmit_counter = 6;
constexpr std::size_t receive_counter = 7;
constexpr canid_t has_counters = 0x200;        // CAN_ERR_CNT of Linux 5.18 and later
constexpr unsigned controller_active = 0x40;   // CAN_ERR_CRTL_ACTIVE
constexpr std::uint16_t bus_off_errors = 256;  // the counter is one byte in the frame

std::optional<CanState> state_of(const can_frame& frame) {
  const unsigned controller = (frame.can_id & CAN_ERR_CRTL) != 0 ? frame.data[controller_byte] : 0U;
  if ((frame.can_id & CAN_ERR_BUSOFF) != 0) {
    return CanState::bus_off;
  }
  if ((controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
    return CanState::error_passive;
  }
  if ((controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
    return CanState::error_warning;
  }
  if ((frame.can_id & CAN_ERR_RESTARTED) != 0 || (controller & controller_active) != 0) {
    return CanState::error_active;
  }
  return std::nullopt;
}

CanErrors errors_of(const can_frame& frame) {
  CanErrors errors;
  const auto add_if = [&errors](bool holds, CanErrorKind kind) {
    if (holds) {
      errors.add(kind);
    }
  };
  const bool has_protocol = (frame.can_id & CAN_ERR_PROT) != 0;
  const unsigned violation = has_protocol ? frame.data[violation_byte] : 0U;
  const unsigned location = has_protocol ? frame.data[location_byte] : 0U;
  const unsigned controller = (frame.can_id & CAN_ERR_CRTL) != 0 ? frame.data[controller_byte] : 0U;
  add_if((frame.can_id & CAN_ERR_ACK) != 0 || location == CAN_ERR_PROT_LOC_ACK, CanErrorKind::acknowledgement);
  add_if((violation & CAN_ERR_PROT_BIT0) != 0, CanErrorKind::bit_dominant);
  add_if((violation & CAN_ERR_PROT_BIT1) != 0, CanErrorKind::bit_recessive);
  add_if(location == CAN_ERR_PROT_LOC_CRC_SEQ || location == CAN_ERR_PROT_LOC_CRC_DEL, CanErrorKind::crc);
  add_if((violation & CAN_ERR_PROT_FORM) != 0, CanErrorKind::form);
  add_if((violation & CAN_ERR_PROT_STUFF) != 0, CanErrorKind::stuff);
  add_if((controller & CAN_ERR_CRTL_RX_OVERFLOW) != 0, CanErrorKind::receive_overrun);
  add_if((controller & CAN_ERR_CRTL_TX_OVERFLOW) != 0, CanErrorKind::transmit_overrun);
  return errors;
}

}  // namespace

CanErrorReport read_can_error(const can_frame& frame, const CanStatus& before) {
  CanErrorReport report{before, errors_of(frame), (frame.can_id & CAN_ERR_RESTARTED) != 0};
  const std::optional<CanState> state = state_of(frame);
  report.status.state = state.value_or(before.state);
  const bool is_off = report.status.state == CanState::bus_off;
  if ((frame.can_id & has_counters) != 0 && !is_off) {
    report.status.transmit_errors = frame.data[transmit_counter];
    report.status.receive_errors = frame.data[receive_counter];
  } else if (state == CanState::bus_off) {
    report.status.transmit_errors = bus_off_errors;
  } else if (state == CanState::error_active) {
    report.status.transmit_errors = 0;
    report.status.receive_errors = 0;
  }
  return report;
}

}  // namespace proleg::host
