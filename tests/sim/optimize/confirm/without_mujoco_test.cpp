// What a program without MuJoCo says of a gait. This test is linked with that part, whether MuJoCo is installed or not.

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/optimize/confirm/gait_confirmation.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {
namespace {

TEST(ConfirmationWithoutMujoco, SaysInOneLineWhatToInstall) {
  sim::DiskFiles files;
  sim::Scenario scenario =
      sim::read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
  scenario.duration_s = 2.0;
  const GaitConfirmation confirmation = confirm_gait(scenario, {2, 1}, {});
  const auto mujoco = std::ranges::find(confirmation.findings, "MuJoCo", &ConfirmationFinding::name);
  ASSERT_NE(mujoco, confirmation.findings.end());
  EXPECT_TRUE(mujoco->is_good) << "what cannot be compared is no doubt";
  EXPECT_TRUE(mujoco->text.starts_with("not compared: ")) << mujoco->text;
  EXPECT_NE(mujoco->text.find("not built in"), std::string::npos) << mujoco->text;
  EXPECT_NE(mujoco->text.find("libmujoco-dev"), std::string::npos) << mujoco->text;
  EXPECT_EQ(mujoco->text.find('\n'), std::string::npos) << mujoco->text;
  EXPECT_TRUE(confirmation.is_real()) << confirmation_text(confirmation);
  EXPECT_NE(confirmation_text(confirmation).find("\n  -      MuJoCo "), std::string::npos) << "not 'ok'";
}

}  // namespace
}  // namespace proleg::optimize
