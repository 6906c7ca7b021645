#include "shared/gait/declaration.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "robot.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

template <typename Visit>
void for_each_algorithm(Visit visit) {
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    SCOPED_TRACE(std::string(algorithm_at(i).declaration().name));
    visit(algorithm_at(i));
  }
}

TEST(Registry, HoldsTheAlgorithmsUnderTheirNamesInFiles) {
  for (const auto name :
       {test::direct, test::sinusoidal, test::extended, test::coupled, test::reflex, test::adaptive_touch,
        test::stimulus, test::selector, test::serpenoid, test::compound, test::hopf, test::matsuoka, test::half_centre,
        test::push_pull, test::mtran, test::asymmetric}) {
    EXPECT_NE(find_algorithm(name), nullptr) << name;
  }
}

TEST(Registry, FindsEachAlgorithmByNameAndById) {
  for_each_algorithm([](const ActuationModule& algorithm) {
    EXPECT_EQ(find_algorithm(algorithm.declaration().name), &algorithm);
    EXPECT_EQ(find_algorithm(algorithm.declaration().id), &algorithm);
  });
}

TEST(Registry, FindsNothingUnderAnUnknownNameOrId) {
  EXPECT_EQ(find_algorithm("PatternGenerator_Sinusoidal"), nullptr);
  EXPECT_EQ(find_algorithm(""), nullptr);
  EXPECT_EQ(find_algorithm(std::uint8_t{0}), nullptr);
  EXPECT_EQ(find_algorithm(std::uint8_t{127}), nullptr);
}

// Ids are part of the protocol and are never given to another algorithm.
TEST(Registry, KeepsTheIdsOfTheProtocol) {
  EXPECT_EQ(find_algorithm(test::direct)->declaration().id, 1);
  EXPECT_EQ(find_algorithm(test::sinusoidal)->declaration().id, 2);
  EXPECT_EQ(find_algorithm(test::extended)->declaration().id, 3);
  EXPECT_EQ(find_algorithm(test::coupled)->declaration().id, 4);
  EXPECT_EQ(find_algorithm(test::reflex)->declaration().id, 5);
  EXPECT_EQ(find_algorithm(test::adaptive_touch)->declaration().id, 14);
  EXPECT_EQ(find_algorithm(test::stimulus)->declaration().id, 15);
  EXPECT_EQ(find_algorithm(test::selector)->declaration().id, 16);
  EXPECT_EQ(find_algorithm(test::serpenoid)->declaration().id, 6);
  EXPECT_EQ(find_algorithm(test::compound)->declaration().id, 7);
  EXPECT_EQ(find_algorithm(test::hopf)->declaration().id, 8);
  EXPECT_EQ(find_algorithm(test::matsuoka)->declaration().id, 9);
  EXPECT_EQ(find_algorithm(test::half_centre)->declaration().id, 10);
  EXPECT_EQ(find_algorithm(test::push_pull)->declaration().id, 11);
  EXPECT_EQ(find_algorithm(test::mtran)->declaration().id, 12);
  EXPECT_EQ(find_algorithm(test::asymmetric)->declaration().id, 13);
}

TEST(Declaration, HasAnIdANameAndAHelpTextOfItsOwn) {
  std::set<int> ids;
  std::set<std::string_view> names;
  for_each_algorithm([&](const ActuationModule& algorithm) {
    const Declaration& about = algorithm.declaration();
    EXPECT_GE(about.id, 1);
    EXPECT_LE(about.id, 127);
    EXPECT_TRUE(ids.insert(about.id).second);
    EXPECT_FALSE(about.name.empty());
    EXPECT_TRUE(names.insert(about.name).second);
    EXPECT_FALSE(about.help.empty());
  });
}

TEST(Declaration, NamesEachParameterOnceWithinTheCapacityOfASlot) {
  for_each_algorithm([](const ActuationModule& algorithm) {
    const Declaration& about = algorithm.declaration();
    EXPECT_LE(about.parameters.size(), max_parameters);
    for (std::size_t i = 0; i < about.parameters.size(); ++i) {
      EXPECT_EQ(find_parameter(about, about.parameters[i].name), static_cast<int>(i));
    }
    EXPECT_EQ(find_parameter(about, "no such parameter"), -1);
  });
}

TEST(Declaration, BeginsTheHelpOfAParameterWithAShortSentence) {
  for_each_algorithm([](const ActuationModule& algorithm) {
    for (const Parameter& parameter : algorithm.declaration().parameters) {
      const std::string_view help = parameter.help;
      const std::string_view first = help.substr(0, help.find(". "));
      ASSERT_GE(first.size(), 10U) << parameter.name;
      EXPECT_TRUE(first.front() >= 'A' && first.front() <= 'Z') << first;
      EXPECT_LE(first.size(), 80U) << first << ": it stands in a panel of 360 pixels";
      EXPECT_EQ(first.find_first_of(";/="), std::string_view::npos) << first << ": formulas come after it";
      EXPECT_EQ(help.back(), '.') << help;
    }
  });
}

TEST(Declaration, NamesEachInternalValueOnceWithinTheCapacityOfASlot) {
  for_each_algorithm([](const ActuationModule& algorithm) {
    const Declaration& about = algorithm.declaration();
    EXPECT_LE(about.internal_values.size(), max_internal_values);
    for (std::size_t i = 0; i < about.internal_values.size(); ++i) {
      EXPECT_FALSE(about.internal_values[i].help.empty()) << about.internal_values[i].name;
      EXPECT_GE(about.internal_values[i].noise_scale, 0);
      EXPECT_EQ(find_internal_value(about, about.internal_values[i].name), static_cast<int>(i));
    }
    EXPECT_EQ(find_internal_value(about, "no such value"), -1);
  });
}

TEST(Declaration, HasDefaultsWithinItsRanges) {
  for_each_algorithm([](const ActuationModule& algorithm) {
    for (const Parameter& parameter : algorithm.declaration().parameters) {
      EXPECT_LE(parameter.minimum, parameter.default_value) << parameter.name;
      EXPECT_LE(parameter.default_value, parameter.maximum) << parameter.name;
      if (wraps(parameter.unit)) {
        EXPECT_EQ(parameter.minimum, phase_minimum) << parameter.name;
        EXPECT_EQ(parameter.maximum, phase_maximum) << parameter.name;
      }
    }
  });
}

// Ranges of the thesis, table 3.1.
TEST(Declaration, KeepsAnglesWithinNinetyDegrees) {
  for_each_algorithm([](const ActuationModule& algorithm) {
    for (const Parameter& parameter : algorithm.declaration().parameters) {
      if (parameter.unit == Unit::degree) {
        EXPECT_GE(parameter.minimum, -(1 << 30)) << parameter.name;
        EXPECT_LE(parameter.maximum, 1 << 30) << parameter.name;
      }
    }
  });
}

TEST(Declaration, BroadcastsAtMostSixBytesOfValuesThatExist) {
  for_each_algorithm([](const ActuationModule& algorithm) {
    const Declaration& about = algorithm.declaration();
    std::size_t bytes = 0;
    for (const FrameField field : about.frame) {
      EXPECT_LT(field.internal_value, about.internal_values.size());
      EXPECT_GE(field.bytes, 1);
      EXPECT_LE(field.bytes, 4);
      bytes += field.bytes;
    }
    EXPECT_LE(bytes, StateFrame::payload_size);
  });
}

TEST(Declaration, OfAPatternGeneratorStartsWithPhaseFrequencyAndPhaseDifference) {
  int generators = 0;
  for_each_algorithm([&](const ActuationModule& algorithm) {
    const Declaration& about = algorithm.declaration();
    if (!about.name.starts_with("PatternGenerator_")) {
      return;
    }
    ++generators;
    ASSERT_GE(about.internal_values.size(), 3U);
    EXPECT_EQ(about.internal_values[PatternGenerator::current_phase].name, "current_phase");
    EXPECT_EQ(about.internal_values[PatternGenerator::current_phase].unit, Unit::phase_degree);
    EXPECT_EQ(about.internal_values[PatternGenerator::measured_frequency].name, "measured_frequency");
    EXPECT_EQ(about.internal_values[PatternGenerator::measured_frequency].unit, Unit::hertz);
    EXPECT_EQ(about.internal_values[PatternGenerator::measured_phase_difference].name, "measured_phase_difference");
    EXPECT_EQ(about.internal_values[PatternGenerator::measured_phase_difference].unit, Unit::phase_degree);
    ASSERT_GE(about.frame.size(), 1U);
    EXPECT_EQ(about.frame[0].internal_value, PatternGenerator::current_phase);
    EXPECT_EQ(about.frame[0].bytes, 4);
  });
  EXPECT_EQ(generators, 12);
}

}  // namespace
}  // namespace proleg
