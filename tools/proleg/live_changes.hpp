#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/master/change_plan.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The changes of a run, in the form that the master takes: those of the scenario, and those that the user adds while
/// the robot moves.
class LiveChanges {
 public:
  /// scenario: must outlive this. planned: its changes.
  LiveChanges(const sim::Scenario& scenario, std::vector<canopen::Change> planned);
  LiveChanges(const LiveChanges&) = delete;
  LiveChanges& operator=(const LiveChanges&) = delete;

  /// A word as for --set; without a tick the change takes effect as soon as all modules have it. now: present tick.
  /// Throws InputError. A new span() is then to be given to the master.
  void add(const std::string& word, std::uint32_t now);
  void remove_last() { changes_.pop_back(); }
  [[nodiscard]] std::span<canopen::Change> span() { return changes_; }

  /// The changes for this tick and earlier ones that have not been taken and that the master did not drop.
  [[nodiscard]] std::vector<sim::Change> take_decided(std::uint32_t tick);
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  const sim::Scenario& scenario_;
  std::vector<canopen::Change> changes_;
  std::vector<std::vector<canopen::ChangedValue>> values_;  ///< of the changes that were added
  std::size_t taken_ = 0;
};

}  // namespace proleg::tools
