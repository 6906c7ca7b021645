#include "sim/scenario/damage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

Scenario intact_wave() {
  DiskFiles files;
  return read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
}

Scenario damaged_wave(const std::vector<std::string>& words) {
  Scenario scenario = intact_wave();
  apply_damage(scenario, words);
  return scenario;
}

std::size_t number_of_joint(const Scenario& scenario, const std::string& name) {
  std::size_t joint = 0;
  while (scenario.robot.joints.at(joint).name != name) {
    ++joint;
  }
  return joint;
}

std::string refusal_of(const std::vector<std::string>& words) {
  try {
    static_cast<void>(damaged_wave(words));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Damage, JamsAJointAtAnAngleThatNoSetPointChanges) {
  const Scenario scenario = damaged_wave({"jammed:J3=-30", "jammed:J1"});
  const std::size_t joint = number_of_joint(scenario, "J3");
  EXPECT_NEAR(scenario.joint_limits[joint].lower / double{1 << 30} * 90.0, -30.0, 1e-6);
  EXPECT_EQ(scenario.joint_limits[joint].upper, scenario.joint_limits[joint].lower);
  EXPECT_GT(scenario.robot.joints[joint].max_torque, 5.0 * intact_wave().robot.joints[joint].max_torque);
  EXPECT_EQ(scenario.joint_limits[number_of_joint(scenario, "J1")].upper, 0);
  EXPECT_EQ(scenario.joint_limits[number_of_joint(scenario, "J2")].upper, intact_wave().joint_limits[0].upper)
      << "no other joint";
}

TEST(Damage, WeakensServosLinksAndFriction) {
  const Scenario before = intact_wave();
  const Scenario after = damaged_wave({"torque:J2=40%", "powerless:J4", "mass:Head=115", "friction=50%"});
  const std::size_t weak = number_of_joint(after, "J2");
  EXPECT_DOUBLE_EQ(after.robot.joints[weak].max_torque, 0.4 * before.robot.joints[weak].max_torque);
  EXPECT_LT(after.robot.joints[number_of_joint(after, "J4")].max_torque, 1e-5);
  EXPECT_DOUBLE_EQ(after.robot.links[0].mass.mass, 1.15 * before.robot.links[0].mass.mass);
  EXPECT_DOUBLE_EQ(after.robot.links[0].mass.inertia(1, 1), 1.15 * before.robot.links[0].mass.inertia(1, 1));
  EXPECT_EQ(after.robot.links[1].mass.mass, before.robot.links[1].mass.mass);
  EXPECT_DOUBLE_EQ(after.environment.unspecified_friction, 0.5 * before.environment.unspecified_friction);
  for (std::size_t i = 0; i < before.environment.objects.size(); ++i) {
    for (std::size_t g = 0; g < before.environment.objects[i].geometries.size(); ++g) {
      if (before.environment.objects[i].geometries[g].friction) {
        EXPECT_DOUBLE_EQ(*after.environment.objects[i].geometries[g].friction,
                         0.5 * *before.environment.objects[i].geometries[g].friction);
      }
    }
  }
}

TEST(Damage, OfALostModuleTakesItsFramesFromAllOthers) {
  Scenario scenario = damaged_wave({"lost:J3"});
  scenario.duration_s = 1.0;
  const auto lost = static_cast<unsigned>(number_of_joint(scenario, "J3"));
  EXPECT_LT(scenario.robot.joints[lost].max_torque, 1e-5);
  const Losses losses = losses_of_damage(scenario, {"lost:J3"});
  for (const std::uint32_t tick : {0U, 57U, 100U}) {
    for (unsigned joint = 0; joint < 5; ++joint) {
      EXPECT_EQ(losses.receivers_without(tick, lost, 0).contains(joint), joint != lost) << tick << ' ' << joint;
      EXPECT_FALSE(losses.receivers_without(tick, (lost + 1) % 5, 0).contains(joint));
    }
  }
  EXPECT_FALSE(losses_of_damage(scenario, {"powerless:J3"}).any());
}

TEST(Damage, IsRefusedInOneLineThatSaysWhatIsExpected) {
  const auto expect = [](const std::vector<std::string>& words, const std::string& part) {
    const std::string message = refusal_of(words);
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.rfind("--damage: found ", 0), 0U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  expect({"broken:J3"}, "one of jammed:JOINT[=DEGREES], torque:JOINT=PERCENT");
  expect({""}, "one of jammed");
  expect({"jammed"}, "expected jammed:JOINT[=DEGREES], a number from -90 to 90");
  expect({"jammed:J9"}, "unknown joint 'J9', expected one of J1");
  expect({"jammed:J3=91"}, "-90 to 90");
  expect({"jammed:J3=10%"}, "-90 to 90");
  expect({"jammed:J3="}, "-90 to 90");
  expect({"torque:J3"}, "expected torque:JOINT=PERCENT, a number from 1 to 100");
  expect({"torque:J3=0"}, "1 to 100");
  expect({"torque:J3=nan"}, "1 to 100");
  expect({"powerless:J3=4"}, "expected powerless:JOINT");
  expect({"mass:Leg=50%"}, "unknown link 'Leg', expected one of Head");
  expect({"friction:J3=50%"}, "expected friction=PERCENT");
  expect({"friction"}, "expected friction=PERCENT");
  expect({"jammed:J3", "torque:J3=40"}, "a second damage");
  expect({"friction=50", "friction=50"}, "a second damage");
}

TEST(DamageWord, IsTheSameForTheSameDamage) {
  const Scenario scenario = intact_wave();
  for (const char* const word : {"jammed:J3", "jammed:J3=0", "jammed:J3=-0", "jammed:J3=0.0"}) {
    EXPECT_EQ(damage_word(scenario, word), "jammed:J3=0");
  }
  EXPECT_EQ(damage_word(scenario, "jammed:J3=-20.50"), "jammed:J3=-20.5");
  EXPECT_EQ(damage_word(scenario, "torque:J3=40.0"), "torque:J3=40%");
  EXPECT_EQ(damage_word(scenario, "mass:Head=115%"), "mass:Head=115%");
  EXPECT_EQ(damage_word(scenario, "friction=5e1"), "friction=50%");
  EXPECT_EQ(damage_word(scenario, "lost:J3"), "lost:J3");
  for (const std::string& word : usual_damages(scenario)) {
    EXPECT_EQ(damage_word(scenario, word), word);
  }
  EXPECT_THROW(static_cast<void>(damage_word(scenario, "jammed:J9")), InputError);
}

TEST(UsualDamages, AreThoseThatTheRobotCanHave) {
  Scenario scenario = intact_wave();
  const std::vector<std::string> words = usual_damages(scenario);
  EXPECT_EQ(words.size(), 5U * scenario.robot.joints.size() + 1U);
  EXPECT_EQ(std::ranges::count(words, "powerless:J3"), 1);
  EXPECT_EQ(std::ranges::count(words, "jammed:J3=-20"), 1);
  EXPECT_EQ(
      usual_damages_text(),
      "each joint without power, with 50% of its torque, or jammed at -20, 0 or 20 degrees, and 50% of all friction");
  for (const std::string& word : words) {
    EXPECT_NO_THROW(static_cast<void>(damaged_wave({word}))) << word;
  }
  scenario.joint_limits[number_of_joint(scenario, "J3")] = {-(1 << 27), 1 << 30};  // from -11.25 degrees on
  EXPECT_EQ(std::ranges::count(usual_damages(scenario), "jammed:J3=-20"), 0);
  EXPECT_EQ(std::ranges::count(usual_damages(scenario), "jammed:J3=20"), 1);
  scenario.robot.joints.front().name = "a=b";  // a word of a damage has one '='
  EXPECT_EQ(usual_damages(scenario).size(), words.size() - 1U - 5U);
}

}  // namespace
}  // namespace proleg::sim
