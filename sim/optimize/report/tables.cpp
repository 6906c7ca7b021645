#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "shared/computer/text/text.hpp"
#include "sim/environment/environment_model.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

void add_dimensions(const Experiment& experiment, TableLine& line) {
  for (const Dimension& dimension : experiment.space.dimensions) {
    line.add(with_unit(one_line(dimension.name), sim::shown_unit(dimension.unit)));
  }
}

void add_header(const Experiment& experiment, TableLine& line) {
  line.add("run");
  line.add("evaluation");
  add_dimensions(experiment, line);
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

std::string gait_map_table(const Experiment& experiment, std::span<const Evaluation> evaluations) {
  const GaitMap map = gait_map(experiment, evaluations);
  TableLine header;
  for (const GaitMap::PlaceNumber& number : map.place_numbers()) {
    header.add("cell:" + one_line(number.name));
  }
  add_header(experiment, header);
  std::string table = header.finish();
  std::vector<GaitMap::Elite> elites = map.elites();
  std::ranges::sort(elites, {}, &GaitMap::Elite::cell);
  for (const GaitMap::Elite& elite : elites) {
    TableLine line;
    for (const std::uint32_t number : map.place(elite.cell)) {
      line.add(number + 1);
    }
    add_evaluation(experiment, evaluations[elite.candidate], line);
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
    return has_own_score(experiment, evaluations[i], 0)
               ? experiment.objectives.front().cost(evaluations[i].scores.front())
               : INFINITY;
  });
  if (const Evaluation* const baseline = baseline_of(experiment, evaluations)) {
    TableLine line;
    line.add("baseline");
    add_evaluation(experiment, *baseline, line);
    table += line.finish();
  }
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

std::string confirmation_table(const Experiment& experiment, std::span<const Confirmation> confirmations) {
  TableLine header;
  header.add("rank");
  header.add("evaluation");
  add_dimensions(experiment, header);
  // A judged experiment has two engines: one of the search, one of the fresh runs.
  const bool has_two = is_judged(experiment);
  const auto in_engine = [&](sim::PhysicsEngine engine) {
    return has_two ? " (" + std::string(sim::name_of(engine)) + ")" : "";
  };
  header.add("score" + in_engine(experiment.scenario.environment.engine));
  header.add("mean" + in_engine(judging_engine));
  header.add("standard_deviation");
  header.add("worst");
  for (std::size_t run = 0; !confirmations.empty() && run < confirmations.front().scores.size(); ++run) {
    header.add(run + 1);
  }
  std::string table = header.finish();
  for (std::size_t rank = 0; rank < confirmations.size(); ++rank) {
    const Confirmation& confirmation = confirmations[rank];
    TableLine line;
    line.add(rank + 1);
    line.add(confirmation.evaluation.number);
    for (std::size_t i = 0; i < experiment.space.dimensions.size(); ++i) {
      line.add(experiment.space.value_text(confirmation.evaluation.candidate, i));
    }
    line.add(confirmation.evaluation.scores.front());
    line.add(confirmation.mean);
    line.add(confirmation.standard_deviation);
    line.add(confirmation.worst);
    for (const double score : confirmation.scores) {
      line.add(score);
    }
    table += line.finish();
  }
  return table;
}

}  // namespace proleg::optimize
