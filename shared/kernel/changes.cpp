#include "shared/kernel/kernel.hpp"

// Changes of parameters and internal values: they are checked, staged, and take effect at the tick of their commit.

namespace proleg {

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
