#include "sim/optimize/adaptation/rule_learner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <optional>
#include <random>
#include <tuple>
#include <vector>

namespace proleg::optimize {
namespace {

enum Number : std::int32_t { pitch = 1, pitch_swing, roll, touch };
constexpr std::uint32_t all_features = (1U << GaitFeatures::count) - 1;

std::int32_t learned_ratio(double value) { return static_cast<std::int32_t>(std::lround(std::ldexp(value, 28))); }

std::int32_t chosen_by(const RuleParameters& rules, const FeatureValues& features) {
  return DecisionList(rules.data(), gait_sets).choose(features.data(), 1, 0);
}

class RuleLearner : public testing::Test {
 protected:
  /// Every feature uniform in 0 to 1; the set as the rules choose.
  std::vector<RuleExample> examples(const RuleParameters& rules, std::size_t count) {
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<RuleExample> all(count);
    for (RuleExample& example : all) {
      for (std::int32_t& feature : example.features) {
        feature = learned_ratio(unit(random_));
      }
      example.right_sets = bit_of_set(chosen_by(rules, example.features));
    }
    return all;
  }

  static double right(const RuleParameters& rules, const std::vector<RuleExample>& examples) {
    double count = 0;
    for (const RuleExample& example : examples) {
      count += (example.right_sets & bit_of_set(chosen_by(rules, example.features))) != 0 ? 1 : 0;
    }
    return count / static_cast<double>(examples.size());
  }

  std::mt19937 random_{531};
};

TEST_F(RuleLearner, FindsTheRulesThatMadeTheExamples) {
  const std::vector<RuleParameters> makers{
      {touch, learned_ratio(0.3), 0, 0},
      {-touch, learned_ratio(0.4), roll, learned_ratio(0.5)},
      {0, 0, 0, 0, pitch, learned_ratio(0.25), -pitch, learned_ratio(0.75)},
      {touch, learned_ratio(0.5), 0, 0, roll, learned_ratio(0.6), 0, 0, pitch, learned_ratio(0.7), 0, 0},
      {-touch, learned_ratio(0.5), pitch_swing, learned_ratio(0.3), roll, learned_ratio(0.5), -pitch,
       learned_ratio(0.6), pitch, learned_ratio(0.8), 0, 0},
  };
  for (const RuleParameters& maker : makers) {
    const RuleParameters learned = learn_rules(examples(maker, 1500), all_features, 0).rules;
    const double share = right(learned, examples(maker, 4000));
    EXPECT_GT(share, 0.95) << "seed 531";
    EXPECT_EQ(DecisionList(learned.data(), gait_sets).features(), DecisionList(maker.data(), gait_sets).features());
    std::cout << "right on fresh examples: " << share << '\n';
  }
}

TEST_F(RuleLearner, PutsAThresholdInTheMiddleOfAGapAndRoundsIt) {
  std::vector<RuleExample> all;
  for (int i = 0; i < 100; ++i) {
    RuleExample low;
    low.features[touch - 1] = learned_ratio(0.2 - i * 0.001);
    RuleExample high;
    high.features[touch - 1] = learned_ratio(0.6 + i * 0.001);
    high.right_sets = bit_of_set(3);
    all.push_back(low);
    all.push_back(high);
  }
  const RuleParameters expected{0, 0, 0, 0, touch, learned_ratio(0.4)};
  EXPECT_EQ(learn_rules(all, all_features, 0).rules, expected);
}

TEST_F(RuleLearner, NamesOnlyUsableFeatures) {
  const RuleParameters maker{touch, learned_ratio(0.5), 0, 0};
  std::vector<RuleExample> all = examples(maker, 1000);
  for (RuleExample& example : all) {
    example.features[roll - 1] = example.features[touch - 1] / 2;  // says as much as touch
  }
  EXPECT_EQ(DecisionList(learn_rules(all, all_features & ~(1U << (touch - 1)), 0).rules.data(), gait_sets).features(),
            1U << (roll - 1));
}

// Otherwise a set of which there are few recordings would never be chosen.
TEST_F(RuleLearner, CountsEverySetTheSame) {
  std::vector<RuleExample> all;
  for (int i = 0; i < 10'000; ++i) {
    RuleExample example;
    example.features[touch - 1] = learned_ratio(i / 10'000.0);
    all.push_back(example);
  }
  for (int i = 0; i < 50; ++i) {
    RuleExample example;  // of all values above 0.9 a twentieth
    example.features[touch - 1] = learned_ratio(0.9 + i / 500.0);
    example.right_sets = bit_of_set(2);
    all.push_back(example);
  }
  const RuleParameters rules = learn_rules(all, all_features, 0).rules;
  EXPECT_EQ(rules[0], touch);
  EXPECT_NEAR(rules[1], learned_ratio(0.9), learned_ratio(0.03)) << "a threshold is at one of 31 places";
}

TEST_F(RuleLearner, MakesRulesThatTheSelectorTakesOfWhateverExamples) {
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<RuleExample> all(20 + random_() % 200);
    for (RuleExample& example : all) {
      for (std::int32_t& feature : example.features) {
        feature = learned_ratio(static_cast<int>(random_() % 7) / 3.0 - 1);
      }
      example.right_sets = bit_of_set(static_cast<std::int32_t>(1 + random_() % 4));
      example.played = static_cast<std::int32_t>(1 + random_() % 4);
    }
    all[0].right_sets = bit_of_set(1);
    all[1].right_sets = bit_of_set(4);
    const RuleParameters rules = learn_rules(all, all_features, std::nullopt).rules;
    EXPECT_FALSE(DecisionList(rules.data(), gait_sets).contradiction(0)) << "seed 531, trial " << trial;
    EXPECT_EQ(learn_rules(all, all_features, std::nullopt).rules, rules);
  }
}

// A gait changes what is sensed: touch is 0.4 to 0.6 on the ground of set 2 while set 2 is played, and elsewhere too.
TEST_F(RuleLearner, FindsTheHysteresisWithoutWhichNoRuleWouldDo) {
  std::uniform_real_distribution<double> unit(0, 0.2);
  std::vector<RuleExample> all;
  for (int i = 0; i < 300; ++i) {
    for (const auto& [played, right_set, touched] :
         {std::tuple{1, 2, 0.7}, std::tuple{2, 2, 0.4}, std::tuple{1, 1, 0.4}, std::tuple{2, 1, 0.0}}) {
      RuleExample& example = all.emplace_back();
      example.features[touch - 1] = learned_ratio(touched + unit(random_));
      example.right_sets = bit_of_set(right_set);
      example.played = played;
    }
  }
  const LearnedRules without = learn_rules(all, all_features, 0);
  const LearnedRules learned = learn_rules(all, all_features, std::nullopt);
  EXPECT_LT(without.score, 0.9);
  EXPECT_GT(learned.hysteresis, learned_ratio(0.05));
  for (const RuleExample& example : all) {
    ASSERT_EQ(bit_of_set(DecisionList(learned.rules.data(), gait_sets)
                             .choose(example.features.data(), example.played, learned.hysteresis)),
              example.right_sets);
  }
}

// Set 4 has the gait of set 1: its rule takes back what the rule of set 3 takes too much of.
TEST_F(RuleLearner, UsesASecondSetOfAGaitForWhatOneRuleCannotSay) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<RuleExample> all(4000);
  for (RuleExample& example : all) {
    for (const int feature : {pitch, roll, touch}) {
      example.features[static_cast<std::size_t>(feature - 1)] = learned_ratio(unit(random_));
    }
    const bool is_inside = example.features[roll - 1] > learned_ratio(0.4) &&
                           example.features[touch - 1] > learned_ratio(0.4) &&
                           example.features[pitch - 1] < learned_ratio(0.6);
    example.right_sets = is_inside ? bit_of_set(3) : bit_of_set(1) | bit_of_set(4);
  }
  const RuleParameters rules = learn_rules(all, all_features, 0).rules;
  EXPECT_GT(right(rules, all), 0.97);
  EXPECT_NE(rules[8], 0) << "set 4 has a rule";
}

TEST_F(RuleLearner, LearnsNothingFromFeaturesThatAreAlwaysTheSame) {
  std::vector<RuleExample> all(100);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].right_sets = bit_of_set(i % 2 == 0 ? 1 : 2);
  }
  EXPECT_EQ(learn_rules(all, all_features, std::nullopt).rules, RuleParameters{});
}

}  // namespace
}  // namespace proleg::optimize
