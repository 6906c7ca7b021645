#include "shared/gait/declaration.hpp"
#include "shared/kernel/kernel.hpp"

// How the kernel gets its values: the configuration before the first tick; then changes of parameters and internal
// values, which are checked, staged, and take effect at the tick of their commit.

namespace proleg {

JointMask KernelConfiguration::second_channel(unsigned slot) const {
  if (!slots[slot].broadcasts()) {
    return {};
  }
  JointMask earlier;
  for (unsigned i = 0; i < slot; ++i) {
    earlier |= slots[i].broadcasts() ? slots[i].group : JointMask();
  }
  return slots[slot].group & earlier;
}

JointMask KernelConfiguration::second_channel_senders() const {
  JointMask senders;
  for (unsigned i = 0; i < max_slots; ++i) {
    senders |= second_channel(i);
  }
  return senders;
}

Status Kernel::configure(const KernelConfiguration& configuration, unsigned first_joint) {
  if (configuration.joint_count == 0 || configuration.joint_count > max_joints) {
    return Status::bad_joint_count;
  }
  if (memory_.empty() || memory_.size() > configuration.joint_count ||
      first_joint > configuration.joint_count - memory_.size()) {
    return Status::bad_local_joints;
  }
  if (configuration.tick_period_us < 1'000 || configuration.tick_period_us > 100'000) {
    return Status::bad_tick_period;
  }
  const JointMask all_joints = JointMask::first(configuration.joint_count);
  std::array<JointMask, max_slots> second_channel;
  JointMask two_broadcasts;
  unsigned slots_in_use = 0;
  for (unsigned i = 0; i < max_slots; ++i) {
    const Slot& slot = configuration.slots[i];
    if (slot.algorithm != nullptr) {
      slots_in_use = i + 1;
    }
    if (!(slot.group - all_joints).empty()) {
      return Status::bad_group;
    }
    if (slot.broadcasts()) {
      if (!(slot.group & two_broadcasts).empty()) {
        return Status::too_many_broadcasts;
      }
      second_channel[i] = configuration.second_channel(i);
      two_broadcasts |= second_channel[i];
    }
  }

  configuration_ = configuration;
  first_joint_ = first_joint;
  second_channel_ = second_channel;
  slots_in_use_ = slots_in_use;
  senders_ = {all_joints, two_broadcasts};
  needed_ = {};
  beside_ = {};
  for (unsigned i = 0; i < memory_.size(); ++i) {
    set_up(first_joint + i);
    // This loop is not part of set_up(), so that the two do not need stack at the same time.
    for (unsigned s = 0; s < slots_in_use; ++s) {
      SlotMemory& slot_memory = memory_[i].slots[s];
      if (slot_memory.active) {
        const std::span<const Parameter> parameters = configuration_.slots[s].algorithm->declaration().parameters;
        for (std::size_t p = 0; p < parameters.size(); ++p) {
          slot_memory.parameters[p] = parameters[p].default_value;
        }
        derive(s, slot_memory);
      }
    }
  }
  staging_.clear(memory_);
  flags_ = 0;
  reset();
  return Status::ok;
}

void Kernel::set_up(unsigned joint) {
  JointMemory& memory = joint_memory(joint);
  memory = JointMemory{};
  memory.lower_limit = -quarter_turn;
  memory.upper_limit = quarter_turn;
  for (unsigned i = 0; i < max_slots; ++i) {
    const Slot& slot = configuration_.slots[i];
    SlotMemory& slot_memory = memory.slots[i];
    slot_memory.active = slot.algorithm != nullptr && slot.group.contains(joint);
    if (!slot_memory.active) {
      continue;
    }
    slot_memory.context = {static_cast<std::uint8_t>(joint), configuration_.joint_count, slot.group,
                           configuration_.tick_period_us};
    slot_memory.channel = second_channel_[i].contains(joint) ? 1 : 0;
    slot_memory.sensed_joints = slot.algorithm->senses_contacts() ? configuration_.joint_count : std::uint8_t{0};
    memory.needed_readings = static_cast<std::uint8_t>(memory.needed_readings | slot.algorithm->senses_readings());
    note_needed_frames(i, joint);
    if (slot.broadcasts()) {
      slot_memory.broadcast = &slot.algorithm->declaration();
      slot_memory.ahead = neighbour(i, slot.group.before(joint));
      slot_memory.behind = neighbour(i, slot.group.after(joint));
    }
  }
}

/// Notes the frames of other joints that a slot on a local joint needs.
void Kernel::note_needed_frames(unsigned slot, unsigned joint) {
  const Slot& driving = configuration_.slots[slot];
  if (driving.algorithm->senses_contacts()) {
    needed_[0] = JointMask::first(configuration_.joint_count);
  }
  if (!driving.broadcasts()) {
    return;
  }
  for (const int other : {driving.group.before(joint), driving.group.after(joint)}) {
    if (other >= 0 && !is_local(static_cast<unsigned>(other))) {
      const auto index = static_cast<unsigned>(other);
      beside_[slot].insert(index);
      needed_[second_channel_[slot].contains(index) ? 1 : 0].insert(index);
    }
  }
}

Neighbour Kernel::neighbour(unsigned slot, int joint) const {
  if (joint < 0) {
    return {};
  }
  const auto index = static_cast<unsigned>(joint);
  const unsigned channel = second_channel_[slot].contains(index) ? 1 : 0;
  return {configuration_.slots[slot].algorithm->declaration(), index, frames_[channel][index]};
}

void Kernel::derive(unsigned slot, SlotMemory& memory) {
  configuration_.slots[slot].algorithm->derive(memory.context, memory.parameters.data(), memory.derived.data());
}

Status Kernel::set_limits(unsigned joint, std::int32_t lower, std::int32_t upper) {
  if (!is_local(joint)) {
    return Status::unknown_joint;
  }
  if (lower > upper) {
    return Status::bad_limits;
  }
  joint_memory(joint).lower_limit = lower;
  joint_memory(joint).upper_limit = upper;
  return Status::ok;
}

bool Kernel::drives(unsigned slot, unsigned joint) const {
  return slot < max_slots && is_local(joint) && joint_memory(joint).slots[slot].active;
}

Status Kernel::check_slot(unsigned slot, unsigned joint) const {
  if (slot >= max_slots || configuration_.slots[slot].algorithm == nullptr) {
    return Status::unknown_slot;
  }
  return drives(slot, joint) ? Status::ok : Status::unknown_joint;
}

Status Kernel::check_parameter(unsigned slot, unsigned joint, unsigned parameter, std::int32_t value) const {
  if (const Status status = check_slot(slot, joint); status != Status::ok) {
    return status;
  }
  const std::span<const Parameter> parameters = configuration_.slots[slot].algorithm->declaration().parameters;
  if (parameter >= parameters.size()) {
    return Status::unknown_parameter;
  }
  if (value < parameters[parameter].minimum || value > parameters[parameter].maximum) {
    return Status::out_of_range;
  }
  return Status::ok;
}

Status Kernel::set_parameter(unsigned slot, unsigned joint, unsigned parameter, std::int32_t value) {
  if (const Status status = check_parameter(slot, joint, parameter, value); status != Status::ok) {
    return status;
  }
  SlotMemory& memory = joint_memory(joint).slots[slot];
  memory.parameters[parameter] = value;
  derive(slot, memory);
  return Status::ok;
}

Status Kernel::stage(std::uint16_t transaction, unsigned slot, unsigned joint, unsigned parameter, std::int32_t value) {
  if (const Status status = check_parameter(slot, joint, parameter, value); status != Status::ok) {
    return status;
  }
  return staging_.add(memory_, transaction, joint - first_joint_,
                      {value, 0, static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(parameter), false});
}

Status Kernel::stage_internal(std::uint16_t transaction, unsigned slot, unsigned joint, unsigned internal_value,
                              std::int32_t value) {
  if (const Status status = check_slot(slot, joint); status != Status::ok) {
    return status;
  }
  if (internal_value >= configuration_.slots[slot].algorithm->declaration().internal_values.size()) {
    return Status::unknown_internal_value;
  }
  return staging_.add(memory_, transaction, joint - first_joint_,
                      {value, 0, static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(internal_value), true});
}

Status Kernel::commit(std::uint16_t transaction, std::uint32_t tick) {
  return staging_.commit(transaction, tick, tick_);
}

bool Kernel::staged_value(unsigned slot, unsigned joint, unsigned number, bool internal, std::int32_t& value) const {
  if (!is_local(joint)) {
    return false;
  }
  const StagedValue* staged = staging_.find_open(joint_memory(joint), slot, number, internal);
  if (staged == nullptr) {
    return false;
  }
  value = staged->value;
  return true;
}

void Kernel::apply_commits() {
  while (const std::optional<Staging::Due> due = staging_.next_due(tick_)) {
    // Only join() leaves commits for earlier ticks. Their internal values belong to states that are not computed any
    // more.
    const bool with_internal_values = due->tick == tick_;
    for (JointMemory& joint : memory_) {
      std::uint32_t changed_slots = 0;
      staging_.take_values(*due, joint, [&](const StagedValue& staged) {
        SlotMemory& slot = joint.slots[staged.slot];
        if (!staged.internal) {
          slot.parameters[staged.number] = staged.value;
          changed_slots |= 1U << staged.slot;
        } else if (with_internal_values) {
          current(slot)[staged.number] = staged.value;
        }
      });
      for (unsigned s = 0; s < max_slots; ++s) {
        if (((changed_slots >> s) & 1U) != 0) {
          derive(s, joint.slots[s]);
        }
      }
    }
    staging_.finish(*due);
  }
}

}  // namespace proleg
