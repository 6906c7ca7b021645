#pragma once

// The changes that the master makes in flight: which one is next, which wait for their tick, and the SDO writes of
// each.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/computer/master/setup_list.hpp"

namespace proleg::canopen {

/// A parameter, or an internal value (a distortion), of a joint.
struct ChangedValue {
  std::uint8_t slot = 0;
  std::uint8_t joint = 0;   ///< kernel order
  std::uint8_t number = 0;  ///< of the parameter or internal value
  bool internal = false;
  std::int32_t value = 0;
};

/// Values that take effect together. At most max_staged_values of one joint.
struct Change {
  /// As `tick`: the master decides, when all modules have the values. So a slow connection delays the change.
  static constexpr std::uint32_t soon = 0xFFFF'FFFF;

  std::uint32_t tick = 0;
  std::span<const ChangedValue> values;
  bool dropped = false;  ///< set by the master: the change was not made (see Problem)
};

/// Change n travels as transaction n + 1 (modulo 65535), which is opened in every module.
class ChangePlan {
 public:
  /// Committed transactions that a module holds beside the open one.
  static constexpr std::size_t max_pending = max_transactions - 1;

  /// kernel and changes must outlive the plan. Clears `dropped` of all changes from this one on: those before are made.
  ChangePlan(const KernelConfiguration& kernel, std::span<Change> changes, std::size_t next = 0);

  /// More changes: the earlier ones, as they are now, and new ones behind them.
  void extend(std::span<Change> changes) { changes_ = changes; }

  /// The first change from next() on that is not possible: with a value that its joint does not have, more than
  /// max_staged_values of a joint, or a tick not later than that of the change before (any number of changes may be
  /// `soon`, one after the other).
  [[nodiscard]] std::optional<std::size_t> find_bad() const;

  /// The next change to stage; size() if all are committed or dropped.
  [[nodiscard]] std::size_t next() const { return next_; }
  [[nodiscard]] std::size_t size() const { return changes_.size(); }
  [[nodiscard]] const Change& operator[](std::size_t change) const { return changes_[change]; }
  [[nodiscard]] static std::uint16_t transaction(std::size_t change) {
    return static_cast<std::uint16_t>(change % 0xFFFFU + 1U);
  }

  /// Whether there is a next change and the modules have room for it beside the pending ones.
  [[nodiscard]] bool can_stage() const;
  /// Decides the tick of the next change, if it is `soon`: the first one from this on that is later than the change
  /// before.
  void decide_tick(std::uint32_t earliest);
  void commit_next();
  void drop_next();
  /// Notes that committed changes for this tick and earlier ones are in force.
  void pass(std::uint32_t tick);

  /// The n-th write that stages a change in the module of a joint.
  [[nodiscard]] std::optional<SdoWrite> staging(std::size_t change, unsigned joint, std::size_t n) const;
  /// The n-th write that repeats, for one joint, the parameters set by the changes before `end`. (The gait has
  /// overwritten their internal values since.)
  [[nodiscard]] std::optional<SdoWrite> parameter_write(std::size_t end, unsigned joint, std::size_t n) const;

 private:
  [[nodiscard]] bool exists(const ChangedValue& value) const;
  [[nodiscard]] bool fits(const Change& change) const;
  [[nodiscard]] std::optional<std::int32_t> parameter_before(std::size_t end, unsigned joint, unsigned slot,
                                                             unsigned parameter) const;

  const KernelConfiguration& kernel_;
  std::span<Change> changes_;
  std::size_t next_ = 0;
  std::size_t pending_from_ = 0;  ///< changes from here to next_ are dropped or wait for their tick
};

}  // namespace proleg::canopen
