// The kernel sends the worked examples of docs/protocol.md.

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "robot.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/kernel/kernel.hpp"
#include "tests/support/files.hpp"

namespace proleg {
namespace {

/// Text of a frame as candump writes it: "183 [8] 8E E3 ...".
std::string as_text(const char* identifier, const StateFrame& frame) {
  std::string text = std::string(identifier) + " [8]";
  for (const std::uint8_t byte : frame.bytes) {
    char hex[4];
    std::snprintf(hex, sizeof hex, " %02X", unsigned{byte});
    text += hex;
  }
  return text;
}

bool documentation_has_line(const std::string& text) {
  std::ifstream file(source_path("/docs/protocol.md"));
  std::string line;
  while (std::getline(file, line)) {
    if (line == "    " + text) {
      return true;
    }
  }
  return false;
}

TEST(ProtocolExample, StateFramesOfTick300AreThoseOfTheDocumentation) {
  constexpr unsigned joint = 2;
  KernelOf<1> kernel;
  KernelConfiguration configuration;
  configuration.joint_count = 5;
  configuration.slots[0] = {&pattern_generator_coupled_oscillator(), JointMask::first(5)};
  configuration.slots[1] = {&pattern_generator_sinusoidal(), JointMask::first(5)};
  ASSERT_EQ(kernel.configure(configuration, joint), Status::ok);
  const auto set = [&](unsigned slot, const char* name, std::int32_t value) {
    const Declaration& declaration = configuration.slots[slot].algorithm->declaration();
    ASSERT_EQ(kernel.set_parameter(slot, joint, static_cast<unsigned>(find_parameter(declaration, name)), value),
              Status::ok);
  };
  set(0, "amplitude", test::degrees(40));
  set(0, "frequency", 0);
  set(0, "coupling", 0);
  set(1, "amplitude", 0);
  set(1, "frequency", 0);
  set(1, "phase_difference", 0);
  set(1, "phase", test::degrees(45));
  kernel.reset();
  kernel.set_contacts(joint, StateFrame::contact_rear_link_rear | StateFrame::contact_rear_link_front);
  for (int tick = 0; tick < 300; ++tick) {
    ASSERT_EQ(test::distort(kernel, 0, joint, 0, test::degrees(110)), Status::ok);
    kernel.advance();
  }
  EXPECT_TRUE(documentation_has_line(as_text("183", kernel.frame(joint, 0)))) << as_text("183", kernel.frame(joint, 0));
  EXPECT_TRUE(documentation_has_line(as_text("283", kernel.frame(joint, 1)))) << as_text("283", kernel.frame(joint, 1));
}

}  // namespace
}  // namespace proleg
