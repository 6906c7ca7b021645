#include "sim/optimize/method/request_predictor.hpp"

#include <algorithm>

namespace proleg::optimize {

namespace {

/// A cost worse than any possible one, and small enough that algorithms can calculate with it.
constexpr double very_bad_cost = 1e30;

/// Thrown through the algorithm to end a rehearsal.
struct EnoughPredicted {};

}  // namespace

RequestPredictor::RequestPredictor(GaitProblemHub& hub, std::uint32_t population, bool stagnates)
    : hub_(hub),
      population_(population),
      stagnates_(stagnates),
      min_checked_(std::max(population, static_cast<std::uint32_t>(2 * hub.size() + 3))) {
  hub_.answer = [this](const std::vector<double>& x) { return answer(x); };
}

void RequestPredictor::run(const std::function<void()>& rehearse, const std::function<void()>& perform) {
  rehearse_ = &rehearse;
  answered_.clear();
  expected_.clear();
  next_ = 0;
  expected_all_ = false;
  perform();
}

std::vector<double> RequestPredictor::answer(const std::vector<double>& x) {
  if (is_rehearsing_) {
    return answer_rehearsal(x);
  }
  const Candidate candidate = hub_.candidate(x);
  if (stagnates_) {
    check_stagnation(x);
  }
  const bool needs_more = asked_ % population_ == 0 && raise_needed_score();
  const bool is_unpredicted = remaining() == 0 || expected_[next_] != candidate;
  if (is_unpredicted || (!expected_all_ && remaining() < hub_.source().lookahead())) {
    predict(candidate);
  } else if (needs_more) {
    hub_.source().expect(std::span(expected_).subspan(next_));
  }
  std::vector<double> costs = hub_.costs(hub_.source().fitness(candidate));
  ++next_;
  ++asked_;
  if (!best_cost_ || costs[0] < *best_cost_) {
    best_cost_ = costs[0];
    has_new_best_ = true;
  }
  answered_.push_back(costs);
  return costs;
}

std::vector<double> RequestPredictor::answer_rehearsal(const std::vector<double>& x) {
  if (repeated_ < answered_.size()) {
    return answered_[repeated_++];
  }
  if (expected_.size() == 2 * static_cast<std::size_t>(population_) + hub_.source().lookahead()) {
    throw EnoughPredicted{};
  }
  expected_.push_back(hub_.candidate(x));
  return std::vector<double>(hub_.objectives(), very_bad_cost);
}

bool RequestPredictor::raise_needed_score() {
  if (hub_.objectives() > 1 || !has_new_best_) {  // with several scores none of them decides
    return false;
  }
  has_new_best_ = false;
  hub_.source().set_needed_score(hub_.costs({*best_cost_})[0]);
  return true;
}

void RequestPredictor::predict(const Candidate& wanted) {
  expected_.clear();
  next_ = 0;
  repeated_ = 0;
  is_rehearsing_ = true;
  try {
    (*rehearse_)();
    expected_all_ = true;
  } catch (const EnoughPredicted&) {
    expected_all_ = false;
  }
  is_rehearsing_ = false;
  if (expected_.empty() ||
      expected_[0] != wanted) {  // the algorithm does not repeat its requests, so they cannot be predicted
    expected_.assign(1, wanted);
    expected_all_ = true;
  }
  hub_.source().expect(expected_);
}

void RequestPredictor::check_stagnation(const std::vector<double>& x) {
  if (checked_ >= min_checked_) {
    bool is_close = true;
    for (std::size_t i = 0; i < min_.size(); ++i) {
      is_close = is_close && max_[i] - min_[i] < 0.5;
    }
    if (is_close || all_equal_) {
      throw Stagnated{};
    }
    checked_ = 0;
  }
  if (checked_++ == 0) {
    min_ = x;
    max_ = x;
    first_ = hub_.candidate(x);
    all_equal_ = true;
    return;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    min_[i] = std::min(min_[i], x[i]);
    max_[i] = std::max(max_[i], x[i]);
  }
  all_equal_ = all_equal_ && hub_.candidate(x) == first_;
}

}  // namespace proleg::optimize
