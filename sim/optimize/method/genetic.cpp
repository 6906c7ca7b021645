#include "sim/optimize/method/genetic.hpp"

#include <cmath>
#include <deque>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include <ga/GA1DArrayGenome.h>
#include <ga/GASStateGA.h>
#include <ga/GAScaling.h>
#include <ga/GASimpleGA.h>
#include <ga/garandom.h>

#include "sim/optimize/experiment/trials.hpp"

namespace proleg::optimize {
namespace {

using Genome = GA1DArrayAlleleGenome<int>;

/// Connects GAlib, which calls plain functions with pointers, to the source.
class Rating {
 public:
  Rating(const Objective& objective, FitnessSource& source) : objective_(objective), source_(source) {}

  /// GAPopulation::evaluator: evaluates the individuals without a score, in the order of the population.
  static void rate(GAPopulation& population) {
    auto& self = *static_cast<Rating*>(population.userData());
    self.unrated_.clear();
    for (int i = 0; i < population.size(); ++i) {
      population.individual(static_cast<unsigned>(i)).evaluate();
    }
    self.rate_collected();
  }

  /// GAGenome::evaluator: GAlib calls it for the individuals without a score.
  static float collect(GAGenome& genome) {
    static_cast<Rating*>(genome.userData())->unrated_.push_back(&genome);
    return 0.0F;
  }

  /// GAGenome::Initializer: sets random values; the first individual has the start, if this exists.
  static void initialise(GAGenome& genome) {
    Genome::UniformInitializer(genome);
    auto& self = *static_cast<Rating*>(genome.userData());
    if (self.start) {
      auto& genes = dynamic_cast<Genome&>(genome);
      for (std::size_t i = 0; i < self.start->size(); ++i) {
        genes.gene(static_cast<unsigned>(i), static_cast<int>((*self.start)[i]));
      }
      self.start.reset();
    }
  }

  std::optional<Candidate> start;  ///< values of the next individual that is initialised

  /// The exception that ended the search; null while it runs. An exception through GAlib would leak its memory.
  [[nodiscard]] const std::exception_ptr& ended() const { return ended_; }

 private:
  void rate_collected() {
    if (ended_) {
      return;  // nothing uses the scores after the end
    }
    try {
      if (best_) {
        source_.set_needed_score(best_);
      }
      std::vector<Candidate> candidates;
      candidates.reserve(unrated_.size());
      for (const GAGenome* genome : unrated_) {
        candidates.push_back(candidate_of(dynamic_cast<const Genome&>(*genome)));
      }
      source_.expect(candidates);
      for (std::size_t i = 0; i < candidates.size(); ++i) {
        const double score = source_.fitness(candidates[i]).front();
        if (!best_ || objective_.better(score, *best_)) {
          best_ = score;
        }
        unrated_[i]->score(static_cast<float>(score));
      }
    } catch (...) {
      ended_ = std::current_exception();
    }
  }

  static Candidate candidate_of(const Genome& genome) {
    Candidate candidate;
    for (unsigned i = 0; i < static_cast<unsigned>(genome.length()); ++i) {
      candidate.push_back(static_cast<std::uint32_t>(genome.gene(i)));
    }
    return candidate;
  }

  const Objective& objective_;
  FitnessSource& source_;
  std::vector<GAGenome*> unrated_;
  std::optional<double> best_;
  std::exception_ptr ended_;
};

GAAlleleSet<int> make_alleles(const Dimension& dimension) {
  std::vector<int> indices(dimension.values.size());
  std::iota(indices.begin(), indices.end(), 0);
  return {static_cast<unsigned>(indices.size()), indices.data()};
}

Genome make_genome(const SearchSpace& space, Rating& rating) {
  // An empty array would make GAlib copy from a null pointer.
  GAAlleleSetArray<int> alleles(make_alleles(space.dimensions.front()));
  for (std::size_t i = 1; i < space.dimensions.size(); ++i) {
    alleles.add(make_alleles(space.dimensions[i]));
  }
  Genome genome(alleles, Rating::collect, &rating);
  genome.initializer(Rating::initialise);
  genome.crossover(Genome::UniformCrossover);
  return genome;
}

/// GAlib's seed: below 2^31 for all platforms. Its lower 18 bits must not be 0, or every coin toss would be the same.
unsigned galib_seed(const Experiment& experiment, std::uint32_t run) {
  const std::uint64_t seed = method_seed(experiment.seed, run);
  const auto upper = static_cast<unsigned>(seed >> 32U) & 0xFFFU;
  const auto lower = static_cast<unsigned>(seed % ((1U << 18U) - 1U)) + 1U;
  return upper << 18U | lower;
}

/// Limit of the quotient of best scores. When GAlib minimises, it compares the inverse quotient.
float convergence_limit(const GeneticSettings& settings, Goal goal) {
  if (goal == Goal::maximise) {
    return static_cast<float>(settings.convergence);
  }
  constexpr float max = std::numeric_limits<float>::max();
  return settings.convergence * max > 1.0 ? static_cast<float>(1.0 / settings.convergence) : max;
}

std::unique_ptr<GAGeneticAlgorithm> make_algorithm(const GAPopulation& population, GeneticSettings::Mode mode) {
  if (mode == GeneticSettings::Mode::steady_state) {
    return std::make_unique<GASteadyStateGA>(population);
  }
  return std::make_unique<GASimpleGA>(population);
}

/// GAlib's criterion: the search ends when the best score of N - 1 generations ago over the best now is at least
/// `convergence`. GAlib does not divide by 0 and would continue for ever, so N generations with a best of 0 also end
/// the search.
class RatioConvergence {
 public:
  RatioConvergence(const GeneticSettings& settings, Goal goal, GAGeneticAlgorithm& algorithm)
      : algorithm_(algorithm), generations_(settings.generations_to_convergence) {
    algorithm.nConvergence(generations_);
    algorithm.pConvergence(convergence_limit(settings, goal));
    algorithm.terminator(GAGeneticAlgorithm::TerminateUponConvergence);
  }

  bool is_reached() {
    zeros_ = algorithm_.population().best().score() == 0.0F ? zeros_ + 1 : 0;
    return algorithm_.done() == gaTrue || zeros_ >= generations_;
  }

 private:
  GAGeneticAlgorithm& algorithm_;
  std::uint32_t generations_;
  std::uint32_t zeros_ = 0;  ///< number of the latest generations with a best of 0
};

/// The criterion for scores of both signs: in N - 1 generations the best score has improved by no more than the share
/// 1 - `convergence` of its size. For scores above 0 that are maximised it equals the condition of RatioConvergence.
class GainConvergence {
 public:
  GainConvergence(const GeneticSettings& settings, GAGeneticAlgorithm& algorithm)
      : algorithm_(algorithm), settings_(settings) {}

  bool is_reached() {
    best_.push_back(algorithm_.population().best().score());
    if (best_.size() < settings_.generations_to_convergence) {
      return false;
    }
    const double gain = std::abs(best_.back() - best_.front());
    best_.pop_front();
    return gain <= (1.0 - settings_.convergence) * std::abs(best_.back());
  }

 private:
  GAGeneticAlgorithm& algorithm_;
  const GeneticSettings& settings_;
  std::deque<double> best_;  ///< best scores of the latest generations
};

std::string evolve(GAGeneticAlgorithm& algorithm, const Rating& rating, const std::function<bool()>& has_converged) {
  algorithm.initialize();
  for (;;) {
    if (rating.ended()) {
      std::rethrow_exception(rating.ended());
    }
    if (has_converged()) {
      return "converged";
    }
    algorithm.step();
  }
}

}  // namespace

std::string search_genetic(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  const auto& settings = std::get<GeneticSettings>(experiment.method);
  const Objective& objective = experiment.objectives.front();
  Rating rating(objective, source);
  source.set_needed_score(std::nullopt);
  if (settings.start == Start::scenario) {
    rating.start = experiment.space.nearest(experiment.scenario);
  }

  GAPopulation population(make_genome(experiment.space, rating), settings.population);
  population.userData(&rating);
  population.evaluator(Rating::rate);
  if (objective.may_be_negative()) {
    population.scaling(GASigmaTruncationScaling());  // linear scaling takes no scores below 0
  }
  const std::unique_ptr<GAGeneticAlgorithm> algorithm = make_algorithm(population, settings.mode);
  algorithm->minimaxi(objective.goal == Goal::maximise ? GAGeneticAlgorithm::MAXIMIZE : GAGeneticAlgorithm::MINIMIZE);
  algorithm->pMutation(static_cast<float>(settings.mutation));
  algorithm->pCrossover(static_cast<float>(settings.crossover));

  // initialize(seed) would continue the sequence if the search before had the same seed.
  GAResetRNG(galib_seed(experiment, run));
  if (objective.may_be_negative()) {
    GainConvergence convergence(settings, *algorithm);
    return evolve(*algorithm, rating, [&] { return convergence.is_reached(); });
  }
  RatioConvergence convergence(settings, objective.goal, *algorithm);
  return evolve(*algorithm, rating, [&] { return convergence.is_reached(); });
}

}  // namespace proleg::optimize
