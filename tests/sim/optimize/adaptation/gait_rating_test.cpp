#include "sim/optimize/adaptation/gait_rating.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shipped_atlas.hpp"
#include "sim/optimize/adaptation/simulated_robot.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/scenario/damage.hpp"

namespace proleg::optimize {
namespace {

/// Of a search in the reduced engine, with runs of one second.
Atlas short_atlas() {
  Atlas atlas = small_atlas();
  atlas.experiment.scenario.environment.engine = sim::PhysicsEngine::reduced;
  atlas.experiment.scenario.duration_s = 1.0;
  return atlas;
}

TEST(GaitRating, IsForTheLengthOfATrialInTheEngineOfTheSearch) {
  Atlas atlas = short_atlas();
  rate_for_length(
      atlas, 1.0, [](double) { FAIL() << "the atlas has this length"; }, [] { return false; });
  EXPECT_EQ(atlas.gaits[0].score, 1.25);
  double done = 0.0;
  rate_for_length(
      atlas, 2.0, [&](double share) { done = share; }, [] { return false; });
  EXPECT_EQ(done, 1.0);
  ASSERT_EQ(atlas.gaits.size(), 2U);
  sim::Scenario scenario = short_atlas().experiment.scenario;
  scenario.duration_s = 2.0;
  SimulatedRobot robot(atlas.experiment, scenario, {}, [] { return false; });
  for (const AtlasGait& gait : atlas.gaits) {
    EXPECT_EQ(gait.score, robot.try_gait(gait.candidate).score);
  }
}

TEST(GaitRating, EndsInTheTickInWhichItIsStopped) {
  Atlas atlas = short_atlas();
  std::atomic<int> asked = 0;
  EXPECT_THROW(rate_for_length(
                   atlas, 1e6, [](double) { FAIL() << "nothing is done"; }, [&] { return ++asked > 100; }),
               SearchEnded);
  atlas.experiment.scenario.duration_s = 1e6;
  asked = 0;
  const std::vector<std::string> damages{"powerless:J1", "powerless:J2", "powerless:J3"};
  EXPECT_THROW(static_cast<void>(rate_with_damages(
                   atlas, damages, [](double) { FAIL() << "nothing is done"; }, [&] { return ++asked > 100; })),
               SearchEnded);
}

TEST(GaitRating, IsRefusedForAMapThatARobotHasFilled) {
  Atlas atlas = short_atlas();
  atlas.experiment.on_robot = true;
  EXPECT_THROW(rate_for_length(
                   atlas, 2.0, [](double) {}, [] { return false; }),
               StoreError);
}

TEST(GaitRating, WithADamageIsThatOfARobotThatHasIt) {
  const Atlas atlas = short_atlas();
  const std::vector<std::string> damages{"jammed:J3=20", "friction=50%", "powerless:J2"};
  std::vector<double> shares;
  const DamageScores scores = rate_with_damages(
      atlas, damages, [&](double share) { shares.push_back(share); }, [] { return false; });
  EXPECT_EQ(shares.size(), 3U);
  EXPECT_EQ(shares.back(), 1.0);
  ASSERT_EQ(scores.size(), 3U);
  for (const std::string& damage : damages) {
    sim::Scenario scenario = atlas.experiment.scenario;
    sim::apply_damage(scenario, {damage});
    SimulatedRobot robot(atlas.experiment, scenario, {}, [] { return false; });
    for (std::size_t gait = 0; gait < atlas.gaits.size(); ++gait) {
      EXPECT_EQ(scores.at(damage)[gait], robot.try_gait(atlas.gaits[gait].candidate).score)
          << damage << ", gait " << gait;
    }
  }
}

TEST(GaitRating, RefusesADamageThatTheRobotCannotHave) {
  const std::vector<std::string> damages{"powerless:J9"};
  EXPECT_THROW(static_cast<void>(rate_with_damages(
                   short_atlas(), damages, [](double) {}, [] { return false; })),
               InputError);
}

TEST(Hypotheses, AreThatTheRobotIsIntactOrThatItsDamageIsAnotherOrOneOfThoseGiven) {
  const std::vector<std::string> damages{"powerless:J2", "friction=50%"};
  const std::vector<Hypothesis> hypotheses =
      hypotheses_of(small_atlas(), damages, {{"friction=50%", {0.7, 0.8}}, {"powerless:J2", {0.1, 0.2}}});
  ASSERT_EQ(hypotheses.size(), 4U);
  const std::vector<double> as_the_atlas{1.25, 0.75};
  EXPECT_EQ(hypotheses[0].values, as_the_atlas);
  EXPECT_EQ(hypotheses[1].values, as_the_atlas);
  EXPECT_GT(hypotheses[1].deviation, hypotheses[0].deviation) << "of what is unknown little is expected";
  EXPECT_EQ(hypotheses[2].values, (std::vector<double>{0.1, 0.2})) << "in the order of the damages";
  EXPECT_EQ(hypotheses[3].values, (std::vector<double>{0.7, 0.8}));
  double probability = 0.0;
  for (const Hypothesis& hypothesis : hypotheses) {
    probability += hypothesis.probability;
  }
  EXPECT_NEAR(probability, 1.0, 1e-12);
  EXPECT_EQ(hypotheses_of(small_atlas(), {}, {}).size(), 2U);
}

TEST(Hypotheses, HaveTheGreaterValueForTheLowerCost) {
  Atlas atlas = small_atlas();
  atlas.experiment.objectives.front().goal = Goal::minimise;
  const std::vector<std::string> damages{"powerless:J2"};
  const std::vector<Hypothesis> hypotheses = hypotheses_of(atlas, damages, {{"powerless:J2", {3.0, 4.0}}});
  EXPECT_EQ(hypotheses[0].values, (std::vector<double>{-1.25, -0.75}));
  EXPECT_EQ(hypotheses[2].values, (std::vector<double>{-3.0, -4.0}));
}

TEST(DamageScores, AreReadBackToTheLastBit) {
  const DamageScores scores{{"jammed:a joint=20", {0.1, -1e6}}, {"friction=50%", {1.0 / 3.0, 0.0}}};
  EXPECT_EQ(read_damage_scores(text_of(scores, "abc"), "abc", 2), scores);
}

TEST(DamageScores, OfOtherInputsOrOfADamagedFileAreNone) {
  const std::string text = text_of({{"friction=50%", {0.5, 0.25}}}, "abc");
  EXPECT_TRUE(read_damage_scores(text, "abd", 2).empty());
  EXPECT_TRUE(read_damage_scores(text, "abc", 3).empty());
  EXPECT_TRUE(read_damage_scores(text + "powerless:J3", "abc", 2).empty());
  EXPECT_TRUE(read_damage_scores(text + "powerless:J3\t0.1 nan", "abc", 2).empty());
  EXPECT_TRUE(read_damage_scores(text + "powerless:J3\t0.1 1e308\n", "abc", 2).empty());
  EXPECT_TRUE(read_damage_scores("", "abc", 2).empty());
  EXPECT_TRUE(read_damage_scores(std::string("\0\xff\n", 3), "abc", 2).empty());
  for (std::size_t length = 0; length < text.size(); ++length) {
    EXPECT_TRUE(read_damage_scores(text.substr(0, length), "abc", 2).empty()) << length;
  }
}

}  // namespace
}  // namespace proleg::optimize
