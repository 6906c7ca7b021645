
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <pagmo/algorithm.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <vector>

#include "sim/optimize/experiment/trials.hpp"
#include "sim/optimize/method/gait_problem.hpp"
#include "sim/optimize/method/pagmo_algorithms.hpp"

namespace proleg::optimize {
namespace {

/// Predicts the requests of an algorithm of pagmo, so that workers can simulate ahead. (pagmo requests one fitness
/// after the other.)
///
/// Rehearses the algorithm on copies. A copy receives the answers that the algorithm has received since the copy was
/// made, and then a very bad fitness for all other requests. These requests are those of the algorithm if no good
/// candidate is found. Most algorithms do not use a fitness before the end of a generation, so the prediction is right
/// until then. When it is wrong, the algorithm is rehearsed again. The algorithm itself does not see the rehearsals.
class RequestPredictor {
 public:
  /// Thrown through an algorithm that stagnates, when its candidates no longer differ.
  struct Stagnated {};

  /// evaluator receives the requests of the algorithm's problem; it must outlive the predictor, which answers them from
  /// now on. population: number of evaluations in a generation. stagnates: whether to end when all requests of a
  /// generation lie within half a step, or are the same candidate.
  RequestPredictor(GaitEvaluator& evaluator, std::uint32_t population, bool stagnates);

  /// Runs `perform`. rehearse: does the work of `perform` on copies, any number of times, and changes nothing else.
  void run(const std::function<void()>& rehearse, const std::function<void()>& perform);

  [[nodiscard]] std::uint64_t asked() const { return asked_; }  ///< number of requests in all runs

 private:
  std::vector<double> answer(const std::vector<double>& x);
  std::vector<double> answer_rehearsal(const std::vector<double>& x);
  void predict(const Candidate& wanted);
  bool raise_needed_score();  ///< returns whether it raised the score
  void check_stagnation(const std::vector<double>& x);
  [[nodiscard]] std::size_t remaining() const { return expected_.size() - next_; }

  GaitEvaluator& evaluator_;
  std::uint32_t population_;
  bool stagnates_;
  std::uint64_t asked_ = 0;
  std::optional<double> best_cost_;
  bool has_new_best_ = false;  ///< a new best since the source last received the needed score

  const std::function<void()>* rehearse_ = nullptr;
  std::vector<std::vector<double>> answered_;  ///< costs of the requests in this run
  std::vector<Candidate> expected_;            ///< the predicted requests, from next_ on
  std::size_t next_ = 0;
  bool is_rehearsing_ = false;
  std::size_t repeated_ = 0;   ///< number of answered_ that the rehearsal has repeated
  bool expected_all_ = false;  ///< whether expected_ reaches to the end of the run

  // Bounds of the requests since the generation began.
  std::vector<double> min_;
  std::vector<double> max_;
  Candidate first_;
  bool all_equal_ = true;
  std::uint32_t checked_ = 0;
  std::uint32_t min_checked_ = 0;  ///< evaluations before a verdict
};

/// A cost worse than any possible one, and small enough that algorithms can calculate with it.
constexpr double very_bad_cost = 1e30;

/// Thrown through the algorithm to end a rehearsal.
struct EnoughPredicted {};

RequestPredictor::RequestPredictor(GaitEvaluator& evaluator, std::uint32_t population, bool stagnates)
    : evaluator_(evaluator),
      population_(population),
      stagnates_(stagnates),
      min_checked_(std::max(population, static_cast<std::uint32_t>(2 * evaluator.size() + 3))) {
  evaluator_.answer = [this](const std::vector<double>& x) { return answer(x); };
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
  const Candidate candidate = evaluator_.candidate(x);
  if (stagnates_) {
    check_stagnation(x);
  }
  const bool needs_more = asked_ % population_ == 0 && raise_needed_score();
  const bool is_unpredicted = remaining() == 0 || expected_[next_] != candidate;
  if (is_unpredicted || (!expected_all_ && remaining() < evaluator_.source().lookahead())) {
    predict(candidate);
  } else if (needs_more) {
    evaluator_.source().expect(std::span(expected_).subspan(next_));
  }
  std::vector<double> costs = evaluator_.costs(evaluator_.source().fitness(candidate));
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
  if (expected_.size() == 2 * static_cast<std::size_t>(population_) + evaluator_.source().lookahead()) {
    throw EnoughPredicted{};
  }
  expected_.push_back(evaluator_.candidate(x));
  return std::vector<double>(evaluator_.objectives(), very_bad_cost);
}

bool RequestPredictor::raise_needed_score() {
  if (evaluator_.objectives() > 1 || !has_new_best_) {  // with several scores none of them decides
    return false;
  }
  has_new_best_ = false;
  evaluator_.source().set_needed_score(evaluator_.costs({*best_cost_})[0]);
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
  evaluator_.source().expect(expected_);
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
    first_ = evaluator_.candidate(x);
    all_equal_ = true;
    return;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    min_[i] = std::min(min_[i], x[i]);
    max_[i] = std::max(max_[i], x[i]);
  }
  all_equal_ = all_equal_ && evaluator_.candidate(x) == first_;
}

double spread_of_costs(const pagmo::population& population) {
  const auto [min, max] = std::ranges::minmax(population.get_f(), {}, [](const auto& costs) { return costs[0]; });
  const double spread = max[0] - min[0];
  return spread > 0.0 ? spread : 1.0;
}

double max_index(const GaitEvaluator& evaluator) {
  double max = 0.0;
  for (std::size_t i = 0; i < evaluator.size(); ++i) {
    max = std::max(max, evaluator.last_index(i));
  }
  return max;
}

/// Whether all individuals are the same candidate.
bool is_one_candidate(const pagmo::population& population, const GaitEvaluator& evaluator) {
  const auto& places = population.get_x();
  const Candidate first = evaluator.candidate(places.front());
  return std::ranges::all_of(places, [&](const auto& place) { return evaluator.candidate(place) == first; });
}

/// Runs searches one after another, each from its own population, until the generations are used up.
class PagmoSearch {
 public:
  PagmoSearch(const Experiment& experiment, std::uint64_t seed, FitnessSource& source)
      : settings_(std::get<PagmoSettings>(experiment.method)),
        chosen_(*find_pagmo_algorithm(settings_.algorithm)),
        seed_(seed),
        evaluator_(experiment.space, experiment.objectives, source),
        own_values_(settings_.start == Start::scenario
                        ? std::optional(evaluator_.numbers(experiment.space.nearest(experiment.scenario)))
                        : std::nullopt),
        problem_(GaitProblem{evaluator_}),
        generations_(chosen_.evolves_by_generation ? settings_.generations : std::min(settings_.generations, 1U)) {
    source.set_needed_score(std::nullopt);
  }

  std::string run() {
    for (std::uint64_t start = 0;; ++start) {
      if (start > 0) {
        evaluator_.source().mark_restart();
      }
      const std::string ending = run_from(start == 0 ? seed_ : scatter(seed_ + start));
      if (settings_.restart_after == 0 || !chosen_.evolves_by_generation || generations_ == 0) {
        return ending;
      }
    }
  }

 private:
  /// Searches for at least one generation, until none is left or the search converges. Returns why it ended.
  std::string run_from(std::uint64_t seed) {
    RequestPredictor predictor(evaluator_, settings_.population, chosen_.stagnates);
    try {
      pagmo::population population;
      predictor.run([&] { static_cast<void>(make_population(seed)); }, [&] { population = make_population(seed); });
      own_values_.reset();
      const pagmo::algorithm algorithm = chosen_.make({.settings = settings_,
                                                       .seed = static_cast<unsigned>(seed >> 32U),
                                                       .variables = evaluator_.size(),
                                                       .max_index = max_index(evaluator_),
                                                       .cost_spread = spread_of_costs(population),
                                                       .objectives = evaluator_.objectives()});
      double best = best_cost(population);
      std::uint32_t without_gain = 0;
      while (generations_ > 0 && (without_gain < settings_.restart_after || settings_.restart_after == 0)) {
        --generations_;
        // evolve() changes the state of the algorithm; the copy has the state before it.
        const pagmo::algorithm before = algorithm;
        const std::uint64_t asked_before = predictor.asked();
        predictor.run([&] { static_cast<void>(pagmo::algorithm(before).evolve(population)); },
                      [&] { population = algorithm.evolve(population); });
        const std::uint64_t due =
            chosen_.evolves_by_generation ? 1 : std::uint64_t{settings_.generations} * settings_.population;
        if (predictor.asked() - asked_before < due || (chosen_.stagnates && is_one_candidate(population, evaluator_))) {
          return "converged";
        }
        const double now = best_cost(population);
        const bool gained = now < best && best - now >= 0.001 * std::abs(best);
        without_gain = gained ? 0 : without_gain + 1;
        best = gained ? now : best;
      }
    } catch (const RequestPredictor::Stagnated&) {
      return "converged";
    }
    return "generations used up";
  }

  [[nodiscard]] pagmo::population make_population(std::uint64_t seed) const {
    const std::uint32_t random = settings_.population - (own_values_ ? 1 : 0);
    pagmo::population population(problem_, random, static_cast<unsigned>(seed));
    if (own_values_) {
      population.push_back(*own_values_);
    }
    return population;
  }

  /// Best cost of the first objective.
  static double best_cost(const pagmo::population& population) {
    return std::ranges::min(population.get_f(), {}, [](const auto& costs) { return costs[0]; })[0];
  }

  const PagmoSettings& settings_;
  const PagmoAlgorithm& chosen_;
  std::uint64_t seed_;
  GaitEvaluator evaluator_;
  std::optional<std::vector<double>> own_values_;  ///< values in the first population of the first start
  pagmo::problem problem_;
  std::uint64_t generations_;  ///< number of generations left
};

}  // namespace

std::string search_with_pagmo(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  return PagmoSearch(experiment, method_seed(experiment.seed, run), source).run();
}

}  // namespace proleg::optimize
