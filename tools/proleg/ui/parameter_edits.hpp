#pragma once

// What a user wants of the parameters of a robot, and what they wanted before.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/scenario/scenario.hpp"
#include "tools/proleg/document/parameter_table.hpp"
#include "tools/proleg/ui/change_history.hpp"

namespace proleg::tools {

class ParameterEdits {
 public:
  /// file: as the files have it; must outlive this. start: the same with the start values of the first run.
  ParameterEdits(const sim::Scenario& file, const sim::Scenario& start);

  /// What words mean, as for --set, without a tick. Changes nothing. Throws InputError.
  [[nodiscard]] std::vector<Setting> read(const std::vector<std::string>& words) const;

  // Each of these wants other values and returns them.

  /// Words as for read(). Internal values are among the result; they are not wanted longer than once. Throws
  /// InputError, and then changes nothing. gesture: as in ChangeHistory.
  std::vector<Setting> set(const std::vector<std::string>& words, std::optional<std::uint64_t> gesture);
  /// Nothing if there is nothing to undo.
  std::optional<std::vector<Setting>> undo();
  std::optional<std::vector<Setting>> redo();
  /// As the file has them.
  std::vector<Setting> reset(const std::vector<ParameterPlace>& places);

  /// The places that names like those of set() mean, of each joint that they mean; without names all. Throws
  /// InputError.
  [[nodiscard]] std::vector<ParameterPlace> places_of(const std::optional<std::vector<std::string>>& names) const;

  [[nodiscard]] ParameterTable& parameters() { return parameters_; }
  [[nodiscard]] const ParameterTable& parameters() const { return parameters_; }
  [[nodiscard]] const ChangeHistory& history() const { return history_; }
  /// Whether anything is wanted otherwise than the file has it.
  [[nodiscard]] bool differs_from_file() const;
  /// The file with the start values that are wanted.
  [[nodiscard]] sim::Scenario scenario_as_wanted() const;

 private:
  /// Wants the values of an entry before or after it.
  std::vector<Setting> want(const ChangeHistory::Entry& entry, std::int32_t ChangeHistory::Step::*value);

  const sim::Scenario& file_;
  ParameterTable parameters_;
  ChangeHistory history_;
};

}  // namespace proleg::tools
