#pragma once

// What a user wants of the parameters of a robot, what they wanted before, and how it gets to modules that move.

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/remote/binding.hpp"
#include "shared/computer/change/change.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/document/robot_document.hpp"

namespace proleg::tools {

/// What names of parameters, as for --set, mean in the documents `robot` and `parameters` (docs/page-interface.md). So
/// they mean the same on every kind of robot.
class ParameterWords {
 public:
  struct Parameter {
    double minimum = 0;  ///< in its unit, as all of these
    double maximum = 0;
    bool has_limits = true;  ///< false: an angle that wraps
    double wanted = 0;       ///< of the first joint that the name means
    double resolution = 0;   ///< of the modules' number format
  };

  void set_robot(const nlohmann::json& document) { robot_ = document; }
  void set_parameters(const nlohmann::json& document) { parameters_ = document; }

  /// [MODULE.]NAME[:JOINT]. Throws InputError. where: begins its message.
  [[nodiscard]] Parameter find(const std::string& name, const std::string& where = {}) const;

 private:
  [[nodiscard]] bool is_module(const nlohmann::json& slot, const std::string& module) const;

  nlohmann::json robot_ = nlohmann::json::object();
  nlohmann::json parameters_ = nlohmann::json::array();
};

/// Throws InputError if the robot has no such parameters, or a limit is outside theirs. where: for the message.
void check_binding(const host::Binding& binding, const ParameterWords& words, const std::string& where);

/// What a user changed, for undo and redo.
class ChangeHistory {
 public:
  /// The oldest entries beyond these are forgotten.
  static constexpr std::size_t max_entries = 200;

  struct Step {
    ParameterPlace place;
    std::int32_t before;
    std::int32_t after;
  };
  struct Entry {
    std::string name;  ///< of the change, for people
    std::vector<Step> steps;
    std::optional<std::uint64_t> gesture;
  };

  /// A new entry, after which nothing can be redone. With the gesture of the entry before, the two become one: a slider
  /// that is drawn makes many changes.
  void add(Entry entry);

  /// The entry that undo takes back; null: none.
  [[nodiscard]] const Entry* to_undo() const { return done_ > 0 ? &entries_[done_ - 1] : nullptr; }
  [[nodiscard]] const Entry* to_redo() const { return done_ < entries_.size() ? &entries_[done_] : nullptr; }
  /// The name of to_undo(), or nothing.
  [[nodiscard]] std::string name_to_undo() const { return to_undo() == nullptr ? std::string() : to_undo()->name; }
  [[nodiscard]] std::string name_to_redo() const { return to_redo() == nullptr ? std::string() : to_redo()->name; }
  /// Only if there is such an entry.
  void undone() { --done_; }
  void redone() { ++done_; }

 private:
  std::vector<Entry> entries_;
  std::size_t done_ = 0;  ///< entries from here on are undone
};

class ParameterEdits {
 public:
  /// file: as the files have it; must outlive this. start: the same with the start values of the first run.
  ParameterEdits(const sim::Scenario& file, const sim::Scenario& start);

  /// What words mean, as for --set, without a tick. Changes nothing. Throws InputError.
  [[nodiscard]] std::vector<Setting> read(const std::vector<std::string>& words) const;

  // Each of these changes the wanted values, and returns the new ones.

  /// Words as for read(). Internal values are among the result; they are not wanted longer than once. Throws
  /// InputError, and then changes nothing. gesture: as in ChangeHistory.
  std::vector<Setting> set(const std::vector<std::string>& words, std::optional<std::uint64_t> gesture);
  /// Nothing if there is nothing to undo.
  std::optional<std::vector<Setting>> undo();
  std::optional<std::vector<Setting>> redo();
  /// Wants the values of the file again.
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
  /// Empty if there is nothing to give.
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
