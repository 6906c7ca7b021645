#pragma once

// The changes that the master makes while the robot moves: the next one, those that wait for their tick, and the SDO
// writes of each change.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/computer/change/change.hpp"
#include "shared/computer/master/setup_list.hpp"

namespace proleg::canopen {

/// Change n is sent as transaction n + 1 (modulo 65535), which is opened in every module.
class ChangePlan {
 public:
  /// Greatest number of committed transactions that a module holds beside the open one.
  static constexpr std::size_t max_pending = max_transactions - 1;

  /// kernel and changes must outlive the plan. Clears `dropped` of all changes from `next` on; those before are made.
  ChangePlan(const KernelConfiguration& kernel, std::span<Change> changes, std::size_t next = 0);

  /// Adds changes. changes: the earlier ones, as they are now, and new ones behind them.
  void extend(std::span<Change> changes) { changes_ = changes; }

  /// The first change from next() on that is not possible. It has a value that its joint does not have, more than
  /// max_staged_values of a joint, or a tick not later than that of the change before. (Any number of successive
  /// changes may be `soon`.)
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
  /// Decides the tick of the next change, if it is `soon`: the first tick from `earliest` on that is later than the
  /// change before.
  void decide_tick(std::uint32_t earliest);
  void commit_next();
  void drop_next();
  /// Notes that committed changes for this tick and earlier ones are in force.
  void pass(std::uint32_t tick);

  /// Write number n of those that stage a change in the module of a joint; nothing behind the last one.
  [[nodiscard]] std::optional<SdoRequest> staging(std::size_t change, unsigned joint, std::size_t n) const;
  /// Write number n of those that repeat, for one joint, the parameters that the changes before `end` have set; nothing
  /// behind the last one. (The gait has overwritten their internal values since.)
  [[nodiscard]] std::optional<SdoRequest> parameter_write(std::size_t end, unsigned joint, std::size_t n) const;

 private:
  [[nodiscard]] bool exists(const Setting& setting) const;
  [[nodiscard]] bool fits(const Change& change) const;
  [[nodiscard]] std::optional<std::int32_t> parameter_before(std::size_t end, unsigned joint, unsigned slot,
                                                             unsigned parameter) const;

  const KernelConfiguration& kernel_;
  std::span<Change> changes_;
  std::size_t next_ = 0;
  std::size_t pending_from_ = 0;  ///< changes from here to next_ are dropped or wait for their tick
};

}  // namespace proleg::canopen
