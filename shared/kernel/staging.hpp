#pragma once

// Changes of parameters and internal values while the robot moves, in two phases: values are staged under a transaction
// number, then the transaction is committed for a tick. One transaction is open at a time; committed ones wait for
// their ticks, in the order of their commits.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/kernel/joint_memory.hpp"
#include "shared/kernel/status.hpp"

namespace proleg {

/// Greatest number of transactions that are committed and wait for their ticks. A ramp is a series of transactions,
/// each sent 20 ticks ahead.
inline constexpr std::size_t max_transactions = 32;

/// Keeps the transactions. The staged values are in the memory of the joints, which the kernel passes to each function.
class Staging {
 public:
  using Joints = std::span<JointMemory>;

  /// Drops all values and transactions.
  void clear(Joints joints);

  /// Opens a transaction and drops the one that was open. Opening the open transaction again changes nothing.
  Status open(Joints joints, std::uint16_t transaction);
  /// Adds a value of a joint, and opens the transaction if it is not open. A second value for the same parameter or
  /// internal value replaces the first. joint: position in the memory.
  Status add(Joints joints, std::uint16_t transaction, unsigned joint, const StagedValue& value);
  /// Closes the open transaction, so that it waits for `tick`. now: the tick that is computed next. Repeating a commit,
  /// also the last one that took effect, is ok.
  Status commit(std::uint16_t transaction, std::uint32_t tick, std::uint32_t now);

  [[nodiscard]] bool has_open_transaction() const { return has_open_; }
  /// Number of the open transaction; 0 if none is open.
  [[nodiscard]] std::uint16_t open_transaction() const { return open_; }
  /// Number of values of the open transaction.
  [[nodiscard]] unsigned open_count(std::span<const JointMemory> joints) const;
  /// The value of the open transaction for this parameter or internal value; null if it has none.
  [[nodiscard]] const StagedValue* find_open(const JointMemory& joint, unsigned slot, unsigned number,
                                             bool internal) const;

  [[nodiscard]] bool has_commits() const { return committed_count_ != 0; }
  struct Due {
    std::uint8_t position;  ///< in the list of committed transactions
    std::uint32_t tick;
  };
  /// The committed transaction that takes effect next, if its tick is `now` or earlier: the one with the earliest tick;
  /// of several with this tick the one that was committed first.
  [[nodiscard]] std::optional<Due> next_due(std::uint32_t now) const;
  /// Calls apply(value) for the joint's values of a due transaction, in the order in which they were staged, and
  /// removes them. To be called once for each joint, then finish().
  template <typename Apply>
  void take_values(const Due& due, JointMemory& joint, Apply&& apply);
  /// Removes a due transaction from the list.
  void finish(const Due& due);

 private:
  friend class KernelSnapshot;  // it belongs to the tests

  struct Commit {
    std::uint16_t transaction;
    std::uint32_t tick;
  };

  [[nodiscard]] const Commit* find_commit(std::uint16_t transaction) const;
  /// Position of a value of the open transaction; staged.count if it has none.
  [[nodiscard]] unsigned find_value(const StagedValues& staged, unsigned slot, unsigned number, bool internal) const;
  void drop_open_transaction(Joints joints);

  /// The committed transactions in the order of their commits. A StagedValue refers to a position in this list; the
  /// open transaction has the position committed_count_.
  std::array<Commit, max_transactions> transactions_{};
  std::uint8_t committed_count_ = 0;
  bool has_open_ = false;
  std::uint16_t open_ = 0;
  Commit last_effective_{};  ///< kept so that repeats of this commit are recognised
  bool has_last_effective_ = false;
};

template <typename Apply>
void Staging::take_values(const Due& due, JointMemory& joint, Apply&& apply) {
  StagedValues& staged = joint.staged;
  unsigned kept = 0;
  for (unsigned i = 0; i < staged.count; ++i) {
    StagedValue value = staged.values[i];
    if (value.transaction == due.position) {
      apply(value);
      continue;
    }
    if (value.transaction > due.position) {
      --value.transaction;  // finish() moves the later transactions up
    }
    staged.values[kept++] = value;
  }
  staged.count = static_cast<std::uint8_t>(kept);
}

}  // namespace proleg
