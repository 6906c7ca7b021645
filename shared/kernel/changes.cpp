#include "shared/kernel/kernel.hpp"

// Parameters and internal values from outside: checked, staged, and in force from the tick of their commit.

namespace proleg {

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

}  // namespace proleg
