#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// Turns a vector of numbers into a candidate and its costs. All copies that pagmo makes of a GaitProblem share one, so
/// it is a class of its own.
///
/// The vector has one number for each dimension that has a choice (more than one value): the index of its value, as a
/// real number from 0 to n - 1. The candidate is at the nearest index. So the step of every value set is 1.
class GaitEvaluator {
 public:
  /// All three arguments must outlive the evaluator.
  GaitEvaluator(const SearchSpace& space, const std::vector<Objective>& objectives, FitnessSource& source);

  [[nodiscard]] std::size_t size() const { return choices_.size(); }  ///< length of the vectors
  [[nodiscard]] std::size_t objectives() const { return objectives_.size(); }
  [[nodiscard]] double last_index(std::size_t i) const;  ///< n - 1 of the i-th dimension that has a choice
  /// The candidate nearest to x. Numbers outside the range count as its end, and NaN as 0.
  [[nodiscard]] Candidate candidate(const std::vector<double>& x) const;
  [[nodiscard]] std::vector<double> numbers(const Candidate& candidate) const;
  /// The costs that pagmo minimises, one for each objective. The same function turns costs into scores.
  [[nodiscard]] std::vector<double> costs(const std::vector<double>& scores) const;
  [[nodiscard]] FitnessSource& source() const { return source_; }

  /// Answers a GaitProblem with the costs of x. By default it requests them from the source.
  std::function<std::vector<double>(const std::vector<double>&)> answer;

 private:
  const SearchSpace& space_;
  const std::vector<Objective>& objectives_;
  FitnessSource& source_;
  std::vector<std::size_t> choices_;  ///< dimensions that have a choice
};

/// The search for a gait as a problem of pagmo (a "user-defined problem": F. Biscani, D. Izzo, "A parallel global
/// multiobjective framework for optimization: pagmo", J. Open Source Software 5, 2020).
class GaitProblem {
 public:
  GaitProblem() = default;  ///< required by pagmo; never evaluated
  /// evaluator must outlive all copies; its size() is at least 1.
  explicit GaitProblem(GaitEvaluator& evaluator) : evaluator_(&evaluator) {}

  [[nodiscard]] std::vector<double> fitness(const std::vector<double>& x) const { return evaluator_->answer(x); }
  [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> get_bounds() const;
  [[nodiscard]] std::vector<double>::size_type get_nobj() const {
    return evaluator_ == nullptr ? 1 : evaluator_->objectives();
  }
  [[nodiscard]] std::string get_name() const { return "gait"; }
  [[nodiscard]] GaitEvaluator& evaluator() const { return *evaluator_; }

 private:
  GaitEvaluator* evaluator_ = nullptr;
};

}  // namespace proleg::optimize
