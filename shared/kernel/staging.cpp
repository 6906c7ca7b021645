#include "shared/kernel/staging.hpp"

namespace proleg {

void Staging::clear(Joints joints) {
  for (JointMemory& joint : joints) {
    joint.staged.count = 0;
  }
  transactions_ = {};
  committed_count_ = 0;
  has_open_ = false;
  open_ = 0;
  last_effective_ = {};
  has_last_effective_ = false;
}

const Staging::Commit* Staging::find_commit(std::uint16_t transaction) const {
  for (unsigned i = 0; i < committed_count_; ++i) {
    if (transactions_[i].transaction == transaction) {
      return &transactions_[i];
    }
  }
  return nullptr;
}

Status Staging::open(Joints joints, std::uint16_t transaction) {
  if (find_commit(transaction) != nullptr) {
    return Status::staging_closed;
  }
  if (has_open_ && open_ == transaction) {
    return Status::ok;
  }
  if (committed_count_ == max_transactions) {
    return Status::staging_full;
  }
  drop_open_transaction(joints);
  open_ = transaction;
  has_open_ = true;
  return Status::ok;
}

void Staging::drop_open_transaction(Joints joints) {
  for (JointMemory& joint : joints) {
    StagedValues& staged = joint.staged;
    unsigned kept = 0;
    for (unsigned i = 0; i < staged.count; ++i) {
      if (staged.values[i].transaction != committed_count_) {
        staged.values[kept++] = staged.values[i];
      }
    }
    staged.count = static_cast<std::uint8_t>(kept);
  }
  has_open_ = false;
  open_ = 0;
}

Status Staging::add(Joints joints, std::uint16_t transaction, unsigned joint, const StagedValue& value) {
  if (find_commit(transaction) != nullptr) {
    return Status::staging_closed;
  }
  StagedValues& staged = joints[joint].staged;
  if (has_open_ && open_ == transaction) {
    const unsigned earlier = find_value(staged, value.slot, value.number, value.internal);
    if (earlier < staged.count) {
      staged.values[earlier].value = value.value;
      return Status::ok;
    }
  }
  // This check comes before open() drops the open transaction, so that a rejected value changes nothing.
  if (staged.count == max_staged_values) {
    return Status::staging_full;
  }
  if (const Status status = open(joints, transaction); status != Status::ok) {
    return status;
  }
  staged.values[staged.count] = value;
  staged.values[staged.count].transaction = committed_count_;
  ++staged.count;
  return Status::ok;
}

Status Staging::commit(std::uint16_t transaction, std::uint32_t tick, std::uint32_t now) {
  // A commit is broadcast several times, so repeating an accepted one is no error.
  if (const Commit* commit = find_commit(transaction)) {
    return commit->tick == tick ? Status::ok : Status::staging_closed;
  }
  if (!has_open_ || transaction != open_) {
    const bool took_effect =
        has_last_effective_ && last_effective_.transaction == transaction && last_effective_.tick == tick;
    return took_effect ? Status::ok : Status::nothing_staged;
  }
  if (tick < now) {
    return Status::commit_in_the_past;
  }
  transactions_[committed_count_] = {transaction, tick};
  ++committed_count_;
  has_open_ = false;
  open_ = 0;
  return Status::ok;
}

unsigned Staging::open_count(std::span<const JointMemory> joints) const {
  unsigned count = 0;
  for (const JointMemory& joint : joints) {
    for (unsigned i = 0; has_open_ && i < joint.staged.count; ++i) {
      count += joint.staged.values[i].transaction == committed_count_ ? 1U : 0U;
    }
  }
  return count;
}

unsigned Staging::find_value(const StagedValues& staged, unsigned slot, unsigned number, bool internal) const {
  for (unsigned i = 0; i < staged.count; ++i) {
    const StagedValue& value = staged.values[i];
    if (value.transaction == committed_count_ && value.slot == slot && value.number == number &&
        value.internal == internal) {
      return i;
    }
  }
  return staged.count;
}

const StagedValue* Staging::find_open(const JointMemory& joint, unsigned slot, unsigned number, bool internal) const {
  if (!has_open_) {
    return nullptr;
  }
  const unsigned position = find_value(joint.staged, slot, number, internal);
  return position < joint.staged.count ? &joint.staged.values[position] : nullptr;
}

std::optional<Staging::Due> Staging::next_due(std::uint32_t now) const {
  std::optional<Due> due;
  for (std::uint8_t i = 0; i < committed_count_; ++i) {
    const std::uint32_t tick = transactions_[i].tick;
    if (tick <= now && (!due || tick < due->tick)) {
      due = Due{i, tick};
    }
  }
  return due;
}

void Staging::finish(const Due& due) {
  last_effective_ = transactions_[due.position];
  has_last_effective_ = true;
  --committed_count_;
  for (unsigned i = due.position; i < committed_count_; ++i) {
    transactions_[i] = transactions_[i + 1];
  }
  transactions_[committed_count_] = {};
}

}  // namespace proleg
