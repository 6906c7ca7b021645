#include "shared/kernel/kernel.hpp"

// Parameters and internal values from outside: checked, staged, and in force from the tick of their commit.

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

bool Kernel::is_committed(std::uint16_t transaction) const {
  for (unsigned i = 0; i < committed_count_; ++i) {
    if (transactions_[i].transaction == transaction) {
      return true;
    }
  }
  return false;
}

Status Kernel::open(std::uint16_t transaction) {
  if (is_committed(transaction)) {
    return Status::staging_closed;
  }
  if (has_open_ && open_ == transaction) {
    return Status::ok;
  }
  if (committed_count_ == max_transactions) {
    return Status::staging_full;
  }
  drop_open_transaction();
  open_ = transaction;
  has_open_ = true;
  return Status::ok;
}

void Kernel::drop_open_transaction() {
  for (JointMemory& joint : memory_) {
    unsigned kept = 0;
    for (unsigned i = 0; i < joint.staged_count; ++i) {
      if (joint.staged[i].transaction != committed_count_) {
        joint.staged[kept++] = joint.staged[i];
      }
    }
    joint.staged_count = static_cast<std::uint8_t>(kept);
  }
  has_open_ = false;
  open_ = 0;
}

Status Kernel::add_staged(std::uint16_t transaction, unsigned joint, const StagedValue& value) {
  if (is_committed(transaction)) {
    return Status::staging_closed;
  }
  JointMemory& memory = joint_memory(joint);
  if (has_open_ && open_ == transaction) {
    // Of a value that is staged twice the last one counts.
    for (unsigned i = 0; i < memory.staged_count; ++i) {
      StagedValue& staged = memory.staged[i];
      if (staged.transaction == committed_count_ && staged.slot == value.slot && staged.number == value.number &&
          staged.internal == value.internal) {
        staged.value = value.value;
        return Status::ok;
      }
    }
  }
  // Counted before the open transaction is dropped, so that a refusal changes nothing.
  if (memory.staged_count == max_staged_values) {
    return Status::staging_full;
  }
  if (const Status status = open(transaction); status != Status::ok) {
    return status;
  }
  memory.staged[memory.staged_count] = value;
  memory.staged[memory.staged_count].transaction = committed_count_;
  ++memory.staged_count;
  return Status::ok;
}

Status Kernel::stage(std::uint16_t transaction, unsigned slot, unsigned joint, unsigned parameter, std::int32_t value) {
  if (const Status status = check_parameter(slot, joint, parameter, value); status != Status::ok) {
    return status;
  }
  return add_staged(transaction, joint,
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
  return add_staged(transaction, joint,
                    {value, 0, static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(internal_value), true});
}

Status Kernel::commit(std::uint16_t transaction, std::uint32_t tick) {
  // A commit is broadcast several times; repeating an accepted one is fine.
  for (unsigned i = 0; i < committed_count_; ++i) {
    if (transactions_[i].transaction == transaction) {
      return transactions_[i].tick == tick ? Status::ok : Status::staging_closed;
    }
  }
  if (!has_open_ || transaction != open_) {
    const bool took_effect =
        has_last_effective_ && last_effective_.transaction == transaction && last_effective_.tick == tick;
    return took_effect ? Status::ok : Status::nothing_staged;
  }
  if (tick < tick_) {
    return Status::commit_in_the_past;
  }
  if (committed_count_ == max_transactions) {  // only a damaged snapshot leads here
    return Status::staging_full;
  }
  transactions_[committed_count_] = {transaction, tick};
  ++committed_count_;
  has_open_ = false;
  open_ = 0;
  return Status::ok;
}

unsigned Kernel::staged_count() const {
  unsigned count = 0;
  for (const JointMemory& joint : memory_) {
    for (unsigned i = 0; has_open_ && i < joint.staged_count; ++i) {
      count += joint.staged[i].transaction == committed_count_ ? 1U : 0U;
    }
  }
  return count;
}

bool Kernel::staged_value(unsigned slot, unsigned joint, unsigned number, bool internal, std::int32_t& value) const {
  if (!has_open_ || !is_local(joint)) {
    return false;
  }
  const JointMemory& memory = joint_memory(joint);
  for (unsigned i = 0; i < memory.staged_count; ++i) {
    const StagedValue& staged = memory.staged[i];
    if (staged.transaction == committed_count_ && staged.slot == slot && staged.number == number &&
        staged.internal == internal) {
      value = staged.value;
      return true;
    }
  }
  return false;
}

void Kernel::apply_commits() {
  // By tick, then in the order of their commits. After join() those of earlier ticks are caught up with.
  for (;;) {
    unsigned due = max_transactions;
    for (unsigned place = 0; place < committed_count_; ++place) {
      const std::uint32_t tick = transactions_[place].tick;
      if (tick <= tick_ && (due == max_transactions || tick < transactions_[due].tick)) {
        due = place;
      }
    }
    if (due == max_transactions) {
      return;
    }
    take_effect(due, transactions_[due].tick == tick_);
  }
}

/// The values of a committed transaction come into force, and it leaves the list; those behind it move up.
void Kernel::take_effect(unsigned place, bool with_internal_values) {
  for (JointMemory& joint : memory_) {
    unsigned kept = 0;
    std::uint32_t changed_slots = 0;
    for (unsigned i = 0; i < joint.staged_count; ++i) {
      StagedValue staged = joint.staged[i];
      if (staged.transaction == place) {
        SlotMemory& slot = joint.slots[staged.slot];
        if (!staged.internal) {
          slot.parameters[staged.number] = staged.value;
          changed_slots |= 1U << staged.slot;
        } else if (with_internal_values) {
          current(slot)[staged.number] = staged.value;
        }
        continue;
      }
      if (staged.transaction > place) {
        --staged.transaction;
      }
      joint.staged[kept++] = staged;
    }
    joint.staged_count = static_cast<std::uint8_t>(kept);
    for (unsigned s = 0; s < max_slots; ++s) {
      if (((changed_slots >> s) & 1U) != 0) {
        derive(s, joint.slots[s]);
      }
    }
  }
  last_effective_ = transactions_[place];
  has_last_effective_ = true;
  --committed_count_;
  for (unsigned i = place; i < committed_count_; ++i) {
    transactions_[i] = transactions_[i + 1];
  }
  transactions_[committed_count_] = {};
}

}  // namespace proleg
