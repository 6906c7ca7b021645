// Whatever happens to the host, or to the line between it and the robot, at any instant from the moment on at which the
// first joint has power: how long it takes until each joint has left Operation enabled, and until its pulses rest. The
// robots of 3 to 60 joints move as far as they can; host and robot are connected by slcan.
//
// PROLEG_INSTANTS and PROLEG_INSTANTS_FIRST: how many instants for each robot and fault, and the first seed.

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "left_alone_robot.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/from_environment.hpp"

namespace proleg::test {
namespace {

using canopen::MasterState;
using canopen::PowerState;

// docs/safety.md, rule 3.
constexpr Microseconds until_left_us = 750'000;
constexpr Microseconds until_rest_us = 1'500'000;

/// The travelling wave with the largest amplitude, and slow: it dwells at the ends of the joints' ranges. The world
/// only gives the angles at which the joints ramp in.
sim::Scenario widest_wave_of(unsigned joints) {
  sim::Scenario scenario = wave_of(joints);
  scenario.environment.engine = sim::PhysicsEngine::reduced;
  for (const std::string setting : {"amplitude=90", "frequency=0.5"}) {
    const sim::ParsedSetting parsed = sim::parse_setting(scenario, setting);
    scenario.settings.insert(scenario.settings.end(), parsed.settings.begin(), parsed.settings.end());
  }
  return scenario;
}

class Fault {
 public:
  /// After the event; 0: not at all.
  struct Times {
    Microseconds left = 0;  ///< the last joint leaves Operation enabled
    Microseconds rest = 0;  ///< the last pulse that differs from the one before
  };

  Fault(const sim::Scenario& scenario, std::uint32_t seed)
      : random_(seed), bus_(scenario), line_(bus_.connect_by_slcan()) {
    host_ = std::make_unique<DrivingHost>(bus_, scenario);
  }

  /// At a random instant of the first seconds with power: joints ramp in, SYNC begins, the gait moves.
  void wait_for_instant() {
    host_->drive.master().start(bus_.now());
    ASSERT_TRUE(bus_.run_until(20'000'000, [this] { return has_power(); }));
    run_for(std::uniform_int_distribution<Microseconds>(0, 4'000'000)(random_));
    ASSERT_TRUE(has_power()) << describe(host_->drive.master().problem().code);
  }

  void happens(const std::string& what) {
    constexpr Microseconds late = 600'000;
    if (what == "HostIsKilled") {
      host_.reset();
    } else if (what == "HostIsStopped" || what == "HostIsSuspended") {
      line_.suspend_host(true);
      resumes_at_ = what == "HostIsStopped"
                        ? never
                        : bus_.now() + std::uniform_int_distribution<Microseconds>(450'000, 2'000'000)(random_);
    } else if (what == "NothingComesFromTheRobot") {
      line_.cut_from_robot();
    } else if (what == "NothingReachesTheRobot") {
      line_.cut_to_robot();
    } else {
      line_.delay(late);
    }
  }

  Times measure() {
    constexpr Microseconds watched = 4'000'000;
    constexpr Microseconds step = 1'000;
    const Microseconds begin = bus_.now();
    const unsigned joints = bus_.robot().joint_count();
    std::vector<std::optional<std::int32_t>> pulses(joints);
    Times times;
    for (unsigned joint = 0; joint < joints; ++joint) {
      pulses[joint] = bus_.robot().module(joint).pulse();
    }
    for (Microseconds passed = step; passed <= watched; passed += step) {
      advance_to(begin + passed);
      for (unsigned joint = 0; joint < joints; ++joint) {
        sim::JointModule& module = bus_.robot().module(joint);
        const auto pulse = module.pulse();
        times.left = module.power() == PowerState::operation_enabled ? passed : times.left;
        times.rest = pulse && pulse != pulses[joint] ? passed : times.rest;
        pulses[joint] = pulse;
      }
    }
    return times;
  }

 private:
  [[nodiscard]] bool has_power() {
    for (unsigned joint = 0; joint < bus_.robot().joint_count(); ++joint) {
      if (bus_.robot().module(joint).power() == PowerState::operation_enabled) {
        return true;
      }
    }
    return false;
  }

  void advance_to(Microseconds time) {
    if (resumes_at_ > time) {
      bus_.robot().advance_to(time * 1'000);
      line_.poll_robot();
      return;
    }
    line_.suspend_host(false);
    run_for(time - bus_.now());
  }

  /// A host whose master has failed stops the robot, as all programs do.
  void run_for(Microseconds duration) {
    const Microseconds end = bus_.now() + duration;
    if (bus_.run_until(end, [this] { return host_ && host_->drive.master().state() == MasterState::failed; })) {
      host_->drive.master().stop(bus_.now());
      bus_.run_until(end, [] { return false; });
    }
  }

  std::mt19937_64 random_;
  LiveBus bus_;
  SlcanLine& line_;
  std::unique_ptr<DrivingHost> host_;
  Microseconds resumes_at_ = 0;
};

/// Milliseconds, sorted.
std::string median_and_worst(std::vector<Microseconds> times) {
  std::ranges::sort(times);
  return std::to_string(times[times.size() / 2] / 1'000) + " " + std::to_string(times.back() / 1'000);
}

class StopTimes : public testing::TestWithParam<std::pair<std::string, unsigned>> {};

TEST_P(StopTimes, OfEveryJointAreWithinTheirBounds) {
  const auto& [event, joints] = GetParam();
  const sim::Scenario scenario = widest_wave_of(joints);
  const std::uint32_t first = from_environment("PROLEG_INSTANTS_FIRST", 1);
  const std::uint32_t instants = from_environment("PROLEG_INSTANTS", joints > 20 ? 1 : 2);
  std::vector<Microseconds> left;
  std::vector<Microseconds> rest;
  for (std::uint32_t seed = first; seed < first + instants; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Fault fault(scenario, seed);
    fault.wait_for_instant();
    if (HasFatalFailure()) {
      return;
    }
    fault.happens(event);
    const Fault::Times times = fault.measure();
    EXPECT_LE(times.left, until_left_us);
    EXPECT_LE(times.rest, until_rest_us);
    left.push_back(times.left);
    rest.push_back(times.rest);
  }
  std::cout << event << ", " << joints << " joints, " << instants << " instants, seeds from " << first
            << "; median and worst in ms: left " << median_and_worst(left) << ", at rest " << median_and_worst(rest)
            << "\n";
}

std::vector<std::pair<std::string, unsigned>> faults() {
  std::vector<std::pair<std::string, unsigned>> all;
  for (const unsigned joints : {3U, 5U, 20U, 60U}) {
    for (const char* const event : {"NothingComesFromTheRobot", "NothingReachesTheRobot", "HostIsKilled",
                                    "HostIsStopped", "HostIsSuspended", "LineIsLate"}) {
      all.emplace_back(event, joints);
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Faults, StopTimes, testing::ValuesIn(faults()), [](const auto& test) {
  return test.param.first + std::to_string(test.param.second) + "Joints";
});

}  // namespace
}  // namespace proleg::test
