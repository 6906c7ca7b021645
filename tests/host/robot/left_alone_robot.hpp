#pragma once

// A robot that moves until something happens to the way between it and its host, or to the host.

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "driving_host.hpp"
#include "shipped.hpp"

namespace proleg::test {

/// The travelling wave on a robot of so many joints: travelling_wave/uniform, shorter or longer. joints: 2 or more.
inline sim::Scenario wave_of(unsigned joints) {
  const std::string folder = source_path("/sim/scenarios/travelling_wave/");
  const auto body = [](const std::string& prefix, const std::string& kind, double at) {
    return "<KinBody " + prefix + " file='modules/" + kind + ".kinbody.xml'><translation>0 " + std::to_string(at) +
           " 0</translation></KinBody>";
  };
  constexpr double length = 0.072;  // metres, of a segment
  std::string robot = "<Robot name='caterpillar'><KinBody name='body'>" + body("", "tail", 0);
  for (unsigned joint = 1; joint <= joints; ++joint) {
    const auto name = [joints](unsigned link) {
      return link == 0 ? "Tail" : link == joints ? "Head" : std::to_string(link) + "Seg";
    };
    robot += joint < joints ? body("prefix='" + std::to_string(joint) + "'", "segment", (joint - 1) * length)
                            : body("", "head", (joint - 1) * length);
    robot += "<Joint name='J" + std::to_string(joint) + "' type='hinge'><body>" + name(joint - 1) + "</body><body>" +
             name(joint) + "</body><offsetfrom>" + name(joint) +
             "</offsetfrom><axis>1 0 0</axis><maxtorque>0.4</maxtorque><maxvel>4.5</maxvel>"
             "<limitsdeg>-90 90</limitsdeg></Joint>";
  }
  std::string actuation = file_contents(folder + "uniform.actuation.xml");
  actuation.replace(actuation.find("11111"), 5, std::string(joints, '1'));
  sim::SourceTexts files;
  files.add(folder + "caterpillar.robot.xml", robot + "</KinBody></Robot>");
  files.add(folder + "uniform.actuation.xml", actuation);
  for (const std::string file : {"uniform.simulation.xml", "flat.environment.xml", "modules/tail.kinbody.xml",
                                 "modules/segment.kinbody.xml", "modules/head.kinbody.xml"}) {
    files.add(folder + file, file_contents(folder + file));
  }
  return sim::read_scenario(folder + "uniform.simulation.xml", files);
}

/// What a joint may move for after its host or SYNC is gone (docs/safety.md).
inline constexpr Microseconds longest_us = 1'500'000;
inline constexpr std::int32_t middle = 18'000;  ///< pulse at 0 degrees, in 1/12 us

class LeftAloneRobot {
 public:
  LeftAloneRobot(const sim::Scenario& scenario, std::uint32_t seed, sim::LiveRobotOptions options = {})
      : random_(seed), bus_(scenario, std::move(options)), host_(std::make_unique<DrivingHost>(bus_, scenario)) {}

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
    } else if (what == "NothingComesFromTheRobot") {
      bus_.cut_from_robot(random_() % 2 == 0);
    } else if (what == "NothingReachesTheRobot") {
      bus_.cut_to_robot();
    } else {
      bus_.robot().bus().controller(bus_.robot().module(0).controller()).unplug();  // joint 0 produces SYNC
    }
  }

  void expect_safe() {
    for (unsigned joint = 0; joint < bus_.robot().joint_count(); ++joint) {
      const std::optional<std::int32_t> pulse = bus_.robot().module(joint).pulse();
      EXPECT_EQ(pulse.value_or(middle), middle) << "joint " << joint;
    }
  }

  /// Lets time pass. A host whose master has failed stops the robot, as `proleg drive` does.
  void run_for(Microseconds duration) {
    const Microseconds end = bus_.now() + duration;
    if (bus_.run_until(end,
                       [this] { return host_ && host_->drive.master().state() == canopen::MasterState::failed; })) {
      host_->drive.master().stop(bus_.now());
      bus_.run_until(end, [] { return false; });
    }
  }

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

/// Both directions of the connection between host and robot, and each by itself.
inline constexpr std::array cuts{"CableIsPulled", "NothingComesFromTheRobot", "NothingReachesTheRobot"};

/// From within 1.5 s after the event on, every joint has no pulses or holds its safe pose.
inline void expect_safe_after(const std::string& event, const sim::Scenario& scenario, std::uint32_t seed,
                              sim::LiveRobotOptions options = {}) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  LeftAloneRobot robot(scenario, seed, std::move(options));
  robot.move_for_some_time();
  if (testing::Test::HasFatalFailure()) {
    return;
  }
  robot.happens(event);
  robot.run_for(longest_us);
  robot.expect_safe();
  for (unsigned i = 0; i < 10; ++i) {
    robot.run_for(100'000);
    robot.expect_safe();
  }
}

}  // namespace proleg::test
