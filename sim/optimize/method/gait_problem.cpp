#include "sim/optimize/method/gait_problem.hpp"

#include <cmath>

namespace proleg::optimize {

GaitEvaluator::GaitEvaluator(const SearchSpace& space, const std::vector<Objective>& objectives, FitnessSource& source)
    : space_(space), objectives_(objectives), source_(source) {
  for (std::size_t i = 0; i < space.dimensions.size(); ++i) {
    if (space.dimensions[i].values.size() > 1) {
      choices_.push_back(i);
    }
  }
  answer = [this](const std::vector<double>& x) { return costs(source_.fitness(candidate(x))); };
}

double GaitEvaluator::last_index(std::size_t i) const {
  return static_cast<double>(space_.dimensions[choices_[i]].values.size() - 1);
}

Candidate GaitEvaluator::candidate(const std::vector<double>& x) const {
  Candidate result(space_.dimensions.size(), 0);
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    if (x[i] > 0.0) {  // false for NaN
      result[choices_[i]] = static_cast<std::uint32_t>(std::floor(std::fmin(x[i], last_index(i)) + 0.5));
    }
  }
  return result;
}

std::vector<double> GaitEvaluator::numbers(const Candidate& candidate) const {
  std::vector<double> result;
  result.reserve(choices_.size());
  for (const std::size_t dimension : choices_) {
    result.push_back(candidate[dimension]);
  }
  return result;
}

std::vector<double> GaitEvaluator::costs(const std::vector<double>& scores) const {
  std::vector<double> result;
  result.reserve(objectives_.size());
  for (std::size_t i = 0; i < objectives_.size(); ++i) {
    result.push_back(objectives_[i].cost(scores[i]));
  }
  return result;
}

std::pair<std::vector<double>, std::vector<double>> GaitProblem::get_bounds() const {
  if (evaluator_ == nullptr) {
    return {{0.0}, {1.0}};
  }
  std::pair<std::vector<double>, std::vector<double>> bounds;
  for (std::size_t i = 0; i < evaluator_->size(); ++i) {
    bounds.first.push_back(0.0);
    bounds.second.push_back(evaluator_->last_index(i));
  }
  return bounds;
}

}  // namespace proleg::optimize
