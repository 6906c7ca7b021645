#include <limits>
#include <random>

#include "made_up.hpp"
#include "sim/optimize/report/report.hpp"

namespace proleg::optimize {
namespace {

Evaluation with_scores(std::uint64_t number, std::vector<double> scores, Candidate candidate) {
  Evaluation evaluation = evaluation_of(number, scores.front());
  evaluation.scores = std::move(scores);
  evaluation.candidate = std::move(candidate);
  evaluation.measures.all()[static_cast<std::size_t>(sim::Measure::cost_of_transport)] = 1.0;
  evaluation.measures.all()[static_cast<std::size_t>(sim::Measure::height)] = 1.0;
  return evaluation;
}

/// The definition, literally: no other dominates it; of equal candidates with equal scores the first.
std::vector<std::size_t> front_by_definition(const std::vector<Objective>& objectives,
                                             const std::vector<Evaluation>& evaluations) {
  const auto beats = [&](const Evaluation& a, const Evaluation& b) {
    int better = 0;
    int worse = 0;
    for (std::size_t i = 0; i < objectives.size(); ++i) {
      const double gain = (a.scores[i] - b.scores[i]) * (objectives[i].goal == Goal::maximise ? 1.0 : -1.0);
      better += gain > 0.0 ? 1 : 0;
      worse += gain < 0.0 ? 1 : 0;
    }
    return better > 0 && worse == 0;
  };
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    bool belongs = true;
    for (std::size_t j = 0; j < evaluations.size(); ++j) {
      const bool repeats = j < i && evaluations[j].candidate == evaluations[i].candidate &&
                           evaluations[j].scores == evaluations[i].scores;
      belongs = belongs && !repeats && !beats(evaluations[j], evaluations[i]);
    }
    if (belongs) {
      front.push_back(i);
    }
  }
  std::ranges::stable_sort(front, {}, [&](std::size_t i) { return evaluations[i].scores.front(); });
  return front;
}

TEST(ParetoFront, IsThatOfTheDefinition) {
  const unsigned seed = 20'250;
  std::mt19937 random(seed);
  const std::vector<Objective> all{objective_of(sim::Measure::distance, Goal::maximise),
                                   objective_of(sim::Measure::cost_of_transport, Goal::minimise),
                                   objective_of(sim::Measure::height, Goal::maximise)};
  for (int round = 0; round < 300; ++round) {
    std::vector<Objective> objectives(all.begin(), all.begin() + 1 + static_cast<std::ptrdiff_t>(random() % 3));
    for (Objective& objective : objectives) {
      objective.goal = random() % 2 == 0 ? Goal::maximise : Goal::minimise;
    }
    const std::size_t count = random() % 60;
    const std::uint32_t grid = 1 + static_cast<std::uint32_t>(random() % 12);  // coarse, so that there are equals
    std::vector<Evaluation> evaluations;
    for (std::size_t i = 0; i < count; ++i) {
      std::vector<double> scores;
      for (std::size_t k = 0; k < objectives.size(); ++k) {
        scores.push_back(static_cast<double>(random() % grid));
      }
      evaluations.push_back(with_scores(i, std::move(scores), {static_cast<std::uint32_t>(random() % 3)}));
    }
    ASSERT_EQ(pareto_front(experiment_of(objectives), evaluations), front_by_definition(objectives, evaluations))
        << "seed " << seed << ", round " << round;
  }
}

TEST(ParetoFront, LeavesOutWhatHasNoScores) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Experiment experiment = experiment_of({objective_of(sim::Measure::distance, Goal::maximise),
                                               objective_of(sim::Measure::cost_of_transport, Goal::minimise)});
  const std::vector<Evaluation> evaluations{with_scores(0, {nan, 1.0}, {0}), with_scores(1, {1.0, 2.0}, {1}),
                                            with_scores(2, {2.0, nan}, {2})};
  EXPECT_EQ(pareto_front(experiment, evaluations), std::vector<std::size_t>{1});
  EXPECT_TRUE(pareto_front(experiment, {}).empty());
}

TEST(ParetoFigure, ShowsTheFrontAmongAll) {
  const Experiment experiment = experiment_of({objective_of(sim::Measure::distance, Goal::maximise),
                                               objective_of(sim::Measure::cost_of_transport, Goal::minimise)});
  std::vector<Evaluation> evaluations;
  for (std::uint32_t i = 0; i < 10; ++i) {  // a front of ten, each with one that it beats
    evaluations.push_back(with_scores(i, {1.0 + i, 5.0 + i}, {i}));
    evaluations.push_back(with_scores(i, {0.5 + i, 5.5 + i}, {i}));
  }
  Picture picture(draw_pareto_front(experiment, evaluations));
  EXPECT_EQ(picture.marks("evaluations"), 20U);
  EXPECT_EQ(picture.marks("front"), 10U);
  EXPECT_EQ(picture.lines("front"), 1U);
  for (const char* text : {"distance (m): more is better", "cost_of_transport (m/s^2): less is better",
                           "20 evaluations, 10 of them on the Pareto front"}) {
    EXPECT_TRUE(picture.has_text(text)) << text;
  }
}

TEST(ParetoFigure, IsDrawnWhateverTheEvaluations) {
  const Experiment two = experiment_of({objective_of(sim::Measure::distance, Goal::maximise),
                                        objective_of(sim::Measure::cost_of_transport, Goal::minimise)});
  std::vector<std::vector<Evaluation>> cases{{}, {with_scores(0, {1.0, 2.0}, {0})}};
  cases.emplace_back(20, with_scores(0, {1.0, 2.0}, {0}));
  cases.push_back({with_scores(0, {1e308, -1e308}, {0}), with_scores(1, {-1e308, 1e308}, {1})});
  Evaluation failed = failed_evaluation(0, 0.0);
  failed.scores = {0.0, 1e6};
  cases.emplace_back(5, failed);
  for (const std::vector<Evaluation>& evaluations : cases) {
    EXPECT_TRUE(Picture(draw_pareto_front(two, evaluations)).has_text("Pareto front"));
  }
  EXPECT_TRUE(
      Picture(draw_pareto_front(distance_experiment(), std::vector{evaluation_of(0, 1.0)})).has_text("made_up"));
}

}  // namespace
}  // namespace proleg::optimize
