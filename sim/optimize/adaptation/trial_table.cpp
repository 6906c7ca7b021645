#include "sim/optimize/adaptation/trial_table.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/unit.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

constexpr std::string_view inputs_comment = "# inputs: ";
constexpr std::string_view atlas_comment = "# atlas: ";
constexpr std::string_view robot_comment = "# robot: ";
constexpr std::string_view diagnosis_comment = "# damage: ";
constexpr std::size_t columns_of_scores = 4;  // expected, deviation, measured, failure

std::string head_of(const Atlas& atlas) {
  const Experiment& experiment = atlas.experiment;
  std::string head = "trial\tcell";
  for (std::size_t axis = 0; axis < experiment.axes.size(); ++axis) {
    const Objective& measure = experiment.objectives[1 + axis];
    head += '\t' + with_unit(measure.name, measure.unit());
  }
  for (const Dimension& dimension : experiment.space.dimensions) {
    head += '\t' + with_unit(dimension.name, sim::shown_unit(dimension.unit));
  }
  const Objective& objective = experiment.objectives.front();
  for (const char* const name : {"expected", "deviation", "measured"}) {
    head += '\t' + with_unit(name, objective.unit());
  }
  return head + "\tfailure";
}

/// A trial of a line; nothing if it is damaged. number: that it has to have. values: number of a gait's values.
/// wrong_column: the first column that has something else than is expected there.
std::optional<NotedTrial> noted_trial(std::string_view line, std::size_t number, std::size_t axes, std::size_t values,
                                      std::size_t& wrong_column) {
  const std::size_t first_value = 2 + axes;
  const std::size_t scores = first_value + values;
  const std::vector<std::string_view> columns = cells_of(line, scores + columns_of_scores);
  wrong_column = 0;
  if (parse_whole<std::size_t>(columns[0]) != number) {
    return std::nullopt;
  }
  std::vector<double> numbers;
  for (std::size_t i = first_value; i < scores + 3; ++i) {
    const std::optional<double> its = parse_score(columns[i]);
    if (!its) {
      wrong_column = i;
      return std::nullopt;
    }
    numbers.push_back(*its);
  }
  wrong_column = scores + columns_of_scores;
  if (columns.size() > wrong_column) {
    return std::nullopt;
  }
  return NotedTrial{std::string(columns[1]), {numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(values)},
                    numbers[values],         numbers[values + 1],
                    numbers[values + 2],     std::string(columns[scores + 3])};
}

/// What a column of the head must have in the line of a trial.
std::string expected_in(std::size_t column, std::size_t trial) {
  return column == 0 ? "trial " + std::to_string(trial) : "a number, with a point before its decimals";
}

/// Throws InputError if the line is none of this trial.
MadeTrial read_trial(const Atlas& atlas, const GaitMap& map, const std::string& name, int line_number,
                     std::string_view line, std::size_t number) {
  std::size_t wrong_column = 0;
  std::optional<NotedTrial> noted =
      noted_trial(line, number, atlas.experiment.axes.size(), atlas.experiment.space.dimensions.size(), wrong_column);
  if (!noted) {
    const std::string head = head_of(atlas);
    const std::vector<std::string_view> titles = proleg::cells_of(head);
    const std::vector<std::string_view> cells = cells_of(line, titles.size());
    if (wrong_column >= titles.size()) {
      throw InputError(name, line_number, std::to_string(cells.size()) + " columns",
                       std::to_string(titles.size()) + " as in the head, with tabs between them");
    }
    throw InputError(name, line_number,
                     (cells[wrong_column].empty() ? "nothing" : in_quotes(cells[wrong_column])) + " in the column `" +
                         std::string(titles[wrong_column]) + "`",
                     expected_in(wrong_column, number));
  }
  const auto is_noted = [&](const AtlasGait& gait) {
    if (map.place_text(gait.cell) != noted->place) {
      return false;
    }
    for (std::size_t d = 0; d < noted->values.size(); ++d) {
      if (atlas.experiment.space.value(gait.candidate, d) != noted->values[d]) {
        return false;
      }
    }
    return true;
  };
  const auto gait = std::ranges::find_if(atlas.gaits, is_noted);
  if (gait == atlas.gaits.end()) {
    throw InputError(name, line_number, "a gait that the atlas does not have in the cell " + in_quotes(noted->place),
                     "trial " + std::to_string(number) + " as it was written");
  }
  return {static_cast<std::size_t>(gait - atlas.gaits.begin()), noted->expected, noted->deviation, noted->measured,
          std::move(noted->failure)};
}

/// The line behind comments. take: called with each of these.
template <typename Take>
std::optional<std::string_view> line_behind_comments(TextLines& lines, const Take& take) {
  std::optional<std::string_view> line = lines.next();
  for (; line && line->starts_with('#'); line = lines.next()) {
    take(*line);
  }
  return line;
}

}  // namespace

std::string trial_table(const Atlas& atlas, const TrialComments& comments, const std::vector<MadeTrial>& trials) {
  const GaitMap map(atlas.experiment);
  std::string text;
  for (const auto& [comment, said] :
       {std::pair{inputs_comment, &comments.inputs}, std::pair{atlas_comment, &comments.atlas},
        std::pair{robot_comment, &comments.robot}, std::pair{diagnosis_comment, &comments.diagnosis}}) {
    if (!said->empty()) {
      text.append(comment).append(one_line(*said)) += '\n';
    }
  }
  text += head_of(atlas) + '\n';
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const MadeTrial& trial = trials[i];
    const AtlasGait& gait = atlas.gaits[trial.gait];
    text += std::to_string(i + 1) + '\t' + map.place_text(gait.cell);
    for (const double middle : map.middle(gait.cell)) {
      text += '\t' + rounded_text(middle);
    }
    for (std::size_t d = 0; d < gait.candidate.size(); ++d) {
      text += '\t' + atlas.experiment.space.value_text(gait.candidate, d);
    }
    for (const double number : {trial.expected, trial.deviation, trial.measured}) {
      text += '\t' + exact_text(number);
    }
    text += '\t' + one_line(trial.failure) + '\n';
  }
  return text;
}

std::vector<MadeTrial> read_trial_table(const Atlas& atlas, const std::string& inputs, const std::string& name,
                                        std::string_view text) {
  TextLines lines(text);
  const std::optional<std::string_view> comment = lines.next();
  if (!comment || !comment->starts_with(inputs_comment)) {
    throw InputError(name, 1, "no table of trials", "trials.tsv of `proleg adapt`");
  }
  if (trimmed(comment->substr(inputs_comment.size())) != inputs) {
    throw InputError(name, 1, "trials of another atlas, scenario or program, or with other options",
                     "those of this command");
  }
  const std::optional<std::string_view> head = line_behind_comments(lines, [](std::string_view /*comment*/) {});
  const std::string expected_head = head_of(atlas);
  if (!head || trimmed(*head) != expected_head) {
    throw InputError(name, lines.number(), "another head",
                     "that of the table of these trials, with tabs between its columns");
  }
  const GaitMap map(atlas.experiment);
  std::vector<MadeTrial> trials;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (!trimmed(*line).empty()) {
      trials.push_back(read_trial(atlas, map, name, lines.number(), *line, trials.size() + 1));
    }
  }
  return trials;
}

std::optional<TrialNotes> look_at_trials(std::string_view text, std::size_t axes) {
  TextLines lines(text);
  TrialNotes notes;
  const std::optional<std::string_view> head = line_behind_comments(lines, [&](std::string_view comment) {
    for (const auto& [begin, said] :
         {std::pair{inputs_comment, &notes.comments.inputs}, std::pair{atlas_comment, &notes.comments.atlas},
          std::pair{robot_comment, &notes.comments.robot}, std::pair{diagnosis_comment, &notes.comments.diagnosis}}) {
      if (comment.starts_with(begin)) {
        *said = trimmed(comment.substr(begin.size()));
      }
    }
  });
  const std::size_t columns = head ? proleg::cells_of(trimmed(*head)).size() : 0;
  const std::size_t others = 2 + axes + columns_of_scores;
  if (notes.comments.inputs.empty() || notes.comments.atlas.empty() || columns < others) {
    return std::nullopt;
  }
  while (const std::optional<std::string_view> line = lines.next()) {
    std::size_t wrong_column = 0;
    std::optional<NotedTrial> trial = noted_trial(*line, notes.trials.size() + 1, axes, columns - others, wrong_column);
    if (!trial) {
      break;
    }
    notes.trials.push_back(std::move(*trial));
  }
  return notes;
}

}  // namespace proleg::optimize
