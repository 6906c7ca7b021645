// The properties of a run in the top-level file, and the remarks on tags without effect.

#include <gtest/gtest.h>

#include <algorithm>

#include "memory_files.hpp"

namespace proleg::sim {
namespace {

bool remarked(const Scenario& scenario, const std::string& text) {
  return std::ranges::any_of(scenario.remarks,
                             [&](const std::string& remark) { return remark.find(text) != std::string::npos; });
}

TEST(SimulationProperties, ComeFromTheFile) {
  const Scenario scenario = small_scenario().scenario();
  EXPECT_EQ(scenario.path, "top.xml");
  EXPECT_EQ(scenario.duration_s, 2.0);
  EXPECT_EQ(scenario.step_s, 0.001);
  EXPECT_EQ(scenario.kernel.tick_period_us, 10'000U);
  EXPECT_EQ(scenario.kernel.seed, 7U);
  EXPECT_EQ(scenario.solver, Solver::direct);
}

TEST(SimulationProperties, HaveDefaults) {
  MemoryFiles files = small_scenario();
  files.texts["top.xml"] =
      "<simulation><environment>environment.xml</environment><actuation>actuation.xml</actuation>"
      "<robot>robot.xml</robot></simulation>";
  const Scenario scenario = files.scenario();
  EXPECT_EQ(scenario.duration_s, 30.0);
  EXPECT_EQ(scenario.step_s, 0.001);
  EXPECT_EQ(scenario.kernel.tick_period_us, 10'000U);
  EXPECT_EQ(scenario.kernel.seed, 1U);
  EXPECT_EQ(scenario.solver, Solver::automatic);
}

TEST(SimulationProperties, AcceptTheLargestSeed) {
  MemoryFiles files = small_scenario();
  files.replace("top.xml", "<seed>7", "<seed>18446744073709551615");
  EXPECT_EQ(files.scenario().kernel.seed, ~std::uint64_t{0});
}

TEST(SimulationProperties, AcceptATickOfPartsOfAMillisecondIfItIsAWholeNumberOfSteps) {
  MemoryFiles files = small_scenario();
  files.replace("top.xml", "ms\">10", "ms\">2.5").replace("top.xml", "<stepWidth>0.001", "<stepWidth>0.00025");
  EXPECT_EQ(files.scenario().kernel.tick_period_us, 2'500U);
}

TEST(SimulationProperties, AcceptNoiseOfTheTouchSensors) {
  MemoryFiles files = small_scenario();
  EXPECT_EQ(files.scenario().contact_noise, 0.0);
  files.replace("top.xml", "<seed>", "<contactNoise>0.25</contactNoise><seed>");
  EXPECT_EQ(files.scenario().contact_noise, 0.25);
}

TEST(SimulationProperties, CauseNoRemarkIfTheyAskForWhatHappens) {
  MemoryFiles files = small_scenario();
  files.replace("top.xml", "<duration>",
                "<showViewer>0</showViewer><parallelComputing>0</parallelComputing><storingData>0</storingData>"
                "<mode>Single Run Simulation</mode><duration>");
  EXPECT_EQ(files.scenario().remarks.size(), 1U) << "only the joint map";
}

TEST(Remarks, NameTagsWithoutEffect) {
  MemoryFiles files = small_scenario();
  files.replace("top.xml", "<robot>", "<sensor>tactile.sensor.xml</sensor><robot>")
      .replace("top.xml", "<duration>",
               "<parallelComputing>1</parallelComputing><mode>Optimization</mode><accuracy>30</accuracy><duration>")
      .replace("robot.xml", "</KinBody>\n</Robot>", "</KinBody><sensor><any/></sensor></Robot>")
      .replace("robot.xml", "<maxvel>5</maxvel>", "<maxvel>5</maxvel><maxaccel>1</maxaccel>")
      .replace("environment.xml", "</Body>",
               "<Mass type=\"box\"><total>1</total><extents>1 1 1</extents></Mass></Body>");
  const Scenario scenario = files.scenario();
  for (const char* text :
       {"top.xml:2: <sensor> has no effect: every link has two touch sensors",
        "top.xml:6: <parallelComputing> has no effect", "top.xml:6: <mode> has no effect",
        "top.xml:6: <accuracy> has no effect", "robot.xml:45: <sensor> has no effect: it is in no <AttachedSensor>",
        "robot.xml:42: <maxaccel> has no effect", "environment.xml:15: <Mass> has no"}) {
    EXPECT_TRUE(remarked(scenario, text)) << text;
  }
  EXPECT_EQ(scenario.remarks.size(), 8U);
}

TEST(Remarks, AreNotMadeForColours) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<radius>0.03</radius>",
                "<radius>0.03</radius><diffuseColor>1 0 0</diffuseColor><ambientcolor>1 0 0</ambientcolor>"
                "<TRANSPARENCY>0.5</TRANSPARENCY><render>true</render>");
  EXPECT_EQ(files.scenario().remarks.size(), 1U);
}

TEST(Remarks, SayThatAMeshOfAnotherFormatIsNotShown) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<radius>0.03</radius>", "<radius>0.03</radius><render>ball.wrl</render>");
  EXPECT_TRUE(remarked(files.scenario(), "robot.xml:20: <render> has no effect: meshes that can be shown"));
}

}  // namespace
}  // namespace proleg::sim
