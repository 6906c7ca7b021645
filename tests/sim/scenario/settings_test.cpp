// Parameters of the actuation file and of `--set`.

#include <gtest/gtest.h>

#include <optional>
#include <ostream>

#include "memory_files.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/gait/registry.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

std::int32_t degrees(const std::string& text) { return parse_decimal(text, Unit::degree).raw; }

/// Slot 0: sine on both joints, slot 1: direct access on J2 (kernel joint 0).
Scenario scenario() { return small_scenario().scenario(); }

std::optional<std::int32_t> find(const std::vector<Setting>& settings, unsigned slot, unsigned joint,
                                 std::string_view name, const Scenario& scenario) {
  const Declaration& declaration = scenario.kernel.slots[slot].algorithm->declaration();
  for (const Setting& setting : settings) {
    if (setting.slot != slot || setting.joint != joint) {
      continue;
    }
    const std::string_view found = setting.internal ? declaration.internal_values[setting.number].name
                                                    : declaration.parameters[setting.number].name;
    if (found == name) {
      return setting.value;
    }
  }
  return std::nullopt;
}

std::optional<std::int32_t> start(const Scenario& scenario, unsigned slot, unsigned joint, std::string_view name) {
  return find(scenario.settings, slot, joint, name, scenario);
}

std::string refusal(Scenario scenario, const std::string& word) {
  try {
    apply_setting(scenario, word);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Parameters, ApplyToAllJointsOfTheModuleOrToOne) {
  const Scenario small = scenario();
  EXPECT_EQ(start(small, 0, 0, "amplitude"), degrees("30"));
  EXPECT_EQ(start(small, 0, 1, "amplitude"), degrees("10")) << "J1 is kernel joint 1";
  EXPECT_EQ(start(small, 1, 0, "angle"), degrees("5"));
  EXPECT_EQ(small.settings.size(), 3U);
}

TEST(Parameters, OfOneJointOverrideThoseOfAllInAnyOrder) {
  MemoryFiles files = small_scenario();
  files.replace("actuation.xml", "<parameter name=\"amplitude\" value=\"30\" unit=\"deg\"/>", "");
  files.replace("actuation.xml", "joint=\"J1\"/>", "joint=\"J1\"/><parameter name=\"amplitude\" value=\"30\"/>");
  const Scenario small = files.scenario();
  EXPECT_EQ(start(small, 0, 0, "amplitude"), degrees("30"));
  EXPECT_EQ(start(small, 0, 1, "amplitude"), degrees("10"));
}

TEST(Parameters, AtTheirDefaultAreNotListed) {
  MemoryFiles files = small_scenario();
  files.replace("actuation.xml", "value=\"30\"", "value=\"40\"");
  const Scenario small = files.scenario();
  EXPECT_EQ(start(small, 0, 0, "amplitude"), std::nullopt);
  EXPECT_EQ(start(small, 0, 1, "amplitude"), degrees("10"));
}

TEST(SetOption, ReplacesTheStartValueOnAllJointsOfTheOnlyModuleThatHasTheName) {
  Scenario small = scenario();
  apply_setting(small, "amplitude=22.5");
  EXPECT_EQ(start(small, 0, 0, "amplitude"), degrees("22.5"));
  EXPECT_EQ(start(small, 0, 1, "amplitude"), degrees("22.5"));
  EXPECT_TRUE(small.changes.empty());
}

TEST(SetOption, ReplacesTheStartValueOfOneJoint) {
  Scenario small = scenario();
  apply_setting(small, "amplitude:J2=0");
  EXPECT_EQ(start(small, 0, 0, "amplitude"), 0);
  EXPECT_EQ(start(small, 0, 1, "amplitude"), degrees("10"));
}

TEST(SetOption, BackToTheDefaultRemovesTheSetting) {
  Scenario small = scenario();
  apply_setting(small, "amplitude=40");
  EXPECT_EQ(start(small, 0, 0, "amplitude"), std::nullopt);
  EXPECT_EQ(small.settings.size(), 1U);
}

TEST(SetOption, AcceptsTheModuleByNameOrNumber) {
  Scenario small = scenario();
  apply_setting(small, "PatternGenerator_sinusoidal.frequency=2");
  apply_setting(small, "2.angle=-12");
  EXPECT_EQ(start(small, 0, 1, "frequency"), parse_decimal("2", Unit::hertz).raw);
  EXPECT_EQ(start(small, 1, 0, "angle"), degrees("-12"));
}

TEST(SetOption, WithATickIsAChangeInOrderOfTicks) {
  Scenario small = scenario();
  apply_setting(small, "amplitude=20@500");
  apply_setting(small, "frequency:J1=2@100");
  apply_setting(small, "angle=1@500");
  ASSERT_EQ(small.changes.size(), 2U);
  EXPECT_EQ(small.changes[0].tick, 100U);
  EXPECT_EQ(find(small.changes[0].settings, 0, 1, "frequency", small), parse_decimal("2", Unit::hertz).raw);
  EXPECT_EQ(small.changes[0].settings.size(), 1U);
  EXPECT_EQ(small.changes[1].tick, 500U);
  EXPECT_EQ(small.changes[1].settings.size(), 3U);
  EXPECT_EQ(find(small.changes[1].settings, 1, 0, "angle", small), degrees("1"));
  EXPECT_EQ(start(small, 0, 0, "amplitude"), degrees("30")) << "the start value is unchanged";
}

TEST(SetOption, ALaterWordForTheSameTickReplacesTheEarlier) {
  Scenario small = scenario();
  apply_setting(small, "amplitude=20@5");
  apply_setting(small, "amplitude:J1=21@5");
  ASSERT_EQ(small.changes.size(), 1U);
  EXPECT_EQ(small.changes[0].settings.size(), 2U);
  EXPECT_EQ(find(small.changes[0].settings, 0, 1, "amplitude", small), degrees("21"));
}

TEST(SetOption, AcceptsEveryTick) {
  Scenario small = scenario();
  apply_setting(small, "amplitude=20@4294967295");
  apply_setting(small, "amplitude=20@0");
  ASSERT_EQ(small.changes.size(), 2U);
  EXPECT_EQ(small.changes[0].tick, 0U);
  EXPECT_EQ(small.changes[1].tick, 4294967295U);
}

TEST(SetOption, OnAnInternalValueIsADistortion) {
  MemoryFiles files = small_scenario();
  files.replace("actuation.xml", "PatternGenerator_sinusoidal", "PatternGenerator_coupled_oscillator");
  Scenario small = files.scenario();
  apply_setting(small, "current_phase:J2=90@50");
  apply_setting(small, "current_amplitude=1");
  ASSERT_EQ(small.changes.size(), 2U);
  EXPECT_EQ(small.changes[0].tick, 0U) << "without a tick at the start";
  EXPECT_EQ(small.changes[0].settings.size(), 2U);
  EXPECT_EQ(find(small.changes[0].settings, 0, 1, "current_amplitude", small), degrees("1"));
  ASSERT_EQ(small.changes[1].settings.size(), 1U);
  EXPECT_TRUE(small.changes[1].settings[0].internal);
  EXPECT_EQ(small.changes[1].settings[0].joint, 0);
  EXPECT_EQ(small.changes[1].settings[0].value, 1 << 30);
}

/// Both slots run the sine; the second one drives J2 only.
Scenario twice_the_sine() {
  MemoryFiles files = small_scenario();
  files.replace("actuation.xml", "DirectJointAccess", "PatternGenerator_sinusoidal");
  files.replace("actuation.xml", "name=\"angle\"", "name=\"amplitude\"");
  return files.scenario();
}

TEST(SetOption, RequiresTheModuleIfSeveralHaveTheName) {
  EXPECT_EQ(refusal(twice_the_sine(), "amplitude=1"),
            "amplitude=1: found 'amplitude' in several modules, expected one of "
            "1.amplitude (PatternGenerator_sinusoidal), 2.amplitude (PatternGenerator_sinusoidal)");
  EXPECT_NE(refusal(twice_the_sine(), "PatternGenerator_sinusoidal.amplitude=1").find("in several modules"),
            std::string::npos);
  EXPECT_EQ(refusal(twice_the_sine(), "2.amplitude=1"), "accepted");
}

TEST(SetOption, AJointThatOnlyOneModuleDrivesDecidesTheModule) {
  Scenario small = twice_the_sine();
  apply_setting(small, "amplitude:J1=1");
  EXPECT_EQ(start(small, 0, 1, "amplitude"), degrees("1"));
  EXPECT_NE(refusal(small, "amplitude:J2=1").find("in several modules"), std::string::npos);
}

TEST(SetOption, TakesTheNamesOfTheThesis) {
  Scenario small = small_scenario().scenario();
  apply_setting(small, "amplitude: a=11");
  apply_setting(small, "amplitude: a:J1=12");
  apply_setting(small, "Phase: P=30");
  apply_setting(small, "PhaseDifference:J2=31");
  apply_setting(small, "Joint_1=7");  // the second joint of the robot's file
  const auto joint = [&](const std::string& name) { return static_cast<unsigned>(find_joint(small.robot, name)); };
  EXPECT_EQ(start(small, 0, joint("J1"), "amplitude"), degrees("12"));
  EXPECT_EQ(start(small, 0, joint("J2"), "amplitude"), degrees("11"));
  EXPECT_EQ(start(small, 1, joint("J2"), "angle"), degrees("7"));
  EXPECT_NE(start(small, 0, joint("J1"), "phase_difference"), start(small, 0, joint("J2"), "phase_difference"));
  EXPECT_EQ(refusal(small, "joint_0=7"),
            "joint_0=7: found joint 'J1', which DirectJointAccess (2) does not drive, expected one of J2");
  EXPECT_NE(refusal(small, "Joint_9=7").find("unknown parameter 'Joint_9'"), std::string::npos);
  EXPECT_NE(refusal(small, "Joint_9=7").find("; the joints of this robot are Joint_0 to Joint_1"), std::string::npos);
  EXPECT_EQ(refusal(small, "1.Joint_9=7").find("Joint_0"), std::string::npos) << "the sine has no angles to set";
  EXPECT_NE(refusal(small, "timestep=0.001").find("; the time step of all algorithms is <tick>"), std::string::npos);
}

TEST(ActuationFile, TakesTheNamesOfTheThesis) {
  MemoryFiles files = small_scenario();
  files.replace("actuation.xml", "name=\"angle\"", "name=\"Joint_1\"");
  const Scenario own = small_scenario().scenario();
  const Scenario thesis = files.scenario();
  const auto j2 = static_cast<unsigned>(find_joint(own.robot, "J2"));
  EXPECT_EQ(start(thesis, 1, j2, "angle"), start(own, 1, j2, "angle"));
  files.replace("actuation.xml", "name=\"Joint_1\"", "name=\"Joint_0\"");
  EXPECT_THROW(static_cast<void>(files.scenario()), InputError) << "the module does not drive J1";
  files.replace("actuation.xml", "name=\"Joint_0\"", "name=\"Joint_2\"");
  EXPECT_NE(message_of<InputError>([&] {
              static_cast<void>(files.scenario());
            }).find("expected one of angle; the joints of this robot are Joint_0 to Joint_1"),
            std::string::npos);
}

TEST(ActuationFile, TwoNamesOfOneParameterAreTheSameParameter) {
  MemoryFiles files = small_scenario();
  files.replace("actuation.xml", "name=\"amplitude\" value=\"10\"", "name=\"amplitude: a\" value=\"10\"");
  files.replace("actuation.xml", " joint=\"J1\"", "");
  EXPECT_EQ(
      message_of<InputError>([&] { static_cast<void>(files.scenario()); }),
      "actuation.xml:6: found parameter 'amplitude: a', which is amplitude, twice for the same joints, expected it "
      "once");
}

struct Refusal {
  std::string word;
  std::string message;
};

void PrintTo(const Refusal& bad, std::ostream* stream) { *stream << bad.word; }

class BadSetOption : public testing::TestWithParam<Refusal> {};

INSTANTIATE_TEST_SUITE_P(
    Words, BadSetOption,
    testing::Values(
        Refusal{"amplitude", "amplitude: found no '=', expected [MODULE.]NAME[:JOINT]=VALUE[@TICK]"},
        Refusal{"", ": found no '=', expected [MODULE.]NAME[:JOINT]=VALUE[@TICK]"},
        Refusal{"=", "=: found unknown parameter '', expected one of amplitude, frequency"},
        Refusal{"amplitud=3", "found unknown parameter 'amplitud', expected one of amplitude, frequency"},
        Refusal{"2.amplitude=3", "found unknown parameter 'amplitude', expected one of angle"},
        Refusal{"5.amplitude=3", "found unknown module '5', expected one of PatternGenerator_sinusoidal (1), DirectJ"},
        Refusal{"Missing.amplitude=3",
                "found unknown module 'Missing', expected one of PatternGenerator_sinusoidal (1)"},
        Refusal{"amplitude:J7=3", "found unknown joint 'J7', expected one of J1, J2"},
        Refusal{"amplitude:=3", "found unknown joint '', expected one of J1, J2"},
        Refusal{"angle:J1=3", "found joint 'J1', which DirectJointAccess (2) does not drive, expected one of J2"},
        Refusal{"amplitude=91", "found '91' for parameter 'amplitude', expected a number from 0 to 90 deg"},
        Refusal{"amplitude=-1", "found '-1' for parameter 'amplitude', expected a number from 0 to 90 deg"},
        Refusal{"amplitude=nan", "found 'nan' for parameter 'amplitude', expected a number from 0 to 90 deg"},
        Refusal{"amplitude=", "found '' for parameter 'amplitude', expected a number from 0 to 90 deg"},
        Refusal{"amplitude=4 0", "found '4 0' for parameter 'amplitude'"},
        Refusal{"amplitude=40deg", "found '40deg' for parameter 'amplitude'"},
        Refusal{"amplitude=1e99", "found '1e99' for parameter 'amplitude'"},
        Refusal{"frequency=20.001", "expected a number from 0 to 20 Hz"},
        Refusal{"current_phase=x@3",
                "found 'x' for 'current_phase', expected a number above -23592960 and below 23592960 deg"},
        Refusal{"phase=23592960",
                "found '23592960' for parameter 'phase', expected a number above -23592960 and below 23592960 deg"},
        Refusal{"phase=1e9",
                "found '1e9' for parameter 'phase', expected a number above -23592960 and below 23592960 deg"},
        Refusal{"amplitude=3@", "found tick '', expected a whole number from 0 to 4294967295"},
        Refusal{"amplitude=3@-1", "found tick '-1', expected a whole number from 0 to 4294967295"},
        Refusal{"amplitude=3@4294967296", "found tick '4294967296', expected a whole number from 0 to 4294967295"},
        Refusal{"amplitude=3@s", "found time 's', expected seconds from 0 to 10000000, such as 5s"},
        Refusal{"amplitude=3@-1s", "found time '-1s', expected seconds from 0 to 10000000, such as 5s"},
        Refusal{"amplitude=3@1.5", "found tick '1.5', expected a whole number from 0 to 4294967295"},
        Refusal{"amp\nlitude=3", "amp litude=3: found unknown parameter 'amp litude', expected"}));

TEST_P(BadSetOption, IsNamedWithWhatWasExpected) {
  const std::string message = refusal(scenario(), GetParam().word);
  EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(SetOption, AWordThatIsRefusedChangesNothing) {
  Scenario small = scenario();
  EXPECT_THROW(apply_setting(small, "amplitude=3@x"), InputError);
  EXPECT_THROW(apply_setting(small, "current_phase=x@3"), InputError);
  EXPECT_EQ(small.settings.size(), scenario().settings.size());
  EXPECT_TRUE(small.changes.empty());
}

TEST(SetOption, AWordWithOneValueTooManyForAJointChangesNothing) {
  Scenario small = scenario();
  small.changes.push_back({5, {}});
  for (std::size_t value = 0; value < max_staged_values; ++value) {
    Setting setting;
    setting.slot = 3;
    setting.joint = 1;
    setting.number = static_cast<std::uint8_t>(value);
    small.changes.front().settings.push_back(setting);
  }
  EXPECT_THROW(apply_setting(small, "amplitude=20@5"), InputError);
  EXPECT_EQ(small.changes.front().settings.size(), max_staged_values) << "joint 0 has room, joint 1 has none";
}

TEST(Contradictions, AreRefusedByParameterValueAndJointAtTheStartAndAfterAChange) {
  Scenario small = scenario();
  small.kernel.slots[3] = {find_algorithm("SensingModule_gait_selector"), JointMask::first(2)};
  EXPECT_FALSE(find_contradiction(small));
  apply_setting(small, "4.feature_3=1");
  apply_setting(small, "4.threshold_3=0.25");
  EXPECT_FALSE(find_contradiction(small));
  apply_setting(small, "4.second_feature_3=-1");
  apply_setting(small, "4.second_threshold_3=0.5");
  EXPECT_FALSE(find_contradiction(small));
  apply_setting(small, "4.second_threshold_3:J1=0.125@20");
  const std::optional<FoundContradiction> found = find_contradiction(small);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->slot, 3U);
  EXPECT_EQ(found->found,
            "SensingModule_gait_selector (4) with threshold_3 0.25 and second_threshold_3 0.125 on joint 'J1'");
  EXPECT_EQ(found->expected, "two conditions that a value can meet together");
}

TEST(ParsedSetting, HasATickOnlyIfTheWordHasOne) {
  const ParsedSetting at_once = parse_setting(scenario(), "amplitude=22.5");
  EXPECT_FALSE(at_once.tick);
  ASSERT_EQ(at_once.settings.size(), 2U);
  EXPECT_EQ(at_once.settings[1].value, degrees("22.5"));
  EXPECT_EQ(parse_setting(scenario(), "amplitude:J1=3@0").tick, 0U);
  EXPECT_FALSE(parse_setting(scenario(), "current_phase=90").tick);
}

TEST(SettingName, IsFoundWithoutAValue) {
  const SettingTarget named = find_named_target(scenario(), "1.amplitude:J1");
  EXPECT_TRUE(named.same_value(find_target(scenario(), "1.amplitude:J1=3")));
  EXPECT_EQ(named.joints.bits(), 0b10U);
  EXPECT_THROW((void)find_named_target(scenario(), "amplitud"), InputError);
}

TEST(SettingTarget, IsWhatTheWordChanges) {
  const SettingTarget all = find_target(scenario(), "amplitude=3");
  EXPECT_EQ(all.slot, 0U);
  EXPECT_EQ(all.joints.bits(), 0b11U);
  EXPECT_FALSE(all.in_flight);
  EXPECT_EQ(all.unit, Unit::degree);
  const SettingTarget one = find_target(scenario(), "1.amplitude:J1=3@7");
  EXPECT_TRUE(one.same_value(all));
  EXPECT_EQ(one.joints.bits(), 0b10U) << "J1 is kernel joint 1";
  EXPECT_TRUE(one.in_flight);
  EXPECT_EQ(one.tick, 7U);
  const SettingTarget frequency = find_target(scenario(), "frequency=x");
  EXPECT_FALSE(frequency.same_value(all));
  EXPECT_EQ(frequency.unit, Unit::hertz);
  EXPECT_THROW((void)find_target(scenario(), "amplitud=3"), InputError);
}

}  // namespace
}  // namespace proleg::sim
