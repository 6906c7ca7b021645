#include "shared/kernel/kernel.hpp"

#include "shared/fixed/arithmetic.hpp"

namespace proleg {
namespace {

bool broadcasts(const Slot& slot) { return slot.algorithm != nullptr && !slot.algorithm->declaration().frame.empty(); }

}  // namespace

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
  const std::uint64_t all_joints = JointMask::first(configuration.joint_count).bits();
  std::array<JointMask, max_slots> second_channel;
  std::uint64_t one_broadcast = 0;
  std::uint64_t two_broadcasts = 0;
  unsigned slots_in_use = 0;
  for (unsigned i = 0; i < max_slots; ++i) {
    const Slot& slot = configuration.slots[i];
    if (slot.algorithm != nullptr) {
      slots_in_use = i + 1;
    }
    if ((slot.group.bits() & ~all_joints) != 0) {
      return Status::bad_group;
    }
    if (broadcasts(slot)) {
      if ((slot.group.bits() & two_broadcasts) != 0) {
        return Status::too_many_broadcasts;
      }
      second_channel[i] = JointMask(slot.group.bits() & one_broadcast);
      two_broadcasts |= second_channel[i].bits();
      one_broadcast |= slot.group.bits();
    }
  }

  configuration_ = configuration;
  first_joint_ = first_joint;
  second_channel_ = second_channel;
  slots_in_use_ = slots_in_use;
  broadcasters_ = {JointMask(one_broadcast), JointMask(two_broadcasts)};
  for (unsigned i = 0; i < memory_.size(); ++i) {
    set_up(first_joint + i);
  }
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
    slot_memory.place = {static_cast<std::uint8_t>(joint), configuration_.joint_count, slot.group,
                         configuration_.tick_period_us};
    slot_memory.channel = second_channel_[i].contains(joint) ? 1 : 0;
    if (broadcasts(slot)) {
      slot_memory.broadcast = &slot.algorithm->declaration();
      slot_memory.ahead = neighbour(i, slot.group.before(joint));
      slot_memory.behind = neighbour(i, slot.group.after(joint));
    }
    const std::span<const Parameter> parameters = slot.algorithm->declaration().parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      slot_memory.parameters[p] = parameters[p].default_value;
      slot_memory.staged[p] = parameters[p].default_value;
    }
    derive(i, slot_memory);
  }
}

Neighbour Kernel::neighbour(unsigned slot, int joint) const {
  if (joint < 0) {
    return {};
  }
  const auto index = static_cast<unsigned>(joint);
  const unsigned channel = second_channel_[slot].contains(index) ? 1 : 0;
  return {configuration_.slots[slot].algorithm->declaration(), index, heard_[channel][index]};
}

void Kernel::derive(unsigned slot, SlotMemory& memory) {
  configuration_.slots[slot].algorithm->derive(memory.place, memory.parameters.data(), memory.derived.data());
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

Status Kernel::check_parameter(unsigned slot, unsigned joint, unsigned parameter, std::int32_t value) const {
  if (slot >= max_slots || configuration_.slots[slot].algorithm == nullptr) {
    return Status::unknown_slot;
  }
  if (!drives(slot, joint)) {
    return Status::unknown_joint;
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
  if (committed_) {
    return Status::staging_closed;
  }
  if (staged_ && transaction != transaction_) {
    for (JointMemory& memory : memory_) {
      for (SlotMemory& slot_memory : memory.slots) {
        slot_memory.staged_mask = 0;
      }
    }
  }
  SlotMemory& memory = joint_memory(joint).slots[slot];
  memory.staged[parameter] = value;
  memory.staged_mask |= 1U << parameter;
  transaction_ = transaction;
  staged_ = true;
  return Status::ok;
}

Status Kernel::commit(std::uint16_t transaction, std::uint32_t tick) {
  // A commit is broadcast several times; repeating the accepted one is fine.
  if (committed_ && transaction == transaction_ && tick == commit_tick_) {
    return Status::ok;
  }
  if (committed_) {
    return Status::staging_closed;
  }
  if (!staged_ || transaction != transaction_) {
    return Status::nothing_staged;
  }
  if (tick < tick_) {
    return Status::commit_in_the_past;
  }
  commit_tick_ = tick;
  committed_ = true;
  return Status::ok;
}

void Kernel::apply_commit() {
  for (JointMemory& joint : memory_) {
    for (unsigned i = 0; i < max_slots; ++i) {
      SlotMemory& slot = joint.slots[i];
      if (slot.staged_mask == 0) {
        continue;
      }
      for (unsigned p = 0; p < max_parameters; ++p) {
        if (((slot.staged_mask >> p) & 1U) != 0) {
          slot.parameters[p] = slot.staged[p];
        }
      }
      slot.staged_mask = 0;
      derive(i, slot);
    }
  }
  close_transaction();
}

void Kernel::close_transaction() {
  // Nothing of it stays, so that equal states have equal snapshots.
  staged_ = false;
  committed_ = false;
  transaction_ = 0;
  commit_tick_ = 0;
}

Status Kernel::distort(unsigned slot, unsigned joint, unsigned internal_value, std::int32_t value) {
  if (slot >= max_slots || configuration_.slots[slot].algorithm == nullptr) {
    return Status::unknown_slot;
  }
  if (!drives(slot, joint)) {
    return Status::unknown_joint;
  }
  if (internal_value >= configuration_.slots[slot].algorithm->declaration().internal_values.size()) {
    return Status::unknown_internal_value;
  }
  current(joint_memory(joint).slots[slot])[internal_value] = value;
  return Status::ok;
}

void Kernel::set_contacts(unsigned joint, std::uint8_t contacts) {
  if (is_local(joint)) {
    joint_memory(joint).contacts = contacts & StateFrame::contact_bits;
  }
}

void Kernel::reset() {
  tick_ = 0;
  missed_frames_ = 0;
  close_transaction();
  arrived_ = {};
  heard_ = {};
  for (unsigned i = 0; i < memory_.size(); ++i) {
    const unsigned joint = first_joint_ + i;
    JointMemory& memory = memory_[i];
    memory.contacts = 0;
    for (unsigned s = 0; s < max_slots; ++s) {
      SlotMemory& slot = memory.slots[s];
      slot.values = {};
      slot.staged_mask = 0;
      if (slot.active) {
        // Slots of one joint draw from different streams, too.
        Pcg32 noise(configuration_.seed, joint * max_slots + s);
        configuration_.slots[s].algorithm->reset(slot.place, tuning(slot), noise, current(slot).data());
      }
    }
    update_setpoint(memory);
    memory.previous_setpoint = memory.setpoint;
    pack_frames(joint);
  }
}

void Kernel::advance() {
  if (committed_ && commit_tick_ == tick_) {
    apply_commit();
  }
  const std::uint64_t unheard =
      (broadcasters_[0].bits() & ~arrived_[0].bits()) | (broadcasters_[1].bits() & ~arrived_[1].bits());
  if (unheard != 0) {
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
}

void Kernel::compute_next_state(JointMemory& joint) {
  const Contacts contacts({heard_[0].data(), configuration_.joint_count});
  for (unsigned s = 0; s < slots_in_use_; ++s) {
    SlotMemory& slot = joint.slots[s];
    if (slot.active) {
      const Surroundings surroundings{tick_, slot.place, slot.ahead, slot.behind, contacts};
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
  if (sum < joint.lower_limit) {
    sum = joint.lower_limit;
  }
  if (sum > joint.upper_limit) {
    sum = joint.upper_limit;
  }
  joint.setpoint = sum;
}

void Kernel::pack_frames(unsigned joint) {
  const JointMemory& memory = joint_memory(joint);
  auto flags = static_cast<std::uint8_t>(memory.contacts | StateFrame::valid);
  if (memory.limited) {
    flags |= StateFrame::limited;
  }
  const unsigned channels = channel_count(joint);
  for (unsigned channel = 0; channel < channels; ++channel) {
    StateFrame& frame = heard_[channel][joint];
    frame.bytes[6] = flags;
    frame.bytes[7] = static_cast<std::uint8_t>(tick_);
    arrived_[channel].insert(joint);
  }
  for (unsigned s = 0; s < slots_in_use_; ++s) {
    const SlotMemory& slot = memory.slots[s];
    if (slot.broadcast != nullptr) {
      pack(*slot.broadcast, current(slot).data(), heard_[slot.channel][joint]);
    }
  }
}

bool Kernel::receive(unsigned joint, unsigned channel, const StateFrame& frame) {
  if (joint >= configuration_.joint_count || channel >= max_channels || is_local(joint) ||
      frame.label() != static_cast<std::uint8_t>(tick_) || (frame.flags() & StateFrame::valid) == 0) {
    return false;
  }
  heard_[channel][joint] = frame;
  arrived_[channel].insert(joint);
  return true;
}

void Kernel::fill_missed_frames() {
  for (unsigned s = 0; s < slots_in_use_; ++s) {
    const Slot& slot = configuration_.slots[s];
    if (!broadcasts(slot)) {
      continue;
    }
    const std::uint64_t second = second_channel_[s].bits();
    const std::uint64_t arrived = (arrived_[0].bits() & ~second) | (arrived_[1].bits() & second);
    const std::uint64_t missing = slot.group.bits() & ~arrived;
    // A kernel of several joints hears with one ear: the first of them in the slot extrapolates.
    const int local = slot.group.from(first_joint_);
    if (missing == 0 || local < 0 || !drives(s, static_cast<unsigned>(local))) {
      continue;
    }
    const SlotMemory& memory = joint_memory(static_cast<unsigned>(local)).slots[s];
    for (int joint = JointMask(missing).from(0); joint >= 0;
         joint = JointMask(missing).after(static_cast<unsigned>(joint))) {
      const auto index = static_cast<unsigned>(joint);
      StateFrame& frame = heard_[second_channel_[s].contains(index) ? 1 : 0][index];
      ++missed_frames_;
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
