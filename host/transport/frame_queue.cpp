#include "host/transport/frame_queue.hpp"

#include <optional>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/canopen/power_state.hpp"
#include "shared/canopen/sdo_frame.hpp"

namespace proleg::host {
namespace {

/// Bits 1 and 2 of the controlword: both are set in all commands but quick stop and disable voltage.
constexpr std::uint16_t voltage_without_quick_stop = canopen::shutdown_controlword;

/// What a frame has a joint do.
struct MotionCommand {
  std::uint8_t node = 0;  ///< 0: all nodes
  bool ends_motion = false;
};

MotionCommand command_of(std::uint8_t node, std::uint16_t controlword) {
  return {node, (controlword & voltage_without_quick_stop) != voltage_without_quick_stop};
}

std::optional<MotionCommand> command_of(const CanFrame& frame) {
  namespace sdo = canopen::sdo;
  namespace identifier = canopen::identifier;
  if (const auto request = canopen::decode_nmt(frame)) {
    return MotionCommand{request->node, request->command != canopen::NmtCommand::start};
  }
  if (const auto command = canopen::decode_command(frame)) {
    return command_of(command->node, command->controlword);
  }
  if (identifier::base_of(frame.identifier) == identifier::sdo_request && frame.length == CanFrame::max_length &&
      sdo::specifier(frame) == sdo::request_download && sdo::address(frame) == canopen::object::controlword.address) {
    return command_of(static_cast<std::uint8_t>(frame.identifier - identifier::sdo_request),
                      static_cast<std::uint16_t>(sdo::data(frame, 2)));
  }
  return std::nullopt;
}

}  // namespace

bool ends_motion(const CanFrame& frame) {
  const std::optional<MotionCommand> command = command_of(frame);
  return command && command->ends_motion;
}

bool FrameQueue::push(const CanFrame& frame, std::uint64_t& dropped) {
  const std::optional<MotionCommand> command = command_of(frame);
  const bool is_stop = command && command->ends_motion;
  std::deque<CanFrame>& frames = is_stop ? stops_ : others_;
  if (frames.size() >= (is_stop ? max_stops : max_others)) {
    ++dropped;
    return false;
  }
  if (is_stop) {
    dropped += std::erase_if(others_, [&](const CanFrame& other) {
      const std::optional<MotionCommand> earlier = command_of(other);
      return earlier && (command->node == 0 || command->node == earlier->node);
    });
  }
  frames.push_back(frame);
  return true;
}

}  // namespace proleg::host
