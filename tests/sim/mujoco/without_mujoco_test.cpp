// What a program without MuJoCo says. This test is linked with that part, whether MuJoCo is installed or not.

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "sim/mujoco/mujoco_world.hpp"
#include "tests/sim/physics/small_world.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim::mujoco {
namespace {

TEST(WithoutMujoco, TheEngineIsRefusedAndThePackageNamed) {
  EXPECT_FALSE(is_built_in());
  const std::string message = message_of<InputError>(
      [] { static_cast<void>(make_mujoco_world(chain(1), flat_ground(0.5, 0.02), step_s, "gait.simulation.xml")); });
  EXPECT_EQ(
      message,
      "gait.simulation.xml: found the engine MuJoCo, which is not built in, expected one of the other engines, or "
      "a program that was built where libmujoco-dev 2.2.2 is installed");
}

}  // namespace
}  // namespace proleg::sim::mujoco
