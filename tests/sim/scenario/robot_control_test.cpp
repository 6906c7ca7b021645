// The plug-in that a robot's file names. The small robot's file counts from the tail: J1 is kernel joint 1, J2 kernel
// joint 0.

#include <gtest/gtest.h>

#include "memory_files.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

MemoryFiles robot_with(const std::string& element) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<Robot name=\"small\">", "<Robot name=\"small\">\n" + element);
  return files;
}

std::string message(const std::string& element) {
  MemoryFiles files = robot_with(element);
  return message_of<InputError>([&] { static_cast<void>(files.scenario()); });
}

TEST(RobotControlElement, IsOptional) { EXPECT_FALSE(small_scenario().scenario().robot_control); }

TEST(RobotControlElement, NamesThePluginItsParametersAndTheirLines) {
  MemoryFiles files = robot_with(
      "<Robot_Control Plugin=\"dynamixel\">\n"
      "<parameter name=\"device\" value=\"/dev/ttyUSB0\"/>\n"
      "<parameter name=\"id\" value=\"5\" joint=\"J1\"/>\n"
      "<parameter name=\"id\" value=\"6\" joint=\"J2\"/>\n"
      "</Robot_Control>");
  const Scenario scenario = files.scenario();
  ASSERT_TRUE(scenario.robot_control);
  EXPECT_EQ(scenario.robot_control->plugin, "dynamixel");
  EXPECT_EQ(scenario.robot_control->file, "robot.xml");
  EXPECT_EQ(scenario.robot_control->line, 2);
  using Parameter = RobotControlEntry::Parameter;
  EXPECT_EQ(
      scenario.robot_control->parameters,
      (std::vector<Parameter>{{"device", "/dev/ttyUSB0", std::nullopt, 3}, {"id", "5", 1U, 4}, {"id", "6", 0U, 5}}));
}

TEST(RobotControlElement, ThatIsWrongIsNamedWithFileLineFoundAndExpected) {
  EXPECT_EQ(message("<robot_control/>"), "robot.xml:2: found no attribute 'plugin' in <robot_control>, expected one");
  EXPECT_EQ(message("<robot_control plugin=' '/>"),
            "robot.xml:2: found an empty plugin in <robot_control>, expected the name of a plug-in, such as dynamixel, "
            "or its path");
  EXPECT_EQ(message("<robot_control plugin='a'/>\n<robot_control plugin='a'/>"),
            "robot.xml:3: found a second <robot_control> in <Robot>, expected one; the first is in line 2");
  EXPECT_EQ(message("<robot_control plugin='a'>\n<servo/></robot_control>"),
            "robot.xml:3: found <servo> in <robot_control>, expected <parameter>");
  EXPECT_EQ(message("<robot_control plugin='a'>\n<parameter name='id' value='1' joint='J9'/></robot_control>"),
            "robot.xml:3: found unknown joint 'J9', expected one of J1, J2");
  EXPECT_EQ(message("<robot_control plugin='a'>\n<parameter name='id'/></robot_control>"),
            "robot.xml:3: found no attribute 'value' in <parameter>, expected one");
  EXPECT_EQ(message("<robot_control plugin='a'>\n<parameter name='id' value='1' joint='J1'/>\n"
                    "<parameter name='id' value='2' joint='J1'/></robot_control>"),
            "robot.xml:4: found a second parameter 'id' for joint 'J1', expected one; the first is in line 3");
}

}  // namespace
}  // namespace proleg::sim
