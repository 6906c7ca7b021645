#pragma once

// A source of fitness without a simulation, and experiments for it.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// Rates candidates by a function. Records all requests and compares them with the predictions.
class FakeSource final : public FitnessSource {
 public:
  using Function = std::function<std::vector<double>(const Candidate&)>;

  explicit FakeSource(Function rate, std::size_t ahead = 8, std::uint64_t evaluations = 1'000'000)
      : function_(std::move(rate)), lookahead_(ahead), budget_(evaluations) {}

  /// Whether there was a prediction before the previous evaluation ended, and whether it was right.
  enum class Prediction : std::uint8_t { none, right, wrong };

  void expect(std::span<const Candidate> next) override {
    const std::uint64_t now = asked.size();
    expectations.emplace_back(now, std::vector<Candidate>(next.begin(), next.end()));
    predicted_ = std::make_shared<Predictions>();
    for (std::size_t i = 1; i < next.size(); ++i) {  // the first is asked for at once: no worker can simulate it ahead
      (*predicted_)[now + i] = next[i];
    }
  }

  [[nodiscard]] std::size_t lookahead() const override { return lookahead_; }

  std::vector<double> fitness(const Candidate& candidate) override {
    if (asked.size() == budget_) {
      throw SearchEnded{};
    }
    const auto found = predicted_before_->find(asked.size());
    predictions.push_back(found == predicted_before_->end() ? Prediction::none
                          : found->second == candidate      ? Prediction::right
                                                            : Prediction::wrong);
    asked.push_back(candidate);
    needed.push_back(needed_);
    scores.push_back(function_(candidate));
    predicted_before_ = predicted_;
    return scores.back();
  }

  void set_needed_score(std::optional<double> score) override { needed_ = score; }
  void mark_restart() override { restarts.push_back(asked.size()); }

  [[nodiscard]] std::size_t count(Prediction kind) const {
    return static_cast<std::size_t>(std::count(predictions.begin(), predictions.end(), kind));
  }

  std::vector<Candidate> asked;
  std::vector<std::vector<double>> scores;
  std::vector<std::optional<double>> needed;
  std::vector<Prediction> predictions;
  std::vector<std::size_t> restarts;  ///< numbers of the evaluations that began one
  std::vector<std::pair<std::uint64_t, std::vector<Candidate>>>
      expectations;  ///< with the number of evaluations before

 private:
  Function function_;
  std::size_t lookahead_;
  std::uint64_t budget_;
  std::optional<double> needed_;
  using Predictions = std::map<std::uint64_t, Candidate>;  ///< by the number of the evaluation
  std::shared_ptr<Predictions> predicted_ = std::make_shared<Predictions>();
  std::shared_ptr<Predictions> predicted_before_ = predicted_;  ///< predicted_ when the last evaluation ended
};

/// Dimensions with these numbers of values.
inline SearchSpace make_space(const std::vector<std::uint32_t>& sizes) {
  SearchSpace space;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    Dimension dimension;
    dimension.name = "amplitude:J" + std::to_string(i);
    Setting target;
    target.joint = static_cast<std::uint8_t>(i);
    dimension.targets = {target};
    for (std::uint32_t value = 0; value < sizes[i]; ++value) {
      dimension.values.push_back(static_cast<std::int32_t>(value));
    }
    space.dimensions.push_back(dimension);
  }
  return space;
}

inline Experiment make_experiment(const std::vector<std::uint32_t>& sizes, const MethodSettings& method,
                                  Goal goal = Goal::maximise, std::size_t objectives = 1) {
  Experiment experiment;
  experiment.path = "test.optimise.xml";
  experiment.space = make_space(sizes);
  experiment.method = method;
  for (std::size_t i = 0; i < objectives; ++i) {
    Objective objective;
    objective.name = "objective" + std::to_string(i);
    objective.goal = goal;
    objective.terms = {Term{}};
    experiment.objectives.push_back(objective);
  }
  return experiment;
}

/// Squared distance from a place.
inline double sphere(const Candidate& candidate, double centre) {
  double sum = 0.0;
  for (const std::uint32_t index : candidate) {
    sum += (index - centre) * (index - centre);
  }
  return sum;
}

/// Many hills on a slope, from about 0 to 3: a function without a pattern that an algorithm could use.
inline double rugged(const Candidate& candidate) {
  double sum = 0.0;
  for (std::size_t i = 0; i < candidate.size(); ++i) {
    const double x = candidate[i];
    sum += 0.03 * x + 0.3 * std::sin(0.9 * x + static_cast<double>(i)) + 0.2 * std::cos(2.3 * x);
  }
  return 1.5 + sum / static_cast<double>(candidate.size());
}

}  // namespace proleg::optimize
