// The map from joints to modules. The small robot's file counts from the tail: J1 is kernel joint 1, J2 kernel joint 0.

#include <gtest/gtest.h>

#include "memory_files.hpp"

namespace proleg::sim {
namespace {

TEST(Modules, WithoutAMapNodeIdsCountFromOneAtTheHead) {
  MemoryFiles files = small_scenario();
  const Scenario scenario = files.scenario();
  EXPECT_EQ(scenario.robot.joints[0].name, "J2");
  EXPECT_EQ(scenario.modules, (std::vector<ModulePlace>{{1, std::nullopt}, {2, std::nullopt}}));
}

TEST(Modules, AreInKernelOrderForAnyOrderInTheFile) {
  const std::string j1 = R"(<module joint="J1" node="126" serial="0x1234ABCD"/>)";
  const std::string j2 = R"(<Module Joint="J2" NODE="1"/>)";
  const std::vector<ModulePlace> expected{{1, std::nullopt}, {126, 0x1234ABCD}};
  for (const std::string& modules : {j1 + j2, j2 + j1}) {
    MemoryFiles files = small_scenario();
    files.replace("robot.xml", "<Robot name=\"small\">", "<Robot name=\"small\">" + modules);
    EXPECT_EQ(files.scenario().modules, expected);
  }
}

TEST(Modules, SerialNumbersAreDecimalOrHexadecimal) {
  MemoryFiles files = small_scenario();
  files.replace(
      "robot.xml", "</Robot>",
      R"(<module joint="J1" node="0x10" serial="4294967295"/><module joint="J2" node="2" serial="0Xff"/></Robot>)");
  EXPECT_EQ(files.scenario().modules, (std::vector<ModulePlace>{{2, 0xFF}, {16, 0xFFFFFFFF}}));
}

}  // namespace
}  // namespace proleg::sim
