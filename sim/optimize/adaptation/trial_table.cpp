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
std::optional<NotedTrial> noted_trial(std::string_view line, std::size_t number, std::size_t axes, std::size_t values) {
  const std::vector<std::string_view> columns = cells_of(line);
  const std::size_t first_value = 2 + axes;
  const std::size_t scores = first_value + values;
  if (columns.size() != scores + columns_of_scores || parse_whole<std::size_t>(columns[0]) != number) {
    return std::nullopt;
  }
  std::vector<double> numbers;
  for (std::size_t i = first_value; i < scores + 3; ++i) {
    const std::optional<double> its = parse_score(columns[i]);
    if (!its) {
      return std::nullopt;
    }
    numbers.push_back(*its);
  }
  return NotedTrial{std::string(columns[1]), {numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(values)},
                    numbers[values],         numbers[values + 1],
                    numbers[values + 2],     std::string(columns[scores + 3])};
}

std::optional<MadeTrial> read_trial(const Atlas& atlas, const GaitMap& map, std::string_view line, std::size_t number) {
  std::optional<NotedTrial> noted =
      noted_trial(line, number, atlas.experiment.axes.size(), atlas.experiment.space.dimensions.size());
  const auto is_noted = [&](const AtlasGait& gait) {
    if (!noted || map.place_text(gait.cell) != noted->place) {
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
    return std::nullopt;
  }
  return MadeTrial{static_cast<std::size_t>(gait - atlas.gaits.begin()), noted->expected, noted->deviation,
                   noted->measured, std::move(noted->failure)};
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
  if (comment->substr(inputs_comment.size()) != inputs) {
    throw InputError(name, 1, "trials of another atlas, scenario or program, or with other options",
                     "those of this command");
  }
  const std::optional<std::string_view> head = line_behind_comments(lines, [](std::string_view /*comment*/) {});
  if (!head || *head != head_of(atlas)) {
    throw InputError(name, lines.number(), "another head", "that of the table of these trials");
  }
  const GaitMap map(atlas.experiment);
  std::vector<MadeTrial> trials;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->empty()) {
      continue;
    }
    const std::optional<MadeTrial> trial = read_trial(atlas, map, *line, trials.size() + 1);
    if (!trial) {
      throw InputError(name, lines.number(), in_quotes(*line),
                       "trial " + std::to_string(trials.size() + 1) + " in the columns of the head");
    }
    trials.push_back(*trial);
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
        *said = comment.substr(begin.size());
      }
    }
  });
  const std::size_t columns = head ? cells_of(*head).size() : 0;
  const std::size_t others = 2 + axes + columns_of_scores;
  if (notes.comments.inputs.empty() || notes.comments.atlas.empty() || columns < others) {
    return std::nullopt;
  }
  while (const std::optional<std::string_view> line = lines.next()) {
    std::optional<NotedTrial> trial = noted_trial(*line, notes.trials.size() + 1, axes, columns - others);
    if (!trial) {
      break;
    }
    notes.trials.push_back(std::move(*trial));
  }
  return notes;
}

}  // namespace proleg::optimize
