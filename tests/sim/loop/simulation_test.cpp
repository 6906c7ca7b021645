#include "sim/loop/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "shared/kernel/servo_pulses.hpp"
#include "shipped.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

struct SimulationRun {
  double displacement;
  std::string setpoints;
  std::string servo_commands;

  friend bool operator==(const SimulationRun&, const SimulationRun&) = default;
};

SimulationRun simulate(const Scenario& scenario, double seconds) {
  Simulation simulation(scenario);
  while (simulation.time_s() < seconds - 1e-9) {
    simulation.advance();
  }
  return {simulation.plant().displacement(), simulation.setpoint_hash().hex(), simulation.servo_hash().hex()};
}

// A regression test of the calibration, no independent evidence: friction and servo gain of the shipped robot were
// fitted to the displacement that the thesis reports.
TEST(Simulation, TheCalibratedTravellingWaveKeepsTheDisplacementOfTheThesis) {
  const double uniform = simulate(shipped("travelling_wave/uniform"), 30).displacement;
  const double tail_fixed = simulate(shipped("travelling_wave/tail_fixed"), 30).displacement;
  // Thesis, section 6.1: 1.65 m, and 1.95 m with the tail joint at rest. The bounds are wider than the solver's noise:
  // a change of friction by 0.01 changes the displacement by 0.18 m.
  EXPECT_NEAR(uniform, 1.65, 0.15);
  EXPECT_GE(tail_fixed / uniform, 1.05);
  EXPECT_LE(tail_fixed / uniform, 1.30);
}

/// In 30 s; it begins with the tick.
std::string failure_of(const Scenario& scenario) {
  Simulation simulation(scenario);
  std::uint32_t tick = 0;
  try {
    for (; tick < tick_count(scenario); ++tick) {
      simulation.advance();
    }
  } catch (const PhysicsError& error) {
    EXPECT_EQ(std::string(error.what()).find("tick " + std::to_string(tick) + " ("), 0U) << error.what();
    return error.what();
  }
  return "none";
}

TEST(Simulation, ARobotThatFallsIsAFailedRun) {
  Scenario scenario = shipped("travelling_wave/uniform");
  EXPECT_EQ(failure_of(scenario), "none");
  scenario.environment.objects[0].geometries[0].extents.y() = 0.5;
  EXPECT_NE(failure_of(scenario).find("fell off"), std::string::npos) << "over an edge half a metre away";
  scenario.environment.objects.clear();
  EXPECT_NE(failure_of(scenario).find("fell off"), std::string::npos) << "nothing to stand on";
}

TEST(Simulation, ARobotThatBreaksUpIsAFailedRun) {
  Scenario scenario = shipped("travelling_wave/uniform");
  for (Link& link : scenario.robot.links) {
    link.geometries[0].extents = {100, 100, 100};  // far larger than the links: the solver throws them apart
  }
  EXPECT_NE(failure_of(scenario), "none");
}

TEST(Simulation, APositivePhaseDifferenceCrawlsHeadFirst) {
  for (const char* degrees : {"55", "-55"}) {
    Scenario scenario = shipped("travelling_wave/uniform");
    apply_setting(scenario, std::string("phase_difference=") + degrees);
    Simulation simulation(scenario);
    const Eigen::Vector3d tail_to_head =
        simulation.plant().link_poses().front().position - simulation.plant().link_poses().back().position;
    const Eigen::Vector3d start = simulation.plant().world().center_of_mass();
    for (int i = 0; i < 500; ++i) {
      simulation.advance();
    }
    const double forward = (simulation.plant().world().center_of_mass() - start).dot(tail_to_head.normalized());
    if (degrees[0] == '-') {
      EXPECT_LT(forward, -0.1);
    } else {
      EXPECT_GT(forward, 0.1);
    }
  }
}

// These gaits read no contacts, so their set-points and servo commands are integers computed from the scenario alone.
// Every machine, compiler and physics engine must give the same ones. A new hash here means that robots move
// differently from before, and that older recordings can no longer be verified.
TEST(Simulation, TheShippedScenariosGiveTheSameHashesOnEveryMachine) {
  struct Golden {
    const char* scenario;
    const char* setpoints;
    const char* servo_commands;
  };
  for (const Golden& golden : {Golden{"uniform", "22da369b07f47e76a020bc6f2026ceec6c40ae2bb89e34f2bcd1d28a560ff366",
                                      "075d8026f8e263d331d0a9f60d7da0e593b12f5bce9781792a5bffa973ff3aab"},
                               Golden{"tail_fixed", "1cbe8ff1ccf5365f71b743ad5ed55082eb0edd6fca1e1d70af4f24a016a04b2b",
                                      "0a66479902ba7b7970549ad9926ecf85e6f8e2b8d157ec029ab0767bbd1db0bc"},
                               Golden{"coupled", "a8c98c69b4366a733030f6a1f2d00a4e0a4cfb13f47df28da20e8d483f11857f",
                                      "42bfbbb21a4d1ca887515c3783a2cb88dfc28852c2e60afc0fabf1d4654198e3"}}) {
    const SimulationRun outcome = simulate(shipped(std::string("travelling_wave/") + golden.scenario), 30);
    EXPECT_EQ(outcome.setpoints, golden.setpoints) << golden.scenario;
    EXPECT_EQ(outcome.servo_commands, golden.servo_commands) << golden.scenario;
  }
}

TEST(Simulation, TailFixedKeepsTheTailJointStraight) {
  const Scenario scenario = shipped("travelling_wave/tail_fixed");
  Simulation simulation(scenario);
  ASSERT_EQ(scenario.robot.joints.back().name, "J1");
  for (int i = 0; i < 300; ++i) {
    simulation.advance();
    EXPECT_EQ(simulation.setpoints()[4], 0);
    EXPECT_LT(std::abs(simulation.plant().joint_angles()[4]), 0.03);
  }
  EXPECT_GT(std::abs(simulation.setpoints()[0]) + std::abs(simulation.setpoints()[1]), 0);
}

TEST(Simulation, RepeatsToTheLastBitOnEveryThread) {
  for (const char* name : {"uniform", "coupled"}) {
    const Scenario scenario = shipped(std::string("travelling_wave/") + name);
    const SimulationRun expected = simulate(scenario, 3);
    EXPECT_EQ(simulate(scenario, 3), expected) << name;
    std::array<SimulationRun, 4> outcomes;
    std::vector<std::thread> threads;
    for (SimulationRun& outcome : outcomes) {
      threads.emplace_back([&] { outcome = simulate(scenario, 3); });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
    for (const SimulationRun& outcome : outcomes) {
      EXPECT_EQ(outcome, expected) << name;
    }
  }
}

TEST(Simulation, ItsSetpointsAreThoseOfOneKernelOfAllJoints) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  Simulation simulation(scenario);
  KernelOf<5> whole;
  ASSERT_EQ(whole.configure(scenario.kernel, 0), Status::ok);
  for (unsigned joint = 0; joint < 5; ++joint) {
    ASSERT_EQ(whole.set_limits(joint, scenario.joint_limits[joint].lower, scenario.joint_limits[joint].upper),
              Status::ok);
  }
  for (const Setting& setting : scenario.settings) {
    ASSERT_EQ(whole.set_parameter(setting), Status::ok);
  }
  whole.reset();
  for (int tick = 0; tick < 1000; ++tick) {
    simulation.advance();
    whole.advance();
    for (unsigned joint = 0; joint < 5; ++joint) {
      ASSERT_EQ(simulation.setpoints()[joint], whole.setpoint(joint)) << "tick " << tick << " joint " << joint;
    }
  }
}

TEST(Simulation, AChangeTakesEffectAtItsTick) {
  Scenario scenario = shipped("travelling_wave/uniform");
  const Scenario unchanged = scenario;
  apply_setting(scenario, "amplitude=10@50");
  Simulation simulation(scenario);
  Simulation reference(unchanged);
  for (std::uint32_t tick = 0; tick < 60; ++tick) {
    const Change* change = simulation.advance();
    reference.advance();
    EXPECT_EQ(change != nullptr, tick == 50);
    for (unsigned joint = 0; joint < 5; ++joint) {
      const std::int64_t now = simulation.chain().kernel(joint).setpoint(joint);
      const std::int64_t before = reference.chain().kernel(joint).setpoint(joint);
      if (tick < 50) {
        EXPECT_EQ(now, before);
      } else {
        EXPECT_NEAR(static_cast<double>(now), static_cast<double>(before) / 4, 2.0) << "a quarter of the amplitude";
      }
    }
  }
}

TEST(Simulation, TheServoTakesThePulseOfTheMiddleOfItsInterval) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.robot.servo.period_us = 1000;
  Simulation simulation(scenario);
  for (int tick = 0; tick < 20; ++tick) {
    simulation.advance();
    for (unsigned joint = 0; joint < 5; ++joint) {
      const double from = simulation.chain().kernel(joint).previous_setpoint(joint);
      const double to = simulation.chain().kernel(joint).setpoint(joint);
      // The last of ten intervals begins at 9 ms; its middle is at 9.5 ms.
      const double counts = servo_center + (from + 0.95 * (to - from)) / (1 << 30) * servo_quarter_turn;
      EXPECT_NEAR(simulation.plant().servo_commands()[joint], counts, 0.51);
    }
  }
}

TEST(Simulation, ServoCommandsDependOnTheScheduleAndNotOnTheStepsOfThePhysics) {
  constexpr std::uint32_t ticks = 53;  // not a multiple of any period
  constexpr std::uint32_t duration_us = ticks * 10'000;
  for (const std::uint32_t period_us : {700U, 1'000U, 3'000U, 20'000U, 25'000U}) {
    std::string expected;
    for (const double step_s : {0.0005, 0.001, 0.002}) {
      Scenario scenario = shipped("travelling_wave/uniform");
      scenario.robot.servo.period_us = period_us;
      scenario.step_s = step_s;
      Simulation simulation(scenario);
      std::vector<ServoPulse> pulses;
      for (std::uint32_t tick = 0; tick < ticks; ++tick) {
        simulation.advance();
        pulses.insert(pulses.end(), simulation.servo_pulses().begin(), simulation.servo_pulses().end());
      }
      ASSERT_EQ(pulses.size(), 5 * ((duration_us + period_us - 1) / period_us));
      ValueHash hash;
      for (std::size_t i = 0; i < pulses.size(); ++i) {
        EXPECT_EQ(pulses[i].time_us, i / 5 * period_us);
        EXPECT_EQ(pulses[i].joint, i % 5);
        hash.append(pulses[i].command);
      }
      EXPECT_EQ(hash.hex(), simulation.servo_hash().hex());
      expected = expected.empty() ? hash.hex() : expected;
      EXPECT_EQ(hash.hex(), expected) << "period " << period_us << " us, step " << step_s << " s";
    }
  }
}

TEST(Simulation, AtTheEndOfATickTheServosHaveItsLastPulse) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.robot.servo.period_us = 700;  // shorter than a step: the last pulse of a tick may start after its last step
  Simulation simulation(scenario);
  for (int tick = 0; tick < 20; ++tick) {
    simulation.advance();
    const std::span<const ServoPulse> last = simulation.servo_pulses().last(5);
    for (unsigned joint = 0; joint < 5; ++joint) {
      EXPECT_EQ(simulation.plant().servo_commands()[joint], last[joint].command);
    }
  }
}

TEST(Simulation, ServosFollowTheirPulsesStepByStep) {
  // Without gravity and ground strong motors reach the speed that the servo asks of them, so that each joint is the
  // first-order lag d(angle)/dt = gain * (target - angle), with the pulse as the target that a step finds at its start.
  for (const std::uint32_t period_us : {500U, 1'000U, 3'000U, 20'000U}) {
    Scenario scenario = shipped("travelling_wave/uniform");
    scenario.environment.objects.clear();
    scenario.environment.gravity.setZero();
    for (Joint& joint : scenario.robot.joints) {
      joint.max_torque = 100.0;
    }
    scenario.robot.servo.period_us = period_us;
    Simulation simulation(scenario);
    std::array<double, 5> angles{};
    std::array<double, 5> targets{};
    for (std::uint64_t tick = 0; tick < 100; ++tick) {
      simulation.advance();
      for (std::uint64_t step = 0; step < 10; ++step) {
        for (unsigned joint = 0; joint < 5; ++joint) {
          for (const ServoPulse& pulse : simulation.servo_pulses()) {
            if (pulse.joint == joint && pulse.time_us <= 10'000 * tick + 1'000 * step) {
              targets[joint] = (pulse.command / 12.0 - 1'500.0) / 1'000.0 * std::numbers::pi / 2.0;
            }
          }
          const double speed = scenario.robot.servo.gain * (targets[joint] - angles[joint]);
          const double limit = scenario.robot.joints[joint].max_speed;
          angles[joint] += 0.001 * std::clamp(speed, -limit, limit);
        }
      }
      for (unsigned joint = 0; joint < 5; ++joint) {
        // A step of lag would be 0.004 at the highest speed.
        EXPECT_NEAR(simulation.plant().joint_angles()[joint], angles[joint], 2e-4)
            << "period " << period_us << " us, tick " << tick << ", joint " << joint;
      }
    }
  }
}

TEST(Simulation, AnAnalogueServoTakesAPulseEveryTwoTicks) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.robot.servo.period_us = 20'000;
  Simulation simulation(scenario);
  for (int tick = 0; tick < 10; ++tick) {
    const std::vector<std::int32_t> before(simulation.plant().servo_commands().begin(),
                                           simulation.plant().servo_commands().end());
    simulation.advance();
    const std::vector<std::int32_t> after(simulation.plant().servo_commands().begin(),
                                          simulation.plant().servo_commands().end());
    EXPECT_EQ(before == after, tick % 2 == 1) << "tick " << tick;
  }
}

TEST(Simulation, TheKernelsGetAContactAfterTwoEqualSamples) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  unsigned touched = 0;
  std::vector<std::uint8_t> accepted(6);
  std::vector<std::uint8_t> before(6);
  for (int tick = 0; tick < 200; ++tick) {
    const std::span<const std::uint8_t> sensors = simulation.plant().link_contacts();
    const std::vector<std::uint8_t> now(sensors.begin(), sensors.end());
    for (std::size_t link = 0; link < 6; ++link) {
      for (const unsigned bit : {1U, 2U}) {
        if ((now[link] & bit) == (before[link] & bit)) {
          accepted[link] = static_cast<std::uint8_t>((accepted[link] & ~bit) | (now[link] & bit));
        }
      }
    }
    before = now;
    simulation.advance();
    for (unsigned joint = 0; joint < 5; ++joint) {
      const std::uint8_t flags = simulation.chain().kernel(joint).frame(joint, 0).flags();
      EXPECT_EQ(simulation.latched_contacts()[joint + 1], accepted[joint + 1]);
      EXPECT_EQ(flags & 3U, accepted[joint + 1]) << "contacts latched at the SYNC, joint " << joint;
      touched |= (flags & 3U) != 0 ? 1U << joint : 0U;
    }
    EXPECT_EQ((simulation.chain().kernel(0).frame(0, 0).flags() >> 2U) & 3U, accepted[0]);
  }
  EXPECT_NE(touched, 0U);
  EXPECT_GT(simulation.plant().mean_contacts(), 1.0);
}

}  // namespace
}  // namespace proleg::sim
