// Models for users of MuJoCo: MuJoCo's own compiler reads those of all shipped scenarios.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/mjcf/mjcf.hpp"
#include "sim/mujoco/mujoco_model.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim::mujoco {
namespace {

/// MuJoCo 2.2.2 has another name for a similar integrator.
std::string for_this_version(std::string text) {
  const std::string integrator = "implicitfast";
  const std::size_t at = text.find(integrator);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, integrator.size(), "implicit");
}

TEST(MjcfExport, MujocoCompilesEveryShippedScenario) {
  DiskFiles files;
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path("/sim/scenarios"))) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".simulation.xml")) {
      continue;
    }
    SCOPED_TRACE(path);
    ++count;
    const Scenario scenario = read_scenario(path, files);
    const RobotModel& robot = scenario.robot;
    const MjcfExport exported = export_mjcf(robot, scenario.environment, scenario.step_s);
    if (exported.text.find("elevation=") != std::string::npos) {
      continue;  // MuJoCo 2.2.2 has no heights in its XML
    }
    const Model model = compile_mjcf(for_this_version(exported.text), path);
    ASSERT_EQ(model->nu, static_cast<int>(robot.joints.size()));
    ASSERT_EQ(model->nkey, 1);
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
      const int joint = mj_name2id(model.get(), mjOBJ_JOINT, robot.joints[j].name.c_str());
      EXPECT_EQ(joint, static_cast<int>(j) + 1);
      EXPECT_EQ(mj_name2id(model.get(), mjOBJ_ACTUATOR, robot.joints[j].name.c_str()), static_cast<int>(j));
      EXPECT_EQ(model->actuator_trnid[2 * j], joint);
      EXPECT_EQ(model->actuator_forcerange[2 * j + 1], robot.joints[j].max_torque);
      EXPECT_EQ(model->dof_frictionloss[model->jnt_dofadr[joint]], 0.0);
    }
    for (const Link& link : robot.links) {
      const int body = mj_name2id(model.get(), mjOBJ_BODY, link.name.c_str());
      ASSERT_GT(body, 0) << link.name;
      EXPECT_EQ(model->body_mass[body], link.mass.mass);
    }
  }
  EXPECT_GE(count, 30U);
}

/// The shipped caterpillar, for a change of its robot.
Scenario caterpillar() {
  DiskFiles files;
  return read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
}

Model compiled(const Scenario& scenario, std::vector<std::string>& lost) {
  MjcfExport exported = export_mjcf(scenario.robot, scenario.environment, scenario.step_s);
  lost = std::move(exported.lost);
  return compile_mjcf(for_this_version(std::move(exported.text)), "exported");
}

bool has(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

TEST(MjcfExport, AnInertiaThatNoSolidHasIsBalancedAndLost) {
  Scenario scenario = caterpillar();
  std::vector<std::string> lost;
  static_cast<void>(compiled(scenario, lost));
  EXPECT_FALSE(has(lost, "inertia"));
  scenario.robot.links[2].mass.inertia = Eigen::Vector3d(1.5e-6, 2e-7, 8.3e-7).asDiagonal();
  const Model model = compiled(scenario, lost);
  EXPECT_TRUE(has(lost, "the inertia of link '" + scenario.robot.links[2].name + "', which no solid has"));
  EXPECT_NEAR(model->body_inertia[3 * 3], (1.5e-6 + 2e-7 + 8.3e-7) / 3.0, 1e-12);
}

TEST(MjcfExport, PlatesAndTinyBodiesHaveAnInertiaThatMujocoReads) {
  Scenario scenario = caterpillar();
  std::vector<std::string> lost;
  // The moments of a plate across its sides are together the one about its normal, but for the last bit.
  const Eigen::Quaterniond oblique(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  for (const double side : {0.1, 0.03, 0.007}) {
    const Eigen::Vector3d moments(side * side / 12.0, 0.3 * side, side * side / 12.0 + 0.3 * side);
    scenario.robot.links[1].mass.inertia =
        oblique.toRotationMatrix() * moments.asDiagonal() * oblique.toRotationMatrix().transpose();
    const Model model = compiled(scenario, lost);
    EXPECT_NEAR(model->body_inertia[3 * 2], moments[2], 1e-6 * moments[2]);
    EXPECT_FALSE(has(lost, "inertia"));
  }
  for (const double moment : {1e-12, 1e-14, 1e-16, 1e-21}) {
    scenario.robot.links[1].mass.inertia = Eigen::Vector3d(moment, moment, 1.5 * moment).asDiagonal();
    scenario.robot.links[1].mass.mass = 1e-6;
    static_cast<void>(compiled(scenario, lost));
    EXPECT_EQ(has(lost, "which is too small for MuJoCo"), moment < 1e-13) << moment;
  }
}

TEST(MjcfExport, NamesThatMujocoHasOrThatLookAlikeStayApart) {
  Scenario scenario = caterpillar();
  std::vector<std::string> lost;
  std::vector<Link>& links = scenario.robot.links;
  links[0].name = "world_";
  links[1].name = "world";
  links[2].name = "a 'b' & \"c\" <d>";
  links[2].geometries.push_back(links[2].geometries.front());
  links[3].name = links[2].name + "_2";
  links[4].name = " 1/2 ";
  links[5].name = "start";
  scenario.robot.joints[0].name = "world";
  scenario.robot.joints[1].name = "ä ö";
  const Model model = compiled(scenario, lost);
  EXPECT_GT(mj_name2id(model.get(), mjOBJ_BODY, "world_"), 0);
  EXPECT_EQ(mj_name2id(model.get(), mjOBJ_BODY, "world__"), 2);
  EXPECT_TRUE(has(lost, "the name of link 'world', which MuJoCo's own body has: it is 'world__'"));
  EXPECT_EQ(mj_name2id(model.get(), mjOBJ_BODY, links[2].name.c_str()), 3);
  EXPECT_EQ(mj_name2id(model.get(), mjOBJ_JOINT, "world"), 1);
  EXPECT_EQ(mj_name2id(model.get(), mjOBJ_ACTUATOR, "ä ö"), 1);
}

TEST(MjcfExport, AJointThatDoesNotMoveHasRangesThatMujocoReads) {
  Scenario scenario = caterpillar();
  std::vector<std::string> lost;
  for (const auto& [lower, upper] : {std::pair(0.0, 0.0), {-1e-9, 0.0}, {0.0, 6.2}, {-6.2, 0.0}}) {
    scenario.robot.joints[2].lower_limit = lower;
    scenario.robot.joints[2].upper_limit = upper;
    const Model model = compiled(scenario, lost);
    EXPECT_LT(model->jnt_range[2 * 3], model->jnt_range[2 * 3 + 1]);
    EXPECT_LT(model->actuator_ctrlrange[2 * 2], model->actuator_ctrlrange[2 * 2 + 1]);
    EXPECT_LE(model->actuator_ctrlrange[2 * 2], 0.0);
    EXPECT_NEAR(model->jnt_range[2 * 3 + 1], upper, 1.1e-6);
  }
}

TEST(MjcfExport, MeshesOfEverySizeAndFewCornersAreRead) {
  Scenario scenario = caterpillar();
  std::vector<std::string> lost;
  for (const double size : {1.0, 0.01, 0.001, 0.0002}) {
    TriangleMesh mesh;
    mesh.vertices = {{0.0, 0.0, 0.0}, {size, 0.0, 0.0}, {0.0, size, 0.0}, {0.0, 0.0, std::min(size, 0.001)}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    Geometry& solid = scenario.robot.links[1].geometries.front();
    solid.shape = Shape::hull;
    solid.mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
    const Model model = compiled(scenario, lost);
    EXPECT_EQ(model->nmesh, 1) << size;
  }
}

}  // namespace
}  // namespace proleg::sim::mujoco
