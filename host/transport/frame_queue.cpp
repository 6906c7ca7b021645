#include "host/transport/frame_queue.hpp"

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/canopen/sdo_frame.hpp"

namespace proleg::host {
namespace {

/// Bits 1 and 2 of the controlword: both are set in all commands but quick stop and disable voltage.
constexpr std::uint16_t voltage_without_quick_stop = canopen::shutdown_controlword;

bool ends_motion(std::uint16_t controlword) {
  return (controlword & voltage_without_quick_stop) != voltage_without_quick_stop;
}

}  // namespace

bool ends_motion(const CanFrame& frame) {
  namespace sdo = canopen::sdo;
  namespace identifier = canopen::identifier;
  if (const auto request = canopen::decode_nmt(frame)) {
    return request->command != canopen::NmtCommand::start;
  }
  if (const auto command = canopen::decode_command(frame)) {
    return ends_motion(command->controlword);
  }
  return identifier::base_of(frame.identifier) == identifier::sdo_request && frame.length == CanFrame::max_length &&
         sdo::specifier(frame) == sdo::request_download &&
         sdo::address(frame) == canopen::object::controlword.address &&
         ends_motion(static_cast<std::uint16_t>(sdo::data(frame, 2)));
}

}  // namespace proleg::host
