#include <gtest/gtest.h>

#include "sim/loop/simulation.hpp"
#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

class RacingTrial : public testing::Test {
 protected:
  RacingTrial() { experiment_.racing.after = 0.25; }

  [[nodiscard]] TrialResult run(std::optional<double> hopeless_below) const {
    return run_trial(experiment_, {0, 0, 0, candidate_, hopeless_below});
  }

  /// Distance after some ticks.
  [[nodiscard]] double distance(std::uint32_t ticks) const {
    sim::Scenario scenario = experiment_.scenario;
    experiment_.space.apply(candidate_, scenario);
    sim::Simulation simulation(scenario);
    while (simulation.tick() < ticks) {
      simulation.advance();
    }
    return simulation.plant().displacement();
  }

  Experiment experiment_ = small_experiment(0.5);
  Candidate candidate_{3, 3, 1};
};

TEST_F(RacingTrial, StopsAtTheTickNearestItsShareWithTheExtrapolatedDistance) {
  // 12.5 ticks, rounded away from zero.
  const double extrapolated = distance(13) / (13.0 / 50.0);
  ASSERT_GT(extrapolated, 0.0);
  const TrialResult result = run(extrapolated * 1.001);
  EXPECT_TRUE(result.given_up);
  EXPECT_EQ(result.simulated_s, 0.13);
  EXPECT_EQ(result.measures[sim::Measure::distance], extrapolated);
  EXPECT_EQ(result.failure, "");
}

TEST_F(RacingTrial, DoesNotChangeTheResultOfATrialThatContinues) {
  const double extrapolated = distance(13) / (13.0 / 50.0);
  const TrialResult result = run(extrapolated * 0.999);
  EXPECT_FALSE(result.given_up);
  EXPECT_EQ(exact(result), exact(run(std::nullopt)));
  EXPECT_EQ(result.simulated_s, 0.5);
}

TEST_F(RacingTrial, WithoutALimitOrSwitchedOffRunsToTheEnd) {
  EXPECT_FALSE(run(std::nullopt).given_up);
  experiment_.racing.after = 0.0;
  EXPECT_FALSE(run(1000.0).given_up);
}

TEST_F(RacingTrial, JudgesASpeedByTheSpeedSoFar) {
  experiment_.objectives = {{"speed", {{sim::Measure::speed, 1.0}}, Goal::maximise, 0.0}};
  experiment_.racing.after = 0.5;
  sim::Scenario scenario = experiment_.scenario;
  experiment_.space.apply(candidate_, scenario);
  sim::Simulation simulation(scenario);
  while (simulation.tick() < 25) {
    simulation.advance();
  }
  const double speed = simulation.measures()[sim::Measure::speed];
  EXPECT_TRUE(run(speed + 1e-9).given_up);
  EXPECT_FALSE(run(speed - 1e-9).given_up);
  EXPECT_EQ(run(speed + 1e-9).measures[sim::Measure::speed], speed + 0.0);
}

}  // namespace
}  // namespace proleg::optimize
