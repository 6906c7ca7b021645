#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"

namespace proleg::optimize {
namespace {

/// Cells with tabs between them; the first is not empty.
class Line {
 public:
  void add(std::string_view cell) {
    if (!text_.empty()) {
      text_ += '\t';
    }
    text_ += cell;
  }
  void add(std::uint64_t number) { add(std::to_string(number)); }
  [[nodiscard]] std::string finish() && { return std::move(text_) + '\n'; }

 private:
  std::string text_;
};

void add_header(const Experiment& experiment, Line& line) {
  line.add("run");
  line.add("evaluation");
  for (const Dimension& dimension : experiment.space.dimensions) {
    line.add(with_unit(one_line(dimension.name), scale_of(dimension.unit).symbol));
  }
  for (const Objective& objective : experiment.objectives) {
    line.add("score:" + with_unit(one_line(objective.name), objective.unit()));
  }
  for (const sim::MeasureDeclaration& measure : sim::measures()) {
    line.add(with_unit(measure.name, measure.unit));
  }
  for (const std::string_view name : {"simulated_s", "wall_s", "given_up", "reused", "restored", "failure"}) {
    line.add(name);
  }
}

void add_evaluation(const Experiment& experiment, const Evaluation& evaluation, Line& line) {
  line.add(evaluation.run);
  line.add(evaluation.number);
  for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
    line.add(experiment.space.value_text(evaluation.candidate, i));
  }
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    line.add(exact_text(evaluation.scores[i]));
  }
  for (const double value : evaluation.measures.all()) {
    line.add(exact_text(value));
  }
  line.add(exact_text(evaluation.simulated_s));
  line.add(exact_text(evaluation.wall_s));
  for (const bool flag : {evaluation.given_up, evaluation.reused, evaluation.restored}) {
    line.add(flag ? "1" : "0");
  }
  line.add(one_line(evaluation.failure));
}

}  // namespace

std::string evaluations_table(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  Line header;
  add_header(experiment, header);
  std::string table = std::move(header).finish();
  for (const Evaluation& evaluation : evaluations) {
    Line line;
    add_evaluation(experiment, evaluation, line);
    table += std::move(line).finish();
  }
  return table;
}

std::string best_table(const Experiment& experiment, std::span<const Evaluation> evaluations, std::size_t count) {
  Line header;
  header.add("rank");
  add_header(experiment, header);
  std::string table = std::move(header).finish();

  std::vector<std::size_t> order(evaluations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    const double score = evaluations[i].scores.front();
    return std::isfinite(score) ? experiment.objectives.front().cost(score) : INFINITY;
  });
  std::set<Candidate> listed;
  for (const std::size_t i : order) {
    if (listed.size() == count) {
      break;
    }
    if (!listed.insert(evaluations[i].candidate).second) {
      continue;
    }
    Line line;
    line.add(listed.size());
    add_evaluation(experiment, evaluations[i], line);
    table += std::move(line).finish();
  }
  return table;
}

}  // namespace proleg::optimize
