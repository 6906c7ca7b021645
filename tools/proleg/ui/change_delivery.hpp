#pragma once

#include <cstdint>
#include <vector>

#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/parameter_edits.hpp"

namespace proleg::tools {

/// The way of what a user wants to the modules of a robot that has power. A change is on its way for many ticks, and
/// the next one goes when the modules have it; meanwhile the user may want something else again.
class ChangeDelivery {
 public:
  /// edits: must outlive this.
  explicit ChangeDelivery(ParameterEdits& edits) : edits_(edits) {}

  /// The modules have started with what is wanted.
  void begin_run();
  /// Internal values that the modules are to get once.
  void add(const std::vector<Setting>& internal_values);
  /// The next change for the modules: all that is wanted and not given, but at most max_staged_values of a joint.
  /// Empty: there is none.
  [[nodiscard]] std::vector<Setting> next();
  /// The modules have made a change.
  void confirm(const Change& change);
  /// A change had no effect: what was given and not confirmed is not wanted any more.
  void give_up();

 private:
  ParameterEdits& edits_;
  std::vector<std::int32_t> given_;       ///< of each place of the table, what the modules were given last
  std::vector<Setting> internal_values_;  ///< not given yet
};

}  // namespace proleg::tools
