// The properties of a run in the top-level file, and the remarks on tags without effect.

#include <gtest/gtest.h>

#include <algorithm>

#include "memory_files.hpp"
#include "tests/sim/mesh/mesh_shapes.hpp"

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

TEST(Remarks, NameWhatOnlyPlannersAndPlugInsOfOpenRaveUse) {
  MemoryFiles files = small_scenario();
  files
      .replace("robot.xml", "<maxvel>5</maxvel>",
               "<maxvel>5</maxvel><resolution>1</resolution>\n<weight>0.5</weight><maxaccel>2</maxaccel>")
      .replace("robot.xml", "name=\"J2\"", "name=\"J2\" enable=\"true\" circular=\"FALSE\"")
      .replace("robot.xml", "<Robot name=\"small\">", "<Robot name=\"small\" type=\"GenericRobot\">");
  const Scenario scenario = files.scenario();
  for (const char* text :
       {"robot.xml:42: <resolution> has no effect", "robot.xml:43: <weight> has no effect",
        "robot.xml:43: <maxaccel> has no effect", "robot.xml:1: attribute 'type' in <Robot> has no effect"}) {
    EXPECT_TRUE(remarked(scenario, text)) << text;
  }
  EXPECT_EQ(scenario.remarks.size(), 5U);
}

TEST(Remarks, AreMadeForFrictionOfWhatIsOnlyShownAndForAnOpenMeshOfALink) {
  MemoryFiles files = small_scenario();
  files.texts["box.off"] = box_off;
  files.replace("robot.xml", "<Geom type=\"sphere\">\n        <radius>0.03</radius>\n      </Geom>",
                "<Geom type=\"trimesh\" open=\"1\"><data>box.off 0.1</data></Geom>"
                "<Geom type=\"trimesh\"><render>box.off 0.1</render><friction>0.5</friction></Geom>");
  const Scenario scenario = files.scenario();
  EXPECT_TRUE(remarked(scenario, "robot.xml:19: attribute 'open' in <Geom> has no effect: a body that moves"));
  EXPECT_TRUE(remarked(scenario, "robot.xml:19: <friction> has no effect: a mesh that is only shown"));
}

TEST(Remarks, AreNotEnoughForAJointThatWouldMoveInAnotherWay) {
  for (const auto& [attribute, message] :
       {std::pair("enable=\"false\"",
                  "robot.xml:35: found a passive joint, enable='false' in <Joint>, expected joints"),
        std::pair("ENABLE=\"0\"", "robot.xml:35: found a passive joint, enable='false' in <Joint>, expected joints"),
        std::pair("enable=\"banana\"", "robot.xml:35: found enable 'banana' in <Joint>, expected 'true', '1', 'false'"),
        std::pair("enable=\"\"", "robot.xml:35: found enable '' in <Joint>, expected 'true', '1', 'false'"),
        std::pair("circular=\"true\"", "robot.xml:35: found a joint that turns without end, circular='true' in"),
        std::pair("circular=\"2\"", "robot.xml:35: found circular '2' in <Joint>, expected 'true', '1', 'false'")}) {
    MemoryFiles files = small_scenario();
    files.replace("robot.xml", "name=\"J2\"", std::string("name=\"J2\" ") + attribute);
    EXPECT_EQ(refusal(files).substr(0, std::string(message).size()), message);
  }
}

TEST(Remarks, AreMadeOnlyForValuesThatAreValid) {
  for (const auto& [tag, message] :
       {std::pair("<resolution>fine</resolution>", "found 'fine' in <resolution>, expected a number from 0"),
        std::pair("<weight>1 2</weight>", "found '1 2' in <weight>, expected a number from 0"),
        std::pair("<maxaccel>-1</maxaccel>", "found '-1' in <maxaccel>, expected a number from 0")}) {
    MemoryFiles files = small_scenario();
    files.replace("robot.xml", "<maxvel>5</maxvel>", std::string("<maxvel>5</maxvel>") + tag);
    EXPECT_NE(refusal(files).find(message), std::string::npos) << refusal(files);
  }
  for (const auto& [geometry, message] :
       {std::pair("<Geom type=\"sphere\" open=\"1\">", "found attribute 'open' in <Geom>, expected one of the"),
        std::pair("<Geom type=\"sphere\" render=\"banana\">", "found render 'banana' in <Geom>, expected 'true'"),
        std::pair("<Geom type=\"sphere\"><visible>maybe</visible>", "found 'maybe' in <visible>, expected 'true'"),
        std::pair("<Geom type=\"sphere\"><transparency>x</transparency>", "found 'x' in <transparency>, expected"),
        std::pair("<Geom type=\"sphere\"><ambientColor>red</ambientColor>", "found 'red' in <ambientColor>, exp")}) {
    MemoryFiles files = small_scenario();
    files.replace("robot.xml", "<Geom type=\"sphere\">", geometry);
    EXPECT_NE(refusal(files).find(message), std::string::npos) << refusal(files);
  }
}

TEST(Remarks, SayThatAMeshOfAnotherFormatIsNotShown) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<radius>0.03</radius>", "<radius>0.03</radius><render>ball.wrl</render>");
  EXPECT_TRUE(remarked(files.scenario(), "robot.xml:20: <render> has no effect: meshes that can be shown"));
}

}  // namespace
}  // namespace proleg::sim
