#include "sim/optimize/report/scores.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "shared/computer/text/text.hpp"
#include "sim/record/plot_frame.hpp"

namespace proleg::optimize {

GaitMap gait_map(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  GaitMap map(experiment);
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    map.add(i, evaluations[i].scores);
  }
  return map;
}

std::string with_unit(std::string_view name, std::string_view unit) {
  return std::string(name) + (unit.empty() ? "" : " (" + std::string(unit) + ")");
}

std::string rounded_text(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 4).ptr};
}

std::string rounded_text(double value, std::string_view unit) {
  return rounded_text(value) + (unit.empty() ? "" : ' ' + std::string(unit));
}

std::string fixed_text(double value, int decimals) {
  std::array<char, 400> text;  // the longest double has 309 digits before the point
  return {text.data(),
          std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr};
}

std::optional<double> parse_score(std::string_view word) {
  constexpr double largest = 1e100;
  const std::optional<double> score = parse_number(word);
  return score && std::abs(*score) <= largest ? score : std::nullopt;
}

std::vector<std::string_view> cells_of(std::string_view line, std::size_t columns) {
  std::vector<std::string_view> cells = proleg::cells_of(line);
  while (cells.size() > columns && cells.back().empty()) {
    cells.pop_back();
  }
  cells.resize(std::max(cells.size(), columns));
  return cells;
}

double drawable(double score) { return std::clamp(score, -1e9, 1e9); }

sim::Axis score_axis(std::vector<double> scores, std::span<const double> always, double pixel_low, double pixel_high) {
  if (scores.empty()) {
    return sim::axis_over(0.0, 1.0, pixel_low, pixel_high);
  }
  std::ranges::sort(scores);
  const std::size_t few = scores.size() / 20;
  const double usual_low = scores[few];
  const double usual_high = scores[scores.size() - 1 - few];
  const double usual = usual_high - usual_low;
  double low = scores.front();
  double high = scores.back();
  if (usual > 0.0 && high - low > 8.0 * usual) {
    low = std::max(low, usual_low - usual);
    high = std::min(high, usual_high + usual);
  }
  for (const double score : always) {
    low = std::min(low, score);
    high = std::max(high, score);
  }
  return sim::axis_over(low, high, pixel_low, pixel_high);
}

}  // namespace proleg::optimize
