#pragma once

// The trials of a candidate: how they differ from the scenario, and the seeds of an experiment.

#include <cstdint>

#include "sim/scenario/scenario.hpp"

namespace proleg::optimize {

struct SearchSpace;

/// Differences between a candidate's trials and the scenario, so that results hold for more than one friction. Factors
/// are drawn uniformly from 1 - x to 1 + x.
struct Spread {
  double friction = 0.0;    ///< x of one factor on all coefficients of friction; 0 to 0.9
  double mass = 0.0;        ///< x of a factor on mass and inertia, for each link; 0 to 0.9
  double servo_gain = 0.0;  ///< x of one factor on the servo's gain; 0 to 0.9
  double latency_ms = 0.0;  ///< additional latency of the servos, uniform from 0 to this; 0 to 100
  /// Probability that a touch sensor is wrong at a tick, 0 to 1. It replaces the scenario's if it is not 0.
  double contact_noise = 0.0;

  [[nodiscard]] bool any() const {
    return friction > 0.0 || mass > 0.0 || servo_gain > 0.0 || latency_ms > 0.0 || contact_noise > 0.0;
  }
};

/// Variations that a gait for a real robot must stand: friction and servo gain by a fifth, masses by a tenth, up to
/// 10 ms of latency.
[[nodiscard]] constexpr Spread usual_spread() { return {0.2, 0.1, 0.2, 10.0, 0.0}; }

enum class Aggregate : std::uint8_t { mean, worst };

/// Common: all candidates of a repetition meet the same worlds (trial 3 of one candidate has the friction of trial 3 of
/// another), so that scores differ only through the candidates. Fresh: each evaluation draws its own worlds.
enum class RandomNumbers : std::uint8_t { common, fresh };

inline constexpr std::uint32_t max_trials = 1000;

struct Trials {
  std::uint32_t count = 1;  ///< runs of one candidate; 1 to max_trials
  Aggregate aggregate = Aggregate::mean;
  RandomNumbers random_numbers = RandomNumbers::common;
  Spread spread;
};

/// Perturbs a scenario with random factors of the seed, and sets the seed of its own noise. The draws for one quantity
/// do not depend on the spread of the others.
void perturb(sim::Scenario& scenario, const Spread& spread, std::uint64_t seed);

/// Whether a run depends on the seed: through the spread, noise in the start state of an algorithm, or noise of the
/// touch sensors. (A candidate may set the noise: a dimension of that name counts.)
[[nodiscard]] bool depends_on_seed(const sim::Scenario& scenario, const SearchSpace& space, const Spread& spread);

/// Seed of a trial, which depends only on these numbers.
[[nodiscard]] std::uint64_t trial_seed(std::uint64_t experiment_seed, std::uint32_t run, std::uint64_t individual,
                                       std::uint32_t trial);

/// Scatters the 64 bits of a number, one to one: a bijection whose every output bit depends on every input bit (the
/// output function of SplitMix64: G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators",
/// OOPSLA 2014).
[[nodiscard]] constexpr std::uint64_t scatter(std::uint64_t bits) {
  bits += 0x9E3779B97F4A7C15U;  // without this addition 0 would give 0
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBU;
  return bits ^ (bits >> 31U);
}

/// Seed of the random numbers of an optimiser in a run of an experiment. It differs from the seeds of the trials.
[[nodiscard]] constexpr std::uint64_t method_seed(std::uint64_t experiment_seed, std::uint32_t run) {
  return scatter(scatter(experiment_seed ^ 0x6D6574686F64U) + run);
}

}  // namespace proleg::optimize
