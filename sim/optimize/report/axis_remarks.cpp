// What the axes of a map of gaits do not show.

#include <algorithm>
#include <cmath>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"

namespace proleg::optimize {
namespace {

/// The values of an axis in the runs that have a score.
std::vector<double> values_on_axis(const Experiment& experiment, std::size_t axis,
                                   std::span<const Evaluation> evaluations) {
  std::vector<double> values;
  for (const Evaluation& evaluation : evaluations) {
    const std::vector<double>& scores = evaluation.scores;
    if (scores.size() > 1 + axis && std::isfinite(scores.front()) &&
        scores.front() != experiment.objectives.front().failed && std::isfinite(scores[1 + axis]) &&
        scores[1 + axis] != experiment.objectives[1 + axis].failed) {
      values.push_back(scores[1 + axis]);
    }
  }
  return values;
}

}  // namespace

std::vector<std::string> axis_remarks(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  constexpr std::size_t least_runs = 10;
  constexpr double nearly_all = 0.9;
  std::vector<std::string> remarks;
  for (std::size_t i = 0; i < experiment.axes.size(); ++i) {
    const MapAxis& axis = experiment.axes[i];
    const Objective& measure = experiment.objectives[1 + i];
    const std::vector<double> values = values_on_axis(experiment, i, evaluations);
    if (values.size() < least_runs) {
      continue;
    }
    const auto [lowest, highest] = std::ranges::minmax(values);
    const auto share = [&](auto is_there) {
      return static_cast<double>(std::ranges::count_if(values, is_there)) / static_cast<double>(values.size());
    };
    const double below = share([&](double value) { return value < axis.lowest; });
    const double above = share([&](double value) { return value > axis.highest; });
    const double width = axis.highest - axis.lowest;
    const auto cell = [&](double value) { return std::floor((value - axis.lowest) / width * axis.cells); };
    std::string what;
    if (below >= nearly_all) {
      what = "below the lowest value " + number_text(axis.lowest) + " of its axis";
    } else if (above >= nearly_all) {
      what = "above the highest value " + number_text(axis.highest) + " of its axis";
    } else if (below + above >= nearly_all) {
      what = "outside of its axis, " + number_text(axis.lowest) + " to " + number_text(axis.highest);
    } else if (axis.cells > 1 && below + above == 0.0 && cell(lowest) == cell(highest) && highest > lowest) {
      what = "in one of the " + std::to_string(axis.cells) + " cells of its axis, " + number_text(axis.lowest) +
             " to " + number_text(axis.highest);
    } else {
      continue;
    }
    const double outside = below + above;
    remarks.push_back(measure.name + " was " + number_text(lowest) + " to " + rounded_text(highest, measure.unit()) +
                      " in all " + std::to_string(values.size()) + " runs, " +
                      (outside > 0.0 && outside < 1.0 ? "nearly always " : "") + what +
                      "; are its bounds in another unit?");
  }
  return remarks;
}

}  // namespace proleg::optimize
