#include "sim/hardware_loop/master_input.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "tests/identity/sensing_probe.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

TEST(MasterInput, OfAnAlgorithmThatReadsASensorWhichNoModuleHasIsRefusedByName) {
  Scenario scenario = shipped("travelling_wave/uniform");
  EXPECT_NO_THROW(MasterInput{scenario});
  scenario.kernel.slots[2] = {&identity::reading_probe(), JointMask::first(2)};
  const std::string message = message_of<InputError>([&scenario] { const MasterInput input(scenario); });
  EXPECT_NE(message.find("(3), which reads the inclination of its link, expected an algorithm that reads what a module "
                         "measures"),
            std::string::npos)
      << message;
}

}  // namespace
}  // namespace proleg::sim
