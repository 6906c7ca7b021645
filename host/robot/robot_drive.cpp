#include "host/robot/robot_drive.hpp"

#include <algorithm>

namespace proleg::host {

RobotDrive::RobotDrive(CanPort& port, const canopen::RobotSetup& setup, const canopen::MasterOptions& options,
                       std::span<Change> changes)
    : master_(port, setup, options, changes),
      nodes_(setup.nodes.begin(), setup.nodes.end()),
      ring_(kept),
      monitoring_(nodes_.size()) {
  for (unsigned joint = 0; joint < nodes_.size(); ++joint) {
    channels_.push_back(setup.kernel.second_channel_senders().contains(joint) ? 2 : 1);
  }
  for (std::uint32_t tick = 0; tick < kept; ++tick) {
    ring_[tick] = {tick, std::vector<std::array<std::optional<StateFrame>, 2>>(nodes_.size())};
  }
}

std::optional<unsigned> RobotDrive::joint_of(std::uint8_t node) const {
  const auto found = std::ranges::find(nodes_, node);
  return found == nodes_.end() ? std::nullopt : std::optional(static_cast<unsigned>(found - nodes_.begin()));
}

void RobotDrive::receive(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  master_.receive(now, frame);
  if (canopen::decode_sync(frame)) {
    note_sync();
    return;
  }
  switch (identifier::base_of(frame.identifier)) {
    case identifier::state_frame:
      note_state(frame, 0);
      break;
    case identifier::second_state:
      note_state(frame, 1);
      break;
    case identifier::monitoring:
      if (const auto message = canopen::decode_monitoring(frame)) {
        if (const auto joint = joint_of(message->node)) {
          monitoring_[*joint] = message;
          note_measurement(*joint, *message);
        }
      }
      break;
    default:
      break;
  }
}

void RobotDrive::note_measurement(unsigned joint, const canopen::Monitoring& values) {
  if (!present_) {
    return;
  }
  if (measurements_.size() == max_measurements) {
    measurements_.pop_front();
  }
  measurements_.push_back({*present_, joint, values});
}

std::optional<Measurement> RobotDrive::take_measurement() {
  if (measurements_.empty()) {
    return std::nullopt;
  }
  const Measurement oldest = measurements_.front();
  measurements_.pop_front();
  return oldest;
}

void RobotDrive::note_sync() {
  if (master_.state() == canopen::MasterState::running || present_) {
    present_ = master_.tick();
  }
}

void RobotDrive::note_state(const CanFrame& frame, unsigned channel) {
  const auto joint = joint_of(canopen::identifier::node_of(frame.identifier));
  const auto state = canopen::decode_state(frame);
  if (!joint || !state || !present_) {
    return;  // frames of state 0 are sent before SYNC 0
  }
  // The tick nearest to the present one whose frames have this label. This host may have missed some SYNCs.
  const auto behind = static_cast<std::int8_t>(static_cast<std::uint8_t>(*present_ + 1U) - state->label());
  const std::uint32_t tick = *present_ - static_cast<std::uint32_t>(std::int32_t{behind});
  constexpr int most = 16;
  if (behind < -most || behind > most || tick < next_ || tick >= next_ + kept) {
    return;
  }
  slot(tick).frames[*joint][channel] = state;
}

bool RobotDrive::is_complete(const TickFrames& frames) const {
  for (std::size_t joint = 0; joint < nodes_.size(); ++joint) {
    for (unsigned channel = 0; channel < channels_[joint]; ++channel) {
      if (!frames.frames[joint].at(channel)) {
        return false;
      }
    }
  }
  return true;
}

std::optional<TickFrames> RobotDrive::take_tick(bool at_end) {
  if (!present_ || *present_ + 1U <= next_) {
    return std::nullopt;
  }
  TickFrames& oldest = slot(next_);
  if (!at_end && *present_ < next_ + wait_ticks && !is_complete(oldest)) {
    return std::nullopt;
  }
  TickFrames taken = oldest;
  std::ranges::fill(oldest.frames, std::array<std::optional<StateFrame>, 2>{});
  oldest.tick = next_ + kept;
  ++next_;
  return taken;
}

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
