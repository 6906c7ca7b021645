// A gait with a user's algorithm: the modules must have it, with the same sources, before a joint moves.

#include <gtest/gtest.h>

#include "scripted_robot.hpp"
#include "shared/computer/master/master_report.hpp"
#include "shared/gait/actuation_module.hpp"

namespace proleg::test {
namespace {

using canopen::Problem;
using canopen::ProblemCode;

constexpr std::uint32_t sources = 0xC0FFEE;
constexpr std::uint8_t sub_index = 5;  // id 96 has sub-index 1
constexpr Parameter parameters[] = {Parameter{"angle", Unit::degree, 0, -quarter_turn, quarter_turn, "angle"}};
constexpr Declaration about{100, "shovel", "of a user", parameters, {}, {}, sources};

class Shovel final : public ActuationModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }
  void advance(const Surroundings& /*surroundings*/, const Tuning& /*tuning*/, const std::int32_t* /*state*/,
               std::int32_t* /*next*/) const override {}
  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* /*state*/) const override {
    return 0;
  }
};
constexpr Shovel shovel;

class RobotWithShovel : public ScriptedRobot {
 public:
  RobotWithShovel() : ScriptedRobot(3) {
    setup().kernel.slots[1] = {&shovel, JointMask::first(3)};
    for (unsigned joint = 0; joint < 3; ++joint) {
      module(joint).configuration_crc = canopen::configuration_crc(setup());
      module(joint).user_algorithms[sub_index] = sources;
    }
  }
};

void expect_missing(RobotWithShovel& robot, std::uint32_t found) {
  const Problem problem = robot.problem_of_start();
  EXPECT_EQ(problem.code, ProblemCode::missing_algorithm);
  EXPECT_EQ(problem.joint, 1);
  EXPECT_EQ(problem.algorithm, 100);
  EXPECT_EQ(problem.found, found);
  EXPECT_EQ(problem.expected, sources);
  for (unsigned joint = 0; joint < 3; ++joint) {
    EXPECT_EQ(robot.module(joint).power(), canopen::PowerState::switch_on_disabled) << "nothing has power";
  }
}

TEST(UserAlgorithm, ModulesThatHaveItStart) {
  RobotWithShovel robot;
  robot.start();
  EXPECT_TRUE(robot.run_until_running());
}

TEST(UserAlgorithm, AModuleWithoutItIsNamed) {
  RobotWithShovel robot;
  robot.module(1).user_algorithms.clear();
  expect_missing(robot, 0);
}

TEST(UserAlgorithm, AModuleWithOtherSourcesIsNamed) {
  RobotWithShovel robot;
  robot.module(1).user_algorithms[sub_index] = 0xBAD;
  expect_missing(robot, 0xBAD);
}

TEST(UserAlgorithm, AModuleWhoseProgramIsOlderThanTheObjectIsNamed) {
  RobotWithShovel robot;
  robot.module(1).refusal = [](canopen::Address address, bool /*writing*/, std::uint32_t /*value*/) {
    return address.index == 0x200F ? canopen::AbortCode::no_such_object : canopen::AbortCode::none;
  };
  expect_missing(robot, 0);
}

TEST(UserAlgorithm, AGaitWithoutOneDoesNotAskForIt) {
  ScriptedRobot robot(3);
  robot.module(1).refusal = [](canopen::Address address, bool /*writing*/, std::uint32_t /*value*/) {
    EXPECT_NE(address.index, 0x200F);
    return canopen::AbortCode::none;
  };
  robot.start();
  EXPECT_TRUE(robot.run_until_running());
}

TEST(UserAlgorithm, TheMessageSaysWhatToDo) {
  Problem problem;
  problem.code = ProblemCode::missing_algorithm;
  problem.node = 3;
  problem.algorithm = 100;  // not in the registry of this program
  problem.expected = sources;
  const auto name = [](std::uint8_t node) { return "node " + std::to_string(node); };
  EXPECT_EQ(problem_text(problem, name),
            "node 3: the program of the module lacks an algorithm: found none, expected the algorithm with id 100 with "
            "sources 0x00C0FFEE; flash an image that is built with it (docs/user-algorithms.md)");
}

}  // namespace
}  // namespace proleg::test
