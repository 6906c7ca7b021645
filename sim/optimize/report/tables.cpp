#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "shared/computer/text/table_line.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"

namespace proleg::optimize {
namespace {

void add_header(const Experiment& experiment, TableLine& line) {
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

void add_evaluation(const Experiment& experiment, const Evaluation& evaluation, TableLine& line) {
  line.add(evaluation.run);
  line.add(evaluation.number);
  for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
    line.add(experiment.space.value_text(evaluation.candidate, i));
  }
  for (std::size_t i = 0; i < experiment.objectives.size(); ++i) {
    line.add(evaluation.scores[i]);
  }
  for (const double value : evaluation.measures.all()) {
    line.add(value);
  }
  line.add(evaluation.simulated_s);
  line.add(evaluation.wall_s);
  for (const bool flag : {evaluation.given_up, evaluation.reused, evaluation.restored}) {
    line.add(flag ? "1" : "0");
  }
  line.add(one_line(evaluation.failure));
}

}  // namespace

std::string evaluations_table(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  TableLine header;
  add_header(experiment, header);
  std::string table = header.finish();
  for (const Evaluation& evaluation : evaluations) {
    TableLine line;
    add_evaluation(experiment, evaluation, line);
    table += line.finish();
  }
  return table;
}

std::string best_table(const Experiment& experiment, std::span<const Evaluation> evaluations, std::size_t count) {
  TableLine header;
  header.add("rank");
  add_header(experiment, header);
  std::string table = header.finish();

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
    TableLine line;
    line.add(listed.size());
    add_evaluation(experiment, evaluations[i], line);
    table += line.finish();
  }
  return table;
}

}  // namespace proleg::optimize
