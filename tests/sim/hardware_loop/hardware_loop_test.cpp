// Modules that have only their own joint, their sensors, the frames they receive and their own crystal: their
// set-points and pulses must not differ from the gait in memory in a single bit.

#include "sim/hardware_loop/hardware_loop.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "shared/canopen/messages.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

struct LoopRun {
  std::uint64_t differences = 0;
  std::string setpoints;
  std::string servo_commands;
  double displacement = 0;
  std::uint64_t lost_frames = 0;
  std::vector<std::string> notices;
  std::map<std::uint32_t, std::uint32_t> joined;  ///< tick by joint
  BusStatistics bus;
};

LoopRun run_loop(const Scenario& scenario, std::uint32_t ticks, HardwareOptions options = {}) {
  LoopRun result;
  options.notice = [&result](const std::string& notice) { result.notices.push_back(notice); };
  HardwareLoop loop(scenario, std::move(options));
  while (loop.tick() < ticks) {
    loop.advance();
    for (const auto& event : loop.restart_events()) {
      if (event.joined) {
        result.joined[event.joint] = loop.tick() - 1;
      }
    }
  }
  result.differences = loop.differences();
  result.setpoints = loop.setpoint_hash().hex();
  result.servo_commands = loop.servo_hash().hex();
  result.displacement = loop.plant().displacement();
  result.lost_frames = loop.lost_frames();
  result.bus = loop.bus_statistics();
  return result;
}

LoopRun simulated(const Scenario& scenario, std::uint32_t ticks, const Losses* losses = nullptr) {
  Simulation simulation(scenario, losses);
  LoopRun result;
  while (simulation.tick() < ticks) {
    simulation.advance();
    result.lost_frames += simulation.chain().lost().size();
  }
  result.setpoints = simulation.setpoint_hash().hex();
  result.servo_commands = simulation.servo_hash().hex();
  result.displacement = simulation.plant().displacement();
  return result;
}

void expect_identical(const LoopRun& modules, const LoopRun& simulation) {
  EXPECT_EQ(modules.differences, 0U);
  EXPECT_EQ(modules.setpoints, simulation.setpoints);
  EXPECT_EQ(modules.servo_commands, simulation.servo_commands);
  EXPECT_EQ(modules.displacement, simulation.displacement) << "the worlds are the same to the last bit, too";
  EXPECT_EQ(modules.lost_frames, simulation.lost_frames);
}

class EveryScenario : public testing::TestWithParam<const char*> {};

TEST_P(EveryScenario, CrawlsBitForBitLikeTheSimulation) {
  const Scenario scenario = shipped(GetParam());
  expect_identical(run_loop(scenario, 1500), simulated(scenario, 1500));
}

TEST_P(EveryScenario, DoesSoWhenFivePercentOfTheStateFramesAreLost) {
  const Scenario scenario = shipped(GetParam());
  const Losses losses(RandomLosses{7, 214748365, 0, 900});
  HardwareOptions options;
  options.losses = &losses;
  const LoopRun modules = run_loop(scenario, 1200, options);
  expect_identical(modules, simulated(scenario, 1200, &losses));
  EXPECT_GT(modules.lost_frames, 700U);
}

INSTANTIATE_TEST_SUITE_P(Shipped, EveryScenario,
                         testing::Values("travelling_wave/uniform", "travelling_wave/tail_fixed",
                                         "travelling_wave/coupled", "obstacle/reflex", "obstacle/plain",
                                         "retreat/wall"));

TEST(HardwareLoop, ChangesInFlightTakeEffectAtTheirTicksInEveryModule) {
  Scenario scenario = shipped("travelling_wave/coupled");
  for (const char* setting : {"amplitude=20@0", "frequency=0.8@1", "amplitude:J2=30@60", "current_phase:J3=170@61",
                              "phase_difference=70@150", "offset:J5=5@300"}) {
    apply_setting(scenario, setting);
  }
  const LoopRun modules = run_loop(scenario, 400);
  expect_identical(modules, simulated(scenario, 400));
  EXPECT_TRUE(modules.notices.empty()) << modules.notices.front();
}

TEST(HardwareLoop, TwoRunsAreTheSame) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  const LoopRun first = run_loop(scenario, 200);
  const LoopRun second = run_loop(scenario, 200);
  EXPECT_EQ(first.setpoints, second.setpoints);
  EXPECT_EQ(first.displacement, second.displacement);
  EXPECT_EQ(first.bus.frames, second.bus.frames);
  EXPECT_EQ(first.bus.busy, second.bus.busy);
}

TEST(HardwareLoop, CrystalsMayBeOffByMoreThanRealOnes) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  for (const std::uint32_t error_ppm : {0U, 100U, 500U}) {
    HardwareOptions options;
    options.crystal_error_ppm = error_ppm;
    expect_identical(run_loop(scenario, 500, options), simulated(scenario, 500));
  }
}

// Servo periods that do not fit the tick or the step of the physics.
TEST(HardwareLoop, WorksWithEveryServoPeriod) {
  for (const std::uint32_t period_us : {700U, 981U, 1'000U, 1'999U, 3'000U, 3'333U, 9'999U, 20'000U, 33'333U}) {
    Scenario scenario = shipped("travelling_wave/coupled");
    scenario.robot.servo.period_us = period_us;
    expect_identical(run_loop(scenario, 300), simulated(scenario, 300));
  }
}

TEST(HardwareLoop, WorksWithOtherTickPeriods) {
  for (const std::uint32_t tick_us : {5'000U, 20'000U}) {
    Scenario scenario = shipped("travelling_wave/coupled");
    scenario.kernel.tick_period_us = tick_us;
    expect_identical(run_loop(scenario, 300), simulated(scenario, 300));
  }
}

TEST(HardwareLoop, ANodeIdImpliesNoJoint) {
  Scenario scenario = shipped("travelling_wave/coupled");
  const LoopRun expected = simulated(scenario, 300);
  const std::uint8_t nodes[] = {126, 3, 77, 1, 42};
  for (std::size_t joint = 0; joint < 5; ++joint) {
    scenario.modules[joint].node = nodes[joint];
  }
  expect_identical(run_loop(scenario, 300), expected);
}

// Load of one state frame a module and SYNC at 10 ms from the least to the most stuffing (docs/protocol.md), and TICK.
TEST(HardwareLoop, FiveModulesTakeSevenPercentOfTheBus) {
  const LoopRun modules = run_loop(shipped("travelling_wave/coupled"), 1000);
  EXPECT_GT(modules.bus.load(), 0.061);
  EXPECT_LT(modules.bus.load(), 0.076);
}

TEST(HardwareLoop, TwentyModulesTakeLessThanThirtyPercentOfTheBus) {
  const Scenario scenario = shipped("long_chain/twenty");
  const LoopRun modules = run_loop(scenario, 100);
  EXPECT_EQ(modules.differences, 0U);
  EXPECT_LT(modules.bus.load(), 0.30);
}

TEST(HardwareLoop, SixtyModulesRun) {
  const LoopRun modules = run_loop(shipped("long_chain/sixty"), 20);
  EXPECT_EQ(modules.differences, 0U);
  EXPECT_LT(modules.bus.load(), 0.85);
}

// ---------------------------------------------------------------------------------------------------------------------
// Restarts.

class RestartedModule : public testing::TestWithParam<const char*> {};

TEST_P(RestartedModule, RejoinsAndNothingDiffersFromTheGaitInMemoryWithTheSameGap) {
  Scenario scenario = shipped(GetParam());
  if (scenario.kernel.slots[0].algorithm->declaration().name == "PatternGenerator_coupled_oscillator") {
    apply_setting(scenario, "amplitude=25@205");  // committed while the module is away
  }
  for (const unsigned joint : {1U, 4U}) {
    HardwareOptions options;
    options.restarts = {{200, joint}, {500, joint}};
    const LoopRun modules = run_loop(scenario, 800, options);
    EXPECT_EQ(modules.differences, 0U) << "joint " << joint;
    ASSERT_TRUE(modules.joined.contains(joint));
    EXPECT_LT(modules.joined.at(joint), 540U) << "back within 0.4 s";
  }
}

INSTANTIATE_TEST_SUITE_P(Scenarios, RestartedModule,
                         testing::Values("travelling_wave/uniform", "travelling_wave/coupled", "obstacle/reflex"));

TEST(HardwareLoop, APlainSineIsExactAgainAfterARestart) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  Simulation simulation(scenario);
  HardwareOptions options;
  options.restarts = {{100, 2}};
  HardwareLoop loop(scenario, options);
  for (std::uint32_t tick = 0; tick < 200; ++tick) {
    loop.advance();
    simulation.advance();
    if (tick < 100 || tick > 140) {
      ASSERT_TRUE(std::ranges::equal(loop.sample().setpoints, simulation.setpoints())) << "tick " << tick;
    }
  }
}

TEST(HardwareLoop, TheServoOfARestartedModuleIsLimpUntilItIsBack) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  HardwareOptions options;
  options.restarts = {{100, 2}};
  HardwareLoop loop(scenario, options);
  std::uint32_t without_pulses = 0;
  for (std::uint32_t tick = 0; tick < 200; ++tick) {
    loop.advance();
    const TickSample sample = loop.sample();
    const auto pulses = std::ranges::count(sample.servo_pulses, 2U, &ServoPulse::joint);
    EXPECT_TRUE(pulses == 10 || pulses == 0) << "tick " << tick;
    without_pulses += pulses == 0 ? 1U : 0U;
    if (tick < 100 || tick > 140) {
      EXPECT_EQ(pulses, 10) << "tick " << tick;
    }
  }
  EXPECT_GT(without_pulses, 0U);
}

// TICK has a higher identifier than the SDOs of a set-up, which must leave it room; also with short and long ticks, and
// when the frame of the restarted module would carry the label 0.
TEST(HardwareLoop, RestartsAtAwkwardTicksDoNotDisturbOtherModules) {
  struct Case {
    const char* scenario;
    std::uint32_t tick_us;
    std::vector<Restart> restarts;
  };
  for (const auto& [name, tick_us, restarts] :
       {Case{"long_chain/twenty", 10'000, {{109, 13}}}, Case{"long_chain/sixty", 10'000, {{6, 30}}},
        Case{"travelling_wave/coupled", 2'000, {{109, 2}}},
        Case{"travelling_wave/coupled", 10'000, {{98, 1}, {98, 2}, {98, 3}, {98, 4}}},
        Case{"travelling_wave/coupled", 10'000, {{100, 2}, {101, 2}, {113, 2}}},
        Case{"travelling_wave/coupled", 20'000, {{255, 2}}}, Case{"travelling_wave/uniform", 50'000, {{100, 4}}}}) {
    Scenario scenario = shipped(name);
    scenario.kernel.tick_period_us = tick_us;
    HardwareOptions options;
    options.restarts = restarts;
    const LoopRun modules = run_loop(scenario, restarts.back().tick + 100, options);
    EXPECT_EQ(modules.differences, 0U) << name << " " << tick_us << " us";
    for (const Restart& restart : restarts) {
      EXPECT_TRUE(modules.joined.contains(restart.joint)) << name;
    }
    for (const std::string& notice : modules.notices) {
      EXPECT_TRUE(notice.find("0x8700") == std::string::npos && notice.find("0xFF05") == std::string::npos) << notice;
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// A check of identity must be able to fail.

class HiddenFault : public testing::TestWithParam<const char*> {
 protected:
  static bool is_state_frame(const CanFrame& frame, std::uint8_t node, std::uint8_t label) {
    return frame.identifier == canopen::identifier::state_frame + node && frame.data[7] == label;
  }

  void expect_other_hash(const LoopRun& faulty) const {
    EXPECT_GT(faulty.differences, 0U);
    EXPECT_NE(faulty.setpoints, run_loop(scenario, ticks).setpoints);
  }

  static constexpr std::uint32_t ticks = 300;
  Scenario scenario = shipped(GetParam());
};

// While the phases of the oscillators still converge. (In a settled gait a receiver predicts a lost frame so well that
// nothing changes.)
TEST_P(HiddenFault, AStateFrameDroppedOnItsWayToOneJointShows) {
  HardwareOptions options;
  options.tamper = [](unsigned joint, const CanFrame& frame, const auto& deliver) {
    if (!(joint == 1 && is_state_frame(frame, 1, 20))) {
      deliver(frame);
    }
  };
  expect_other_hash(run_loop(scenario, ticks, options));
}

TEST_P(HiddenFault, AStateFrameThatComesATickLateShows) {
  HardwareOptions options;
  std::optional<CanFrame> late;
  options.tamper = [&late](unsigned joint, const CanFrame& frame, const auto& deliver) {
    if (joint == 1 && is_state_frame(frame, 1, 20)) {
      late = frame;
      return;
    }
    deliver(frame);
    if (joint == 1 && late && is_state_frame(frame, 1, 21)) {
      deliver(*late);
      late.reset();
    }
  };
  expect_other_hash(run_loop(scenario, ticks, options));
}

INSTANTIATE_TEST_SUITE_P(Scenarios, HiddenFault, testing::Values("travelling_wave/coupled"));

// One module's contacts are a tick younger than those of its neighbours. If the contacts of all modules are a tick
// older, the gait differs as well, but in another way.
TEST(HardwareLoop, ContactsOfMixedAgesShow) {
  const Scenario scenario = shipped("obstacle/reflex");
  const auto with_older_contacts = [&](unsigned young_joint) {
    HardwareOptions options;
    std::map<unsigned, std::uint8_t> before;
    options.change_sensors = [&before, young_joint](unsigned joint, std::uint8_t sensors) {
      const std::uint8_t older = before[joint];
      before[joint] = sensors;
      return joint == young_joint ? sensors : older;
    };
    return run_loop(scenario, 1500, options);
  };
  const LoopRun undisturbed = run_loop(scenario, 1500);
  const LoopRun all_older = with_older_contacts(max_joints);
  const LoopRun mixed = with_older_contacts(0);
  EXPECT_GT(mixed.differences, 0U);
  EXPECT_NE(mixed.setpoints, undisturbed.setpoints);
  EXPECT_NE(mixed.setpoints, all_older.setpoints);
}

// ---------------------------------------------------------------------------------------------------------------------
// Frames that another node sends on the bus while the robot moves. Modules reject what does not fit, with a reason
// where the protocol has an answer, and the motion does not change.

class Intruder : public testing::Test {
 protected:
  /// Sends the frames after SYNC 100; returns those on the bus afterwards whose identifier is in the answers.
  std::vector<CanFrame> answers_to(const std::vector<CanFrame>& frames, std::uint16_t first, std::uint16_t last) {
    HardwareOptions options;
    for (const CanFrame& frame : frames) {
      options.injected.push_back({100, frame});
    }
    std::vector<CanFrame> answers;
    bool sent = false;
    options.on_frame = [&](const Transmission& transmission) {
      sent = sent || transmission.frame == frames.front();
      if (sent && transmission.frame.identifier >= first && transmission.frame.identifier <= last) {
        answers.push_back(transmission.frame);
      }
    };
    expect_identical(run_loop(scenario, 200, options), simulated(scenario, 200));
    return answers;
  }

  static CanFrame frame(std::uint16_t identifier, std::initializer_list<std::uint8_t> data) {
    CanFrame result{identifier, static_cast<std::uint8_t>(data.size()), {}};
    std::copy(data.begin(), data.end(), result.data.begin());
    return result;
  }

  Scenario scenario = shipped("travelling_wave/coupled");
};

TEST_F(Intruder, AnObjectThatDoesNotExistIsRejectedWithTheAbortCodeOfTheStandard) {
  const auto answers = answers_to({frame(0x603, {0x40, 0x34, 0x12, 0x00, 0, 0, 0, 0})}, 0x583, 0x583);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0], frame(0x583, {0x80, 0x34, 0x12, 0x00, 0x00, 0x00, 0x02, 0x06}));
}

TEST_F(Intruder, AValueOutOfRangeIsRejectedWithTheAbortCodeOfTheStandard) {
  // Amplitude, staged in slot 1 as -1.
  const auto answers = answers_to({frame(0x603, {0x23, 0x80, 0x40, 0x01, 0xFF, 0xFF, 0xFF, 0xFF})}, 0x583, 0x583);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0], frame(0x583, {0x80, 0x80, 0x40, 0x01, 0x32, 0x00, 0x09, 0x06}));
}

TEST_F(Intruder, AParameterInForceCannotBeWrittenInMidGait) {
  const auto answers = answers_to({frame(0x603, {0x23, 0x80, 0x30, 0x01, 0, 0, 0, 0})}, 0x583, 0x583);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0], frame(0x583, {0x80, 0x80, 0x30, 0x01, 0x22, 0x00, 0x00, 0x08}));
}

TEST_F(Intruder, ACommitOfNothingIsAnsweredByEveryModule) {
  const auto answers = answers_to({frame(0x680, {0x63, 0x00, 0xC8, 0, 0, 0, 0x01, 0x00})}, 0x081, 0x0FF);
  ASSERT_EQ(answers.size(), 5U);
  for (const CanFrame& answer : answers) {
    EXPECT_EQ(answer.data[0] | answer.data[1] << 8, 0xFF02) << "commit not staged";
    EXPECT_EQ(answer.data[3], 0x63);
  }
}

TEST_F(Intruder, ACommitInThePastIsAnsweredByEveryModule) {
  std::vector<CanFrame> frames;
  for (std::uint16_t node = 1; node <= 5; ++node) {
    frames.push_back(frame(static_cast<std::uint16_t>(0x600 + node), {0x2B, 0x04, 0x20, 0x01, 0x63, 0, 0, 0}));
  }
  frames.push_back(frame(0x680, {0x63, 0x00, 0x05, 0, 0, 0, 0x01, 0x00}));
  const auto answers = answers_to(frames, 0x081, 0x0FF);
  ASSERT_EQ(answers.size(), 5U);
  for (const CanFrame& answer : answers) {
    EXPECT_EQ(answer.data[0] | answer.data[1] << 8, 0xFF01) << "commit too late";
  }
}

TEST_F(Intruder, FramesOfWrongLengthChangeNothing) {
  answers_to({frame(0x080, {}), frame(0x080, {1, 2}), frame(0x680, {1}), frame(0x681, {1, 2, 3}), frame(0x603, {0x40}),
              frame(0x000, {1}), frame(0x203, {1, 2, 3})},
             0, 0);
}

// The module cannot distinguish a forged frame from a true one, but the true one follows each and replaces it.
TEST_F(Intruder, AnUnknownLabelChangesNothing) {
  HardwareOptions options;
  options.tamper = [](unsigned joint, const CanFrame& received, const auto& deliver) {
    if (joint == 1 && received.identifier == 0x181 && received.data[7] == 50) {
      CanFrame forged = received;
      forged.data[7] = 200;
      deliver(forged);
    }
    deliver(received);
  };
  const LoopRun modules = run_loop(scenario, 200, options);
  EXPECT_EQ(modules.differences, 0U);
  ASSERT_EQ(modules.notices.size(), 1U);
  EXPECT_NE(modules.notices[0].find("0xFF05"), std::string::npos) << modules.notices[0];
}

std::ptrdiff_t reports(const LoopRun& outcome, const char* text) {
  return std::ranges::count_if(outcome.notices,
                               [&](const std::string& notice) { return notice.find(text) != std::string::npos; });
}

TEST_F(Intruder, ASyncSoonerThanHalfAPeriodIsReportedAndChangesNothing) {
  HardwareOptions options;
  options.injected = {{100, frame(0x080, {0x50})}, {120, frame(0x080, {0x51})}, {121, frame(0x080, {123})}};
  const LoopRun modules = run_loop(scenario, 200, options);
  EXPECT_EQ(modules.differences, 0U);
  EXPECT_EQ(reports(modules, "0xFF06"), 5) << "once from each module";
  EXPECT_EQ(modules.notices.size(), 5U);
}

// The module cannot decide which clock is right. It computes again from the next TICK on; its servo goes to the safe
// pose and waits for the host's decision.
TEST_F(Intruder, AModuleThatReceivesASyncOfNoTickStopsItsServoAndComputesAgain) {
  HardwareOptions options;
  options.tamper = [](unsigned joint, const CanFrame& received, const auto& deliver) {
    const bool is_forged = joint == 1 && received.identifier == 0x080 && received.data[0] == 101;
    deliver(is_forged ? frame(0x080, {0x50}) : received);
  };
  const LoopRun modules = run_loop(scenario, 200, options);
  EXPECT_GT(modules.differences, 0U);
  EXPECT_EQ(reports(modules, "0x8700"), 1) << "SYNC lost";
  EXPECT_EQ(reports(modules, "0xFF04"), 1) << "joined again";
}

// ---------------------------------------------------------------------------------------------------------------------
// Robots that must not start.

void expect_refusal(const Scenario& scenario, const HardwareOptions& options, const std::string& message) {
  try {
    const HardwareLoop loop(scenario, options);
    ADD_FAILURE() << "the robot started";
  } catch (const HardwareError& error) {
    EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
  }
}

TEST(RefusedRobot, AModuleWithAWrongCoreIsNamed) {
  HardwareOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    if (joint == 3) {
      identity.core_fingerprint ^= 1U;
    }
  };
  expect_refusal(shipped("travelling_wave/uniform"), options, "node 4 (J2)");
}

TEST(RefusedRobot, AModuleWithAWrongSerialNumberIsNamed) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.modules[2].serial = 0x1234ABCD;
  EXPECT_EQ(run_loop(scenario, 10).differences, 0U) << "the simulated module has the serial number of the file";
  HardwareOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    identity.unique_id[0] ^= joint == 2 ? 1U : 0U;
  };
  expect_refusal(scenario, options, "node 3 (J3)");
}

TEST(RefusedRobot, TwoModulesWithOneNodeIdAreNamed) {
  HardwareOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    if (joint == 3) {
      identity.node = 2;
    }
  };
  expect_refusal(shipped("travelling_wave/uniform"), options, "node 2 (J4)");
}

TEST(RefusedRobot, AModuleThatIsNotInTheMapIsNamed) {
  HardwareOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    if (joint == 3) {
      identity.node = 99;
    }
  };
  expect_refusal(shipped("travelling_wave/uniform"), options, "node 99");
}

TEST(RefusedRobot, ABusThatCannotCarryItsFramesIsRefusedBeforeItStarts) {
  Scenario scenario = shipped("long_chain/sixty");
  scenario.kernel.tick_period_us = 5'000;
  EXPECT_THROW(HardwareLoop(scenario, {}), InputError);
}

TEST(HardwareLoop, AppliesARampWithAChangeInEveryTick) {
  Scenario scenario = shipped("travelling_wave/coupled");
  scenario.kernel.tick_period_us = 5'000;
  for (int i = 0; i < 60; ++i) {  // a ramp of a step in every tick
    apply_setting(scenario, "amplitude=" + std::to_string(20 + i * 0.25) + "@" + std::to_string(100 + i));
  }
  expect_identical(run_loop(scenario, 200), simulated(scenario, 200));
}

}  // namespace
}  // namespace proleg::sim
