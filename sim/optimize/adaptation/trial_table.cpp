#include "sim/optimize/adaptation/trial_table.hpp"

#include <algorithm>
#include <optional>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/unit.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

constexpr std::string_view inputs_comment = "# inputs: ";

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

std::vector<std::string_view> columns_of(std::string_view line) {
  std::vector<std::string_view> columns;
  for (std::size_t tab = line.find('\t'); tab != std::string_view::npos; tab = line.find('\t')) {
    columns.push_back(line.substr(0, tab));
    line.remove_prefix(tab + 1);
  }
  columns.push_back(line);
  return columns;
}

/// A trial of a line; nothing if it is damaged.
std::optional<MadeTrial> read_trial(const Atlas& atlas, const GaitMap& map, std::string_view line, std::size_t number) {
  const std::vector<std::string_view> columns = columns_of(line);
  const std::size_t scores = 2 + atlas.experiment.axes.size() + atlas.experiment.space.dimensions.size();
  if (columns.size() != scores + 4 || parse_whole<std::size_t>(columns[0]) != number) {
    return std::nullopt;
  }
  const auto gait =
      std::ranges::find_if(atlas.gaits, [&](const AtlasGait& one) { return map.place_text(one.cell) == columns[1]; });
  const std::optional<double> expected = parse_number(columns[scores]);
  const std::optional<double> deviation = parse_number(columns[scores + 1]);
  const std::optional<double> measured = parse_number(columns[scores + 2]);
  if (gait == atlas.gaits.end() || !expected || !deviation || !measured) {
    return std::nullopt;
  }
  return MadeTrial{static_cast<std::size_t>(gait - atlas.gaits.begin()), *expected, *deviation, *measured,
                   std::string(columns[scores + 3])};
}

}  // namespace

std::string trial_table(const Atlas& atlas, const std::string& inputs, const std::vector<MadeTrial>& trials) {
  const GaitMap map(atlas.experiment);
  std::string text = std::string(inputs_comment) + inputs + '\n' + head_of(atlas) + '\n';
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
  if (const std::optional<std::string_view> head = lines.next(); !head || *head != head_of(atlas)) {
    throw InputError(name, 2, "another head", "that of the table of these trials");
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

}  // namespace proleg::optimize
