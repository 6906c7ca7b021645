#pragma once

// What a user wants of the parameters of a robot, and what they wanted before.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/change_history.hpp"
#include "tools/proleg/ui/parameter_table.hpp"

namespace proleg::tools {

class ParameterEdits {
 public:
  /// file: as the user gave it; must outlive this.
  explicit ParameterEdits(const sim::Scenario& file);

  /// Words as for --set, without a tick. Returns the internal values among them, which are wanted once. Throws
  /// InputError, and then changes nothing. gesture: as in ChangeHistory.
  std::vector<sim::Setting> set(const std::vector<std::string>& words, std::optional<std::uint64_t> gesture);
  /// False if there is nothing to undo.
  bool undo();
  bool redo();
  /// The parameters with these names, as for --set without a value, or all of them, are wanted as the file has them.
  /// Throws InputError.
  void reset(const std::optional<std::vector<std::string>>& names);

  [[nodiscard]] ParameterTable& parameters() { return parameters_; }
  [[nodiscard]] const ParameterTable& parameters() const { return parameters_; }
  [[nodiscard]] const ChangeHistory& history() const { return history_; }
  /// Whether anything is wanted otherwise than the file has it.
  [[nodiscard]] bool differs_from_file() const;
  /// The file with the start values that are wanted.
  [[nodiscard]] sim::Scenario scenario_as_wanted() const;

 private:
  const sim::Scenario& file_;
  sim::Scenario scratch_;  ///< to read words with
  ParameterTable parameters_;
  ChangeHistory history_;
};

}  // namespace proleg::tools
