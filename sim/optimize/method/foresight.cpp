#include "sim/optimize/method/foresight.hpp"

#include <algorithm>

namespace proleg::optimize {

namespace {

/// Worse than any cost that can be, and still so small that algorithms can calculate with it.
constexpr double very_bad = 1e30;

/// Ends a rehearsal.
struct SeenEnough {};

}  // namespace

Foresight::Foresight(GaitProblemHub& hub, std::uint32_t population, bool settles)
    : hub_(hub),
      population_(population),
      settles_(settles),
      watch_(std::max(population, static_cast<std::uint32_t>(2 * hub.size() + 3))) {
  hub_.answer = [this](const std::vector<double>& x) { return answer(x); };
}

void Foresight::run(const std::function<void()>& rehearse, const std::function<void()>& perform) {
  rehearse_ = &rehearse;
  answered_.clear();
  expected_.clear();
  next_ = 0;
  expected_all_ = false;
  perform();
}

std::vector<double> Foresight::answer(const std::vector<double>& x) {
  if (rehearsing_) {
    return answer_rehearsal(x);
  }
  const Candidate candidate = hub_.candidate(x);
  if (settles_) {
    watch(x);
  }
  const bool needs_more = asked_ % population_ == 0 && raise_needed_score();
  const bool surprised = remaining() == 0 || expected_[next_] != candidate;
  if (surprised || (!expected_all_ && remaining() < hub_.source().lookahead())) {
    foresee(candidate);
  } else if (needs_more) {
    hub_.source().expect(std::span(expected_).subspan(next_));
  }
  std::vector<double> costs = hub_.costs(hub_.source().fitness(candidate));
  ++next_;
  ++asked_;
  if (!best_cost_ || costs[0] < *best_cost_) {
    best_cost_ = costs[0];
    better_ = true;
  }
  answered_.push_back(costs);
  return costs;
}

std::vector<double> Foresight::answer_rehearsal(const std::vector<double>& x) {
  if (repeated_ < answered_.size()) {
    return answered_[repeated_++];
  }
  if (expected_.size() == 2 * static_cast<std::size_t>(population_) + hub_.source().lookahead()) {
    throw SeenEnough{};
  }
  expected_.push_back(hub_.candidate(x));
  return std::vector<double>(hub_.objectives(), very_bad);
}

bool Foresight::raise_needed_score() {
  if (hub_.objectives() > 1 || !better_) {  // which of several scores should matter?
    return false;
  }
  better_ = false;
  hub_.source().set_needed_score(hub_.costs({*best_cost_})[0]);
  return true;
}

void Foresight::foresee(const Candidate& wanted) {
  expected_.clear();
  next_ = 0;
  repeated_ = 0;
  rehearsing_ = true;
  try {
    (*rehearse_)();
    expected_all_ = true;
  } catch (const SeenEnough&) {
    expected_all_ = false;
  }
  rehearsing_ = false;
  if (expected_.empty() || expected_[0] != wanted) {  // it does not repeat itself, so it cannot be foreseen
    expected_.assign(1, wanted);
    expected_all_ = true;
  }
  hub_.source().expect(expected_);
}

void Foresight::watch(const std::vector<double>& x) {
  if (watched_ >= watch_) {
    bool close = true;
    for (std::size_t i = 0; i < lowest_.size(); ++i) {
      close = close && highest_[i] - lowest_[i] < 0.5;
    }
    if (close || alike_) {
      throw Settled{};
    }
    watched_ = 0;
  }
  if (watched_++ == 0) {
    lowest_ = x;
    highest_ = x;
    first_ = hub_.candidate(x);
    alike_ = true;
    return;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    lowest_[i] = std::min(lowest_[i], x[i]);
    highest_[i] = std::max(highest_[i], x[i]);
  }
  alike_ = alike_ && hub_.candidate(x) == first_;
}

}  // namespace proleg::optimize
