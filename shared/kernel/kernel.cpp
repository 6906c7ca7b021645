#include "shared/kernel/kernel.hpp"

#include <algorithm>

#include "shared/fixed/arithmetic.hpp"

// The part of the kernel that computes a tick.

namespace proleg {

void Kernel::set_contacts(unsigned joint, std::uint8_t contacts) {
  if (is_local(joint)) {
    // Only the head's frame has room for the link in front of its joint.
    const unsigned bits = joint == 0 ? StateFrame::contact_bits : StateFrame::rear_link_contact_bits;
    joint_memory(joint).contacts = static_cast<std::uint8_t>(contacts & bits);
  }
}

void Kernel::set_readings(unsigned joint, const JointReadings& readings) {
  if (is_local(joint)) {
    JointMemory& memory = joint_memory(joint);
    memory.readings = readings.only(memory.needed_readings);
  }
}

void Kernel::reset() {
  tick_ = 0;
  missed_frames_ = 0;
  joining_ = false;
  arrived_ = {};
  frames_ = {};
  for (unsigned i = 0; i < memory_.size(); ++i) {
    const unsigned joint = first_joint_ + i;
    JointMemory& memory = memory_[i];
    memory.contacts = 0;
    memory.readings = {};
    for (unsigned s = 0; s < max_slots; ++s) {
      SlotMemory& slot = memory.slots[s];
      slot.values = {};
      if (slot.active) {
        // Slots of the same joint draw from different streams, too.
        Pcg32 noise(configuration_.seed, joint * max_slots + s);
        configuration_.slots[s].algorithm->reset(slot.context, tuning(slot), noise, current(slot).data());
      }
    }
    update_setpoint(memory);
    memory.previous_setpoint = memory.setpoint;
    pack_frames(joint);
  }
}

void Kernel::advance() {
  if (staging_.has_commits()) {
    apply_commits();
  }
  const bool joining = joining_;
  if (joining) {
    rejoin();
  }
  const JointMask missing_first = needed_[0] - arrived_[0];
  const JointMask missing_second = needed_[1] - arrived_[1];
  if (!(missing_first | missing_second).empty()) {
    missed_frames_ += missing_first.size() + missing_second.size();
    fill_missed_frames();
  }
  for (JointMemory& joint : memory_) {
    compute_next_state(joint);
  }
  ++tick_;
  arrived_ = {};
  for (unsigned i = 0; i < memory_.size(); ++i) {
    memory_[i].previous_setpoint = memory_[i].setpoint;
    update_setpoint(memory_[i]);
    pack_frames(first_joint_ + i);
  }
  if (joining) {
    flags_ = static_cast<std::uint8_t>(flags_ & ~StateFrame::holdover);
  }
}

void Kernel::join(std::uint32_t tick) {
  tick_ = tick;
  arrived_ = {};
  frames_ = {};
  joining_ = true;
  for (unsigned i = 0; i < memory_.size(); ++i) {
    JointMemory& joint = memory_[i];
    joint.contacts = 0;
    joint.readings = {};
    joint.limited = false;
    for (unsigned s = 0; s < max_slots; ++s) {
      SlotMemory& slot = joint.slots[s];
      slot.values = {};
      if (slot.active) {
        Pcg32 noise(configuration_.seed, (first_joint_ + i) * max_slots + s);
        configuration_.slots[s].algorithm->reset(slot.context, tuning(slot), noise, current(slot).data());
      }
    }
  }
}

/// Computes state tick_ from the neighbours' frames instead of from state tick_ - 1.
void Kernel::rejoin() {
  joining_ = false;
  flags_ = static_cast<std::uint8_t>(flags_ | StateFrame::holdover);
  for (JointMemory& joint : memory_) {
    for (unsigned s = 0; s < slots_in_use_; ++s) {
      SlotMemory& slot = joint.slots[s];
      if (slot.active) {
        const Contacts contacts({frames_[0].data(), slot.sensed_joints});
        const Surroundings surroundings{tick_,    slot.context,   slot.ahead,    slot.behind,
                                        contacts, joint.setpoint, joint.readings};
        configuration_.slots[s].algorithm->rejoin(surroundings, tuning(slot), current(slot).data());
      }
    }
    update_setpoint(joint);
  }
}

void Kernel::set_flags(std::uint8_t flags) {
  flags_ = static_cast<std::uint8_t>(flags & (StateFrame::fault | StateFrame::holdover));
}

void Kernel::compute_next_state(JointMemory& joint) {
  for (unsigned s = 0; s < slots_in_use_; ++s) {
    SlotMemory& slot = joint.slots[s];
    if (slot.active) {
      const Contacts contacts({frames_[0].data(), slot.sensed_joints});
      const Surroundings surroundings{tick_,    slot.context,   slot.ahead,    slot.behind,
                                      contacts, joint.setpoint, joint.readings};
      configuration_.slots[s].algorithm->advance(surroundings, tuning(slot), slot.values[tick_ & 1U].data(),
                                                 slot.values[(tick_ + 1) & 1U].data());
    }
  }
}

void Kernel::update_setpoint(JointMemory& joint) {
  std::int32_t sum = 0;
  for (unsigned s = 0; s < slots_in_use_; ++s) {
    SlotMemory& slot = joint.slots[s];
    if (slot.active) {
      sum = add_saturating(sum, configuration_.slots[s].algorithm->output(tuning(slot), current(slot).data()));
    }
  }
  joint.limited = sum < joint.lower_limit || sum > joint.upper_limit;
  joint.setpoint = std::clamp(sum, joint.lower_limit, joint.upper_limit);
}

void Kernel::pack_frames(unsigned joint) {
  const JointMemory& memory = joint_memory(joint);
  auto flags = static_cast<std::uint8_t>(memory.contacts | flags_ | StateFrame::valid);
  if (memory.limited) {
    flags |= StateFrame::limited;
  }
  const unsigned channels = channel_count(joint);
  for (unsigned channel = 0; channel < channels; ++channel) {
    StateFrame& frame = frames_[channel][joint];
    frame.bytes[6] = flags;
    frame.bytes[7] = static_cast<std::uint8_t>(tick_);
    arrived_[channel].insert(joint);
  }
  for (unsigned s = 0; s < slots_in_use_; ++s) {
    const SlotMemory& slot = memory.slots[s];
    if (slot.broadcast != nullptr) {
      pack(*slot.broadcast, current(slot).data(), frames_[slot.channel][joint]);
    }
  }
}

bool Kernel::receive(unsigned joint, unsigned channel, const StateFrame& frame) {
  if (joint >= configuration_.joint_count || channel >= max_channels || is_local(joint) ||
      frame.label() != static_cast<std::uint8_t>(tick_) || (frame.flags() & StateFrame::valid) == 0) {
    return false;
  }
  frames_[channel][joint] = frame;
  arrived_[channel].insert(joint);
  return true;
}

void Kernel::fill_missed_frames() {
  for (unsigned s = 0; s < slots_in_use_; ++s) {
    const Slot& slot = configuration_.slots[s];
    if (!slot.broadcasts()) {
      continue;
    }
    const JointMask second = second_channel_[s];
    const JointMask arrived = (arrived_[0] - second) | (arrived_[1] & second);
    const JointMask missing = beside_[s] - arrived;  // a slot without sensing needs no frames but these
    // The local joints of a slot share the frame of a neighbour, so only the first of them extrapolates it.
    const int local = slot.group.from(first_joint_);
    if (missing.empty() || local < 0 || !drives(s, static_cast<unsigned>(local))) {
      continue;
    }
    const SlotMemory& memory = joint_memory(static_cast<unsigned>(local)).slots[s];
    for (const unsigned joint : missing) {
      StateFrame& frame = frames_[second.contains(joint) ? 1 : 0][joint];
      if ((frame.flags() & StateFrame::valid) != 0) {
        slot.algorithm->extrapolate(tuning(memory), current(memory).data(), frame);
      }
    }
  }
}

std::int32_t Kernel::parameter(unsigned slot, unsigned joint, unsigned parameter) const {
  return joint_memory(joint).slots[slot].parameters[parameter];
}

std::int32_t Kernel::internal_value(unsigned slot, unsigned joint, unsigned internal_value) const {
  return current(joint_memory(joint).slots[slot])[internal_value];
}

}  // namespace proleg
