// A host or a SYNC producer that is lost while the robot moves, at random instants: every joint is in a safe state
// within 1.5 s, and nothing moves again without a new start. Then: frames that make no sense.
//
// PROLEG_INSTANTS and PROLEG_INSTANTS_FIRST: how many instants of each kind, and the first seed. PROLEG_RANDOM_FRAMES:
// how many frames.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "left_alone_robot.hpp"
#include "tests/support/from_environment.hpp"

namespace proleg::test {
namespace {

/// What happens, and the number of joints of the robot.
class LeftAlone : public testing::TestWithParam<std::pair<std::string, unsigned>> {};

TEST_P(LeftAlone, EveryJointIsSafeWithinOneAndAHalfSecondsAndStaysSo) {
  const auto& [event, joints] = GetParam();
  const sim::Scenario scenario = wave_of(joints);
  const std::uint32_t first = from_environment("PROLEG_INSTANTS_FIRST", 1);
  const std::uint32_t instants = from_environment("PROLEG_INSTANTS", 2);
  for (std::uint32_t seed = first; seed < first + instants && !testing::Test::HasFatalFailure(); ++seed) {
    expect_safe_after(event, scenario, seed);
  }
  std::cout << event << ", " << joints << " joints: " << instants << " instants, seeds from " << first << "\n";
}

std::vector<std::pair<std::string, unsigned>> events() {
  std::vector<std::pair<std::string, unsigned>> all;
  for (const char* const event : {"HostIsKilled", "HostIsStopped", "SyncProducerIsUnplugged"}) {
    all.emplace_back(event, 5);
  }
  for (const char* const cut : cuts) {
    for (const unsigned joints : {3U, 5U, 20U}) {
      all.emplace_back(cut, joints);
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Events, LeftAlone, testing::ValuesIn(events()), [](const auto& test) {
  return test.param.first + std::to_string(test.param.second) + "Joints";
});

/// Any frame, half of them with identifiers that modules use. Without LSS, which may give modules other node ids.
CanFrame random_frame(std::mt19937_64& random) {
  constexpr std::array<std::uint16_t, 9> bases{0x080, 0x180, 0x200, 0x280, 0x380, 0x580, 0x600, 0x680, 0x700};
  constexpr std::uint64_t first_of_lss = 0x7E4;
  CanFrame frame;
  frame.identifier = static_cast<std::uint16_t>(random() % 2 == 0 ? bases.at(random() % bases.size()) + random() % 8
                                                                  : random() % first_of_lss);
  frame.length = static_cast<std::uint8_t>(random() % 9);
  for (std::uint8_t& byte : frame.data) {
    byte = static_cast<std::uint8_t>(random() % 4 == 0 ? random() % 16 : random());
  }
  return frame;
}

TEST(RobotAmongRandomFrames, EveryPulseIsWithinTheLimits) {
  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  for (AngleLimits& limits : scenario.joint_limits) {
    limits = {raw(Unit::degree, -30), raw(Unit::degree, 30)};
  }
  constexpr std::int32_t limit = 30 * 12'000 / 90;
  const std::uint32_t frames = from_environment("PROLEG_RANDOM_FRAMES", 10'000);
  constexpr std::uint32_t frames_of_a_host = 100;
  constexpr std::uint64_t seed = 14;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  LiveBus bus(scenario);
  std::uint64_t sent = 0;
  std::uint64_t pulses = 0;
  std::int32_t largest = 0;
  for (std::uint32_t i = 0; i < frames; i += frames_of_a_host) {
    // Sooner or later one of the frames stops the robot.
    DrivingHost host(bus, scenario);
    ASSERT_TRUE(host.start()) << describe(host.drive.master().problem().code) << " after " << sent << " frames";
    for (std::uint32_t j = 0; j < frames_of_a_host; ++j) {
      sent += bus.robot().send(random_frame(random)) ? 1U : 0U;
      bus.run_for(std::uniform_int_distribution<Microseconds>(50, 800)(random));
      for (unsigned joint = 0; joint < bus.robot().joint_count(); ++joint) {
        if (const auto pulse = bus.robot().module(joint).pulse()) {
          ++pulses;
          largest = std::max(largest, std::abs(*pulse - middle));
          ASSERT_LE(std::abs(*pulse - middle), limit) << "joint " << joint << " after " << sent << " frames";
        }
      }
    }
  }
  EXPECT_GT(pulses, sent / 2) << "the robot must have moved";
  EXPECT_EQ(largest, limit) << "the gait has an amplitude of 40 degrees";
  std::cout << sent << " random frames, " << pulses << " pulses looked at, the largest " << largest << " of " << limit
            << "\n";
}

}  // namespace
}  // namespace proleg::test
