// Models for users of MuJoCo: MuJoCo's own compiler reads those of all shipped scenarios.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <string>

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

}  // namespace
}  // namespace proleg::sim::mujoco
