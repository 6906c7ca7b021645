// How trials differ from the scenario. Statistics are over many seeds; the first seed is printed when one fails.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <set>

#include "experiment_files.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

constexpr std::uint64_t first_seed = 4711;
constexpr int draws = 2000;

sim::Scenario small_scenario() {
  static const sim::Scenario scenario = sim::small_scenario().scenario();
  return scenario;
}

sim::Scenario perturbed(const Spread& spread, std::uint64_t seed) {
  sim::Scenario scenario = small_scenario();
  perturb(scenario, spread, seed);
  return scenario;
}

/// A number of a scenario, before and after.
using Quantity = std::function<double(const sim::Scenario&)>;

const Quantity floor_friction = [](const sim::Scenario& scenario) {
  return scenario.environment.objects.at(0).geometries.at(0).friction.value();
};
const Quantity tail_friction = [](const sim::Scenario& scenario) {
  return scenario.robot.links.back().geometries.at(0).friction.value();
};
const Quantity unspecified_friction = [](const sim::Scenario& scenario) {
  return scenario.environment.unspecified_friction;
};
const Quantity head_mass = [](const sim::Scenario& scenario) { return scenario.robot.links[0].mass.mass; };
const Quantity middle_mass = [](const sim::Scenario& scenario) { return scenario.robot.links[1].mass.mass; };
const Quantity head_inertia = [](const sim::Scenario& scenario) { return scenario.robot.links[0].mass.inertia(1, 1); };
const Quantity gain = [](const sim::Scenario& scenario) { return scenario.robot.servo.gain; };

/// Factors on a quantity for many seeds: between 1 - spread and 1 + spread, with the mean and the deviation of an even
/// distribution (spread / sqrt(3)).
std::vector<double> expect_even_factors(const Spread& spread, double width, const Quantity& quantity) {
  const double before = quantity(small_scenario());
  std::vector<double> factors;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    factors.push_back(quantity(perturbed(spread, first_seed + static_cast<std::uint64_t>(i))) / before);
    EXPECT_GE(factors.back(), 1.0 - width);
    EXPECT_LE(factors.back(), 1.0 + width);
    sum += factors.back() - 1.0;
    squares += (factors.back() - 1.0) * (factors.back() - 1.0);
  }
  const double deviation = width / std::sqrt(3.0);
  EXPECT_NEAR(sum / draws, 0.0, 5.0 * deviation / std::sqrt(draws)) << "first seed " << first_seed;
  EXPECT_NEAR(std::sqrt(squares / draws), deviation, 0.1 * deviation) << "first seed " << first_seed;
  EXPECT_LT(std::ranges::min(factors), 1.0 - 0.95 * width);
  EXPECT_GT(std::ranges::max(factors), 1.0 + 0.95 * width);
  return factors;
}

double correlation(const std::vector<double>& left, const std::vector<double>& right) {
  double product = 0.0;
  double left_squares = 0.0;
  double right_squares = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    product += (left[i] - 1.0) * (right[i] - 1.0);
    left_squares += (left[i] - 1.0) * (left[i] - 1.0);
    right_squares += (right[i] - 1.0) * (right[i] - 1.0);
  }
  return product / std::sqrt(left_squares * right_squares);
}

TEST(Perturbation, ScalesEveryFrictionByOneFactorEvenTheUnspecifiedOne) {
  Spread spread;
  spread.friction = 0.3;
  const std::vector<double> factors = expect_even_factors(spread, 0.3, floor_friction);
  for (int i = 0; i < draws; ++i) {
    const sim::Scenario scenario = perturbed(spread, first_seed + static_cast<std::uint64_t>(i));
    const double factor = factors[static_cast<std::size_t>(i)];
    EXPECT_DOUBLE_EQ(tail_friction(scenario), 0.5 * factor);
    EXPECT_DOUBLE_EQ(unspecified_friction(scenario), sim::default_friction * factor);
    EXPECT_FALSE(scenario.robot.links[0].geometries[0].friction) << "it uses the friction of the other surface";
  }
}

TEST(Perturbation, ScalesMassAndInertiaOfEachLinkByItsOwnFactor) {
  Spread spread;
  spread.mass = 0.5;
  const std::vector<double> head = expect_even_factors(spread, 0.5, head_mass);
  const std::vector<double> middle = expect_even_factors(spread, 0.5, middle_mass);
  EXPECT_LT(std::abs(correlation(head, middle)), 0.1) << "first seed " << first_seed;
  const std::vector<double> inertia = expect_even_factors(spread, 0.5, head_inertia);
  for (std::size_t i = 0; i < head.size(); ++i) {
    EXPECT_DOUBLE_EQ(inertia[i], head[i]);
  }
  EXPECT_EQ(perturbed(spread, 1).robot.links[0].mass.center, small_scenario().robot.links[0].mass.center);
}

TEST(Perturbation, ScalesTheGainOfTheServos) {
  Spread spread;
  spread.servo_gain = 0.9;
  expect_even_factors(spread, 0.9, gain);
}

TEST(Perturbation, AddsALatencyFromNothingToTheSpread) {
  Spread spread;
  spread.latency_ms = 20.0;
  double sum = 0.0;
  std::uint32_t least = 100'000;
  std::uint32_t most = 0;
  for (int i = 0; i < draws; ++i) {
    const std::uint32_t latency = perturbed(spread, first_seed + static_cast<std::uint64_t>(i)).robot.servo.latency_us;
    sum += latency;
    least = std::min(least, latency);
    most = std::max(most, latency);
  }
  const double deviation = 20'000.0 / std::sqrt(12.0);
  EXPECT_NEAR(sum / draws, 10'000.0, 5.0 * deviation / std::sqrt(draws)) << "first seed " << first_seed;
  EXPECT_LT(least, 500U);
  EXPECT_GT(most, 19'500U);
  EXPECT_LE(most, 20'000U);
}

TEST(Perturbation, AddsTheLatencyToThatOfTheRobotUpToWhatAServoMayHave) {
  Spread spread;
  spread.latency_ms = 100.0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    sim::Scenario scenario = small_scenario();
    scenario.robot.servo.latency_us = 90'000;
    perturb(scenario, spread, seed);
    EXPECT_GE(scenario.robot.servo.latency_us, 90'000U);
    EXPECT_LE(scenario.robot.servo.latency_us, 100'000U);
  }
}

TEST(Perturbation, SetsTheNoiseOfTheTouchSensors) {
  sim::Scenario scenario = small_scenario();
  scenario.contact_noise = 0.2;
  perturb(scenario, Spread{}, 1);
  EXPECT_EQ(scenario.contact_noise, 0.2);
  Spread spread;
  spread.contact_noise = 0.05;
  perturb(scenario, spread, 1);
  EXPECT_EQ(scenario.contact_noise, 0.05);
}

TEST(Perturbation, SeedsTheScenariosOwnNoise) { EXPECT_EQ(perturbed(Spread{}, 99).kernel.seed, 99U); }

TEST(Perturbation, WithoutASpreadChangesNothingElse) {
  const sim::Scenario before = small_scenario();
  const sim::Scenario after = perturbed(Spread{}, 99);
  for (const Quantity& quantity :
       {floor_friction, tail_friction, unspecified_friction, head_mass, middle_mass, head_inertia, gain}) {
    EXPECT_EQ(quantity(before), quantity(after));
  }
  EXPECT_EQ(before.robot.servo.latency_us, after.robot.servo.latency_us);
}

TEST(Perturbation, OfOneQuantityDoesNotMoveTheDrawsOfTheOthers) {
  Spread all;
  all.friction = 0.3;
  all.mass = 0.4;
  all.servo_gain = 0.5;
  all.latency_ms = 50.0;
  all.contact_noise = 0.1;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const sim::Scenario together = perturbed(all, seed);
    EXPECT_EQ(floor_friction(together), floor_friction(perturbed({.friction = 0.3}, seed)));
    EXPECT_EQ(head_mass(together), head_mass(perturbed({.mass = 0.4}, seed)));
    EXPECT_EQ(middle_mass(together), middle_mass(perturbed({.mass = 0.4}, seed)));
    EXPECT_EQ(gain(together), gain(perturbed({.servo_gain = 0.5}, seed)));
    EXPECT_EQ(together.robot.servo.latency_us, perturbed({.latency_ms = 50.0}, seed).robot.servo.latency_us);
  }
}

TEST(Perturbation, DrawsTheQuantitiesIndependently) {
  Spread spread;
  spread.friction = 0.5;
  spread.mass = 0.5;
  spread.servo_gain = 0.5;
  std::vector<std::vector<double>> factors;
  for (const Quantity& quantity : {floor_friction, head_mass, gain}) {
    factors.push_back(expect_even_factors(spread, 0.5, quantity));
  }
  EXPECT_LT(std::abs(correlation(factors[0], factors[1])), 0.1) << "first seed " << first_seed;
  EXPECT_LT(std::abs(correlation(factors[1], factors[2])), 0.1) << "first seed " << first_seed;
  EXPECT_LT(std::abs(correlation(factors[0], factors[2])), 0.1) << "first seed " << first_seed;
}

TEST(DependenceOnTheSeed, IsThereWithAnySpread) {
  const sim::Scenario scenario = small_scenario();
  EXPECT_FALSE(depends_on_seed(scenario, {}, {}));
  EXPECT_TRUE(depends_on_seed(scenario, {}, {.friction = 0.1}));
  EXPECT_TRUE(depends_on_seed(scenario, {}, {.mass = 0.1}));
  EXPECT_TRUE(depends_on_seed(scenario, {}, {.servo_gain = 0.1}));
  EXPECT_TRUE(depends_on_seed(scenario, {}, {.latency_ms = 1.0}));
  EXPECT_TRUE(depends_on_seed(scenario, {}, {.contact_noise = 0.1}));
}

TEST(DependenceOnTheSeed, IsThereWithNoisyTouchSensors) {
  sim::Scenario scenario = small_scenario();
  scenario.contact_noise = 0.01;
  EXPECT_TRUE(depends_on_seed(scenario, {}, {}));
}

sim::Scenario scenario_with_oscillators() {
  MemoryFiles files = sim::small_scenario();
  files.texts["actuation.xml"] =
      "<actuation><actuationModule name=\"PatternGenerator_coupled_oscillator\"><jointConfiguration joints=\"11\"/>"
      "</actuationModule></actuation>";
  return files.scenario();
}

TEST(DependenceOnTheSeed, IsThereIfAStateStartsWithNoise) {
  sim::Scenario scenario = scenario_with_oscillators();
  EXPECT_TRUE(depends_on_seed(scenario, {}, {})) << "by default it does";
  sim::apply_setting(scenario, "noise=0");
  EXPECT_FALSE(depends_on_seed(scenario, {}, {}));
  sim::apply_setting(scenario, "noise:J2=0.5");
  EXPECT_TRUE(depends_on_seed(scenario, {}, {}));
}

TEST(DependenceOnTheSeed, IsThatOfTheNoiseWhichACandidateMaySet) {
  sim::Scenario scenario = scenario_with_oscillators();
  const int noise = find_parameter(scenario.kernel.slots[0].algorithm->declaration(), "noise");
  ASSERT_GE(noise, 0);
  SearchSpace space;
  space.dimensions.push_back({"noise", {{0, 0, static_cast<std::uint8_t>(noise), false, 0}}, Unit::ratio, {0}});
  EXPECT_TRUE(depends_on_seed(scenario, space, {})) << "the other joint keeps its noise";
  space.dimensions[0].targets.push_back({0, 1, static_cast<std::uint8_t>(noise), false, 0});
  EXPECT_FALSE(depends_on_seed(scenario, space, {})) << "every candidate takes it away";
  sim::apply_setting(scenario, "noise=0");
  space.dimensions[0].values = {0, 1};
  EXPECT_TRUE(depends_on_seed(scenario, space, {}));
}

TEST(TrialSeed, IsAFunctionOfItsNumbers) {
  EXPECT_EQ(trial_seed(1, 2, 3, 4), trial_seed(1, 2, 3, 4));
  // The numbers one after the other through SplitMix64, computed with another program (whose output for the seed 0
  // begins with E220A8397B1DCDAF, as published). Stores hold seeds, so the function may not change.
  EXPECT_EQ(trial_seed(1, 0, 0, 0), 16'321'491'304'643'971'414U);
  EXPECT_EQ(trial_seed(1, 2, 3, 4), 15'374'388'949'593'934'587U);
}

TEST(TrialSeed, IsNeverTheSameForOtherNumbers) {
  std::set<std::uint64_t> seeds;
  std::size_t count = 0;
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{2}, ~std::uint64_t{0}}) {
    for (std::uint32_t run = 0; run < 10; ++run) {
      for (std::uint64_t individual = 0; individual < 500; ++individual) {
        for (std::uint32_t trial = 0; trial < 10; ++trial) {
          seeds.insert(trial_seed(seed, run, individual, trial));
          ++count;
        }
      }
    }
  }
  EXPECT_EQ(seeds.size(), count);
}

TEST(TrialSeed, ChangesHalfOfItsBitsWithAnyBitOfItsNumbersAndEachOfThem) {
  const auto expect_avalanche = [](int bits, const std::function<std::uint64_t(std::uint64_t)>& flipped) {
    constexpr int places = 200;
    for (int bit = 0; bit < bits; ++bit) {
      std::uint64_t toggled = 0;
      int changes = 0;
      for (std::uint64_t i = 0; i < places; ++i) {
        const std::uint64_t difference = trial_seed(i, 3, i * 7, 2) ^ flipped(i << 8U | static_cast<unsigned>(bit));
        toggled |= difference;
        changes += std::popcount(difference);
      }
      EXPECT_EQ(toggled, ~std::uint64_t{0}) << "bit " << bit;
      EXPECT_NEAR(static_cast<double>(changes) / places, 32.0, 2.0) << "bit " << bit;
    }
  };
  const auto one = [](std::uint64_t code) { return std::uint64_t{1} << (code & 63U); };
  const auto short_one = [](std::uint64_t code) { return std::uint32_t{1} << (code & 31U); };
  expect_avalanche(64,
                   [&](std::uint64_t code) { return trial_seed((code >> 8U) ^ one(code), 3, (code >> 8U) * 7, 2); });
  expect_avalanche(
      32, [&](std::uint64_t code) { return trial_seed(code >> 8U, 3 ^ short_one(code), (code >> 8U) * 7, 2); });
  expect_avalanche(64,
                   [&](std::uint64_t code) { return trial_seed(code >> 8U, 3, ((code >> 8U) * 7) ^ one(code), 2); });
  expect_avalanche(
      32, [&](std::uint64_t code) { return trial_seed(code >> 8U, 3, (code >> 8U) * 7, 2 ^ short_one(code)); });
}

}  // namespace
}  // namespace proleg::optimize
