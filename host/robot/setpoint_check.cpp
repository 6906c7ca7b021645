#include "host/robot/setpoint_check.hpp"

namespace proleg::host {

void SetpointCheck::add(std::span<const std::int32_t> setpoints) {
  const std::size_t first = ticks_ % kept_ticks * crcs_.size();
  for (std::size_t joint = 0; joint < crcs_.size(); ++joint) {
    crcs_[joint].add_little_endian(static_cast<std::uint32_t>(setpoints[joint]), 4);
    kept_[first + joint] = crcs_[joint].value();
  }
  ++ticks_;
}

SetpointCheck::Result SetpointCheck::compare(unsigned joint, const canopen::Master::SetpointChecksum& found) const {
  using State = canopen::Master::SetpointChecksum::State;
  if (found.state != State::read) {
    return found.state == State::not_available ? Result::no_checksum : Result::no_answer;
  }
  if (found.ticks == 0) {
    return Result::not_complete;
  }
  if (found.ticks > ticks_ || ticks_ - found.ticks >= kept_ticks) {
    return Result::unknown_tick;
  }
  const std::uint32_t expected = kept_[(found.ticks - 1) % kept_ticks * crcs_.size() + joint];
  return found.crc == expected ? Result::equal : Result::different;
}

std::string why_not_compared(SetpointCheck::Result result) {
  using Result = SetpointCheck::Result;
  switch (result) {
    case Result::equal:
    case Result::different:
      break;
    case Result::no_checksum:
      return "its module has no checksum of them";
    case Result::no_answer:
      return "its module has not answered";
    case Result::not_complete:
      return "its module has joined late";
    case Result::unknown_tick:
      return "this computer has not computed all of its ticks";
  }
  return {};
}

}  // namespace proleg::host
