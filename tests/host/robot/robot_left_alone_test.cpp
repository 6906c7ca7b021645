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
#include <memory>
#include <random>
#include <string>

#include "driving_host.hpp"
#include "shipped.hpp"
#include "tests/support/from_environment.hpp"

namespace proleg::test {
namespace {

constexpr Microseconds longest_us = 1'500'000;
constexpr std::int32_t middle = 18'000;  // pulse at 0 degrees, in 1/12 us

class LeftAlone : public testing::TestWithParam<std::string> {};

/// One robot that moves until something happens to its host.
class Trial {
 public:
  explicit Trial(const sim::Scenario& scenario, std::uint32_t seed)
      : random_(seed), bus_(scenario), host_(std::make_unique<DrivingHost>(bus_, scenario)) {}

  void move_for_some_time() {
    ASSERT_TRUE(host_->start());
    bus_.run_for(std::uniform_int_distribution<Microseconds>(100'000, 3'000'000)(random_));
    ASSERT_TRUE(is_moving());
  }

  void happens(const std::string& what) {
    if (what == "HostIsKilled") {
      host_.reset();
    } else if (what == "HostIsStopped") {
      // Its frames wait, and so do those of the modules; then it goes on as if nothing had been.
      const auto time = std::uniform_int_distribution<Microseconds>(1'500'000, 3'000'000)(random_);
      bus_.robot().advance_to(bus_.robot().now() + longest_us * 1'000);
      expect_safe();
      bus_.robot().advance_to(bus_.robot().now() + (time - longest_us) * 1'000);
      bus_.run_for(1);
    } else if (what == "CableIsPulled") {
      bus_.lose(1, 0);
    } else {
      bus_.robot().bus().controller(bus_.robot().module(0).controller()).unplug();  // joint 0 produces SYNC
    }
  }

  void expect_safe() {
    std::vector<std::optional<std::int32_t>> pulses;
    for (unsigned joint = 0; joint < bus_.robot().joint_count(); ++joint) {
      pulses.push_back(bus_.robot().module(joint).pulse());
      EXPECT_TRUE(!pulses.back() || *pulses.back() == middle) << "joint " << joint << " " << *pulses.back();
    }
  }

  void run_for(Microseconds duration) { bus_.run_for(duration); }
  LiveBus& bus() { return bus_; }

 private:
  [[nodiscard]] bool is_moving() {
    bool moves = true;
    for (unsigned joint = 0; joint < bus_.robot().joint_count(); ++joint) {
      moves = moves && bus_.robot().module(joint).pulse().has_value();
    }
    return moves;
  }

  std::mt19937_64 random_;
  LiveBus bus_;
  std::unique_ptr<DrivingHost> host_;
};

TEST_P(LeftAlone, EveryJointIsSafeWithinOneAndAHalfSecondsAndStaysSo) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  const std::uint32_t first = from_environment("PROLEG_INSTANTS_FIRST", 1);
  const std::uint32_t instants = from_environment("PROLEG_INSTANTS", 3);
  for (std::uint32_t seed = first; seed < first + instants; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Trial trial(scenario, seed);
    trial.move_for_some_time();
    if (testing::Test::HasFatalFailure()) {
      return;
    }
    trial.happens(GetParam());
    trial.run_for(longest_us);
    trial.expect_safe();
    for (unsigned i = 0; i < 10; ++i) {
      trial.run_for(100'000);
      trial.expect_safe();
    }
  }
  std::cout << GetParam() << ": " << instants << " instants, seeds from " << first << "\n";
}

INSTANTIATE_TEST_SUITE_P(Events, LeftAlone,
                         testing::Values("HostIsKilled", "HostIsStopped", "CableIsPulled", "SyncProducerIsUnplugged"),
                         [](const auto& event) { return event.param; });

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
