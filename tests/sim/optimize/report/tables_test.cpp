#include <charconv>
#include <random>

#include "made_up.hpp"
#include "sim/optimize/report/report.hpp"

namespace proleg::optimize {
namespace {

/// A table parsed again: for each line its cells by the names of the header.
std::vector<std::map<std::string, std::string>> parsed(const std::string& table) {
  const auto cells = [](const std::string& line) {
    std::vector<std::string> result{""};
    for (const char c : line) {
      if (c == '\t') {
        result.emplace_back();
      } else {
        result.back() += c;
      }
    }
    return result;
  };
  std::istringstream stream(table);
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> names = cells(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(stream, line)) {
    const std::vector<std::string> values = cells(line);
    EXPECT_EQ(values.size(), names.size()) << line;
    rows.emplace_back();
    for (std::size_t i = 0; i < std::min(values.size(), names.size()); ++i) {
      EXPECT_TRUE(rows.back().emplace(names[i], values[i]).second) << "column " << names[i] << " twice";
    }
  }
  return rows;
}

double number(const std::string& text) {
  double value = NAN;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_TRUE(error == std::errc{} && end == text.data() + text.size()) << text;
  return value;
}

TEST(EvaluationsTable, ReadsBackExactly) {
  const unsigned seed = 7;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> some(-1.0, 1.0);
  const Experiment experiment = experiment_of({objective_of(sim::Measure::distance, Goal::maximise),
                                               objective_of(sim::Measure::cost_of_transport, Goal::minimise)});
  std::vector<Evaluation> evaluations;
  for (std::uint64_t i = 0; i < 200; ++i) {
    Evaluation evaluation = evaluation_of(i, some(random));
    evaluation.run = static_cast<std::uint32_t>(random() % 3);
    evaluation.scores.push_back(some(random) * 1e-300);
    for (double& value : evaluation.measures.all()) {
      value = random() % 4 == 0 ? NAN : some(random) * std::pow(10.0, static_cast<double>(random() % 40) - 20.0);
    }
    for (std::uint32_t& index : evaluation.candidate) {
      index = static_cast<std::uint32_t>(random() % 161);
    }
    evaluation.wall_s = some(random);
    evaluation.simulated_s = 30.0;
    evaluation.given_up = random() % 2 == 0;
    evaluation.reused = random() % 2 == 0;
    evaluation.restored = random() % 2 == 0;
    evaluations.push_back(evaluation);
  }
  const auto rows = parsed(evaluations_table(experiment, evaluations));
  ASSERT_EQ(rows.size(), evaluations.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const Evaluation& evaluation = evaluations[i];
    EXPECT_EQ(row.at("run"), std::to_string(evaluation.run));
    EXPECT_EQ(row.at("evaluation"), std::to_string(evaluation.number));
    for (std::size_t d = 0; d < 5; ++d) {
      EXPECT_EQ(number(row.at("amplitude:J" + std::to_string(5 - d) + " (deg)")), evaluation.candidate[d] / 4.0);
    }
    EXPECT_EQ(number(row.at("score:distance (m)")), evaluation.scores[0]);
    EXPECT_EQ(number(row.at("score:cost_of_transport (m/s^2)")), evaluation.scores[1]);
    for (const sim::MeasureDeclaration& measure : sim::measures()) {
      const std::string unit(measure.unit);
      const std::string& text = row.at(std::string(measure.name) + (unit.empty() ? "" : " (" + unit + ")"));
      const double value = evaluation.measures[measure.measure];
      EXPECT_TRUE(std::isnan(value) ? text.empty() : number(text) == value) << measure.name << ": " << text;
    }
    EXPECT_EQ(number(row.at("wall_s")), evaluation.wall_s);
    EXPECT_EQ(row.at("simulated_s"), "30");
    EXPECT_EQ(row.at("given_up"), evaluation.given_up ? "1" : "0");
    EXPECT_EQ(row.at("reused"), evaluation.reused ? "1" : "0");
    EXPECT_EQ(row.at("restored"), evaluation.restored ? "1" : "0");
    EXPECT_EQ(row.at("failure"), "");
  }
}

TEST(EvaluationsTable, HasOneLineForAFailureWhateverItsText) {
  Evaluation evaluation = failed_evaluation(0, 0.0);
  evaluation.failure = "fell\toff\nthe \x01 world";
  const auto rows = parsed(evaluations_table(distance_experiment(), std::vector{evaluation}));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].at("failure").substr(0, 4), "fell");
  EXPECT_EQ(rows[0].at("distance (m)"), "");
  EXPECT_EQ(rows[0].at("score:distance (m)"), "0");
}

TEST(BestTable, ListsDifferentCandidatesBestFirst) {
  std::vector<Evaluation> evaluations;
  const std::vector<std::pair<double, std::uint32_t>> scores{{1.0, 7}, {3.0, 1}, {2.0, 2},
                                                             {2.5, 1}, {2.0, 3}, {0.5, 4}};
  for (const auto& [score, candidate] : scores) {
    evaluations.push_back(evaluation_of(evaluations.size(), score));
    evaluations.back().candidate[2] = candidate;
  }
  const auto rows = parsed(best_table(distance_experiment(), evaluations, 4));
  ASSERT_EQ(rows.size(), 4U);
  const std::vector<std::string> numbers{"1", "2", "4", "0"};  // of equal scores the earlier; candidate 1 once
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].at("rank"), std::to_string(i + 1));
    EXPECT_EQ(rows[i].at("evaluation"), numbers[i]);
  }
}

TEST(BestTable, FollowsTheGoalOfTheFirstObjective) {
  const Experiment experiment = experiment_of({objective_of(sim::Measure::cost_of_transport, Goal::minimise)});
  std::vector<Evaluation> evaluations{evaluation_of(0, 9.0), evaluation_of(1, 2.0), evaluation_of(2, 5.0)};
  for (Evaluation& evaluation : evaluations) {
    evaluation.measures[sim::Measure::cost_of_transport] = evaluation.scores.front();
  }
  const auto rows = parsed(best_table(experiment, evaluations, 10));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].at("evaluation"), "1");
  EXPECT_EQ(rows[2].at("evaluation"), "0");
}

TEST(BestTable, HasFailuresLast) {
  const std::vector<Evaluation> evaluations{failed_evaluation(0, 7.0), evaluation_of(1, 2.0), evaluation_of(2, 5.0)};
  const auto rows = parsed(best_table(distance_experiment(), evaluations, 10));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].at("evaluation"), "2");
  EXPECT_EQ(rows[2].at("evaluation"), "0");
}

TEST(BestTable, HasTheBaselineAboveTheBest) {
  Experiment experiment = distance_experiment();
  experiment.has_baseline = true;
  const std::vector<Evaluation> evaluations{evaluation_of(0, 1.5), evaluation_of(1, 1.0), evaluation_of(2, 2.0)};
  const auto rows = parsed(best_table(experiment, evaluations, 2));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].at("rank"), "baseline");
  EXPECT_EQ(rows[0].at("evaluation"), "0");
  EXPECT_EQ(rows[1].at("rank"), "1");
  EXPECT_EQ(rows[1].at("evaluation"), "2");
  EXPECT_EQ(rows[2].at("evaluation"), "0") << "it is ranked, too";
}

TEST(ConfirmationTable, HasEveryFreshRun) {
  const std::vector<Confirmation> confirmations{{evaluation_of(7, 2.0), {1.5, 1.75}, 1.625, 0.125, 1.5},
                                                {evaluation_of(3, 2.5), {1.25, 1.0}, 1.125, 0.25, 1.0}};
  const auto rows = parsed(confirmation_table(distance_experiment(), confirmations));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("rank"), "1");
  EXPECT_EQ(rows[0].at("evaluation"), "7");
  EXPECT_EQ(rows[0].at("amplitude:J5 (deg)"), "40");
  EXPECT_EQ(rows[0].at("score"), "2");
  EXPECT_EQ(rows[0].at("mean"), "1.625");
  EXPECT_EQ(rows[0].at("standard_deviation"), "0.125");
  EXPECT_EQ(rows[1].at("worst"), "1");
  EXPECT_EQ(rows[1].at("2"), "1");
}

TEST(ConfirmationTable, NamesTheTwoEnginesOfAJudgedSearch) {
  Experiment experiment = distance_experiment();
  experiment.scenario.environment.engine = sim::PhysicsEngine::reduced;
  const std::vector<Confirmation> confirmations{{evaluation_of(7, 2.0), {1.5}, 1.5, 0.0, 1.5}};
  const auto rows = parsed(confirmation_table(experiment, confirmations));
  EXPECT_EQ(rows[0].at("score (reduced)"), "2");
  EXPECT_EQ(rows[0].at("mean (ode)"), "1.5");
}

TEST(Tables, HaveAHeaderWithoutEvaluations) {
  EXPECT_TRUE(evaluations_table(distance_experiment(), {}).starts_with("run\tevaluation\tamplitude:J5 (deg)\t"));
  EXPECT_TRUE(best_table(distance_experiment(), {}, 10).starts_with("rank\trun\tevaluation\t"));
}

}  // namespace
}  // namespace proleg::optimize
