#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/computer/change/change.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The changes of a run, in the form that the master takes: those of the scenario, and those that the user adds while
/// the robot moves. The master makes changes in the order in which it gets them. It therefore gets a change with a tick
/// a while before this tick, so that one without a tick does not wait for it until then.
class LiveChanges {
 public:
  /// The master gets a change this long before its tick: more than a connection that loses frames needs.
  static constexpr std::uint32_t lead_us = 3'000'000;

  /// scenario: must outlive this. planned: its changes, by ascending tick. span() has the first of them.
  LiveChanges(const sim::Scenario& scenario, std::vector<Change> planned);
  LiveChanges(const LiveChanges&) = delete;
  LiveChanges& operator=(const LiveChanges&) = delete;

  /// A word as for --set; without a tick the change takes effect as soon as all modules have it. now: present tick;
  /// end: the first one that is not part of the run. Throws InputError. True: the master must get the new span() now.
  bool add(const std::string& word, std::uint32_t now, std::uint32_t end);
  /// Values that take effect together, as soon as all modules have them. The master must get the new span() now.
  void add(const std::vector<Setting>& settings);
  /// Puts the next planned change behind span(), if it is time. True: the master must get the new span() now.
  bool release(std::uint32_t now);
  /// The master has refused the last one of span().
  void remove_last();
  /// What the master has, or must get.
  [[nodiscard]] std::span<Change> span() { return changes_; }

  /// The changes for this tick and earlier ones that have not been taken and that the master did not drop.
  [[nodiscard]] std::vector<Change> take_decided(std::uint32_t tick);
  /// Changes that the master has dropped, or never got in time.
  [[nodiscard]] std::uint64_t dropped() const;
  /// Changes without a tick that were added and have not been taken, nor dropped: the run has ended before.
  [[nodiscard]] std::uint64_t unfinished() const;

 private:
  const sim::Scenario& scenario_;
  std::uint32_t lead_ticks_;
  std::vector<Change> planned_;  ///< by ascending tick; the master does not have them yet
  std::vector<Change> changes_;
  std::vector<std::size_t> without_tick_;  ///< positions in changes_ of those that were added
  std::size_t taken_ = 0;
  std::uint64_t too_late_ = 0;  ///< planned changes that the master never got
};

}  // namespace proleg::tools
