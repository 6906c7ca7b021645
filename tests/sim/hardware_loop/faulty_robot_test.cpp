// A robot in which something fails: what each kind of fault does, and what MotionWatch sees of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "shipped.hpp"
#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"

namespace proleg::sim {
namespace {

constexpr double duration_s = 5.0;

struct Outcome {
  std::vector<ModuleEvent> events;
  std::vector<JointEnd> ends;
  std::vector<std::string> violations;
  std::optional<std::uint32_t> first_fault_tick;
  std::uint64_t differences = 0;
  std::string setpoints;
  double displacement = 0.0;
};

Outcome run(const std::string& faults, const Scenario& scenario) {
  HardwareOptions options;
  options.faults = parse_faults(faults, "faults", scenario.robot, static_cast<std::uint64_t>(duration_s * 1e6));
  HardwareLoop loop(scenario, std::move(options));
  while (loop.tick() < duration_s * 1e6 / scenario.kernel.tick_period_us) {
    loop.advance();
  }
  loop.finish_watch();
  const MotionWatch& watch = loop.motion_watch();
  return {watch.events(),
          watch.ends(),
          watch.violations(),
          loop.first_fault_tick(),
          loop.differences(),
          loop.setpoint_hash().hex(),
          loop.plant().displacement()};
}

Outcome run(const std::string& faults) { return run(faults, shipped("travelling_wave/uniform")); }

/// Time of the first event of a joint's module that has this text, -1 if there is none.
double time_of(const Outcome& outcome, unsigned joint, const std::string& text, double from_s = 0.0) {
  const auto event = std::ranges::find_if(outcome.events, [&](const ModuleEvent& one) {
    return one.joint == joint && one.time_s >= from_s && one.text.find(text) != std::string::npos;
  });
  return event == outcome.events.end() ? -1.0 : event->time_s;
}

using Ends = std::vector<JointEnd>;
const Ends all_in_operation(5, JointEnd::operation);
const Ends all_hold(5, JointEnd::hold);

/// J3 counts 2 from the head in this robot.
constexpr unsigned j3 = 2;

TEST(FaultyRobot, IsComparedWithTheGaitInMemoryUntilTheFirstFault) {
  const Outcome outcome = run("at 1.234s touch J3 pressed for 10ms");
  EXPECT_EQ(outcome.first_fault_tick, 123U);
  EXPECT_EQ(outcome.differences, 0U);
  EXPECT_EQ(outcome.ends, all_in_operation);
}

TEST(FaultyRobot, WithAFaultThatItDoesNotFeelMovesAsWithoutIt) {
  const Outcome touched = run("at 1s touch J3 pressed for 1s");
  const Outcome later = run("at 2s touch J1 open for 1s");
  EXPECT_EQ(touched.setpoints, later.setpoints) << "this gait reads no contacts";
  EXPECT_EQ(touched.displacement, later.displacement);
}

TEST(FaultyRobot, HoldsTheSafePoseWhenTheHostDies) {
  const Outcome outcome = run("at 1.5s host-dies");
  EXPECT_EQ(outcome.ends, all_hold);
  EXPECT_TRUE(outcome.violations.empty());
  for (unsigned joint = 0; joint < 5; ++joint) {
    const double lost = time_of(outcome, joint, "EMCY 0x8130");
    EXPECT_GT(lost, 1.5);
    EXPECT_LE(lost, 2.01);
    EXPECT_LE(time_of(outcome, joint, "holds the safe pose"), 3.0) << "within a second and a half of the fault";
  }
}

TEST(FaultyRobot, GoesOnWhenTheHostStallsForAMomentOnly) {
  EXPECT_EQ(run("at 1.5s host-stall for 300ms").ends, all_in_operation);
  EXPECT_EQ(run("at 1.5s host-stall for 900ms").ends, all_hold);
}

TEST(FaultyRobot, AnUnpluggedModuleHoldsAndTheOthersGoOn) {
  const Outcome outcome = run("at 1.5s unplug J3 for 1s");
  EXPECT_EQ(outcome.ends[j3], JointEnd::hold);
  EXPECT_EQ(std::ranges::count(outcome.ends, JointEnd::operation), 4);
  EXPECT_GT(time_of(outcome, j3, "quick stop"), 1.5);
  EXPECT_LE(time_of(outcome, j3, "quick stop"), 2.02);
}

TEST(FaultyRobot, AModuleThatMissesAFewSyncsCatchesUp) {
  EXPECT_EQ(run("at 1.502s unplug J3 for 60ms").ends, all_in_operation);
}

TEST(FaultyRobot, HoldsWhenTheProducerOfTheSyncIsUnplugged) {
  const Outcome outcome = run("at 1.5s unplug J5 for 2s");  // the head
  EXPECT_EQ(outcome.ends, all_hold);
  EXPECT_TRUE(outcome.violations.empty());
}

TEST(FaultyRobot, AModuleWithoutPowerIsLimpAndComesBack) {
  const Outcome outcome = run("at 1.5s supply J3 0V for 200ms");
  EXPECT_GE(time_of(outcome, j3, "limp"), 1.5);
  EXPECT_LE(time_of(outcome, j3, "limp"), 1.52);
  EXPECT_GT(time_of(outcome, j3, "starts", 1.7), 1.7);
  EXPECT_EQ(outcome.ends, all_in_operation);
}

TEST(FaultyRobot, AModuleWithTooLittleVoltageIsInFault) {
  const Outcome outcome = run("at 1.5s supply J3 2.7V for 200ms");
  EXPECT_GT(time_of(outcome, j3, "EMCY 0x3220"), 1.5);
  EXPECT_EQ(outcome.ends[j3], JointEnd::limp) << "its power is the host's decision";
}

TEST(FaultyRobot, AModuleWhoseProgramHasEndedForLackOfSupplyStartsAgainWithIt) {
  const Outcome outcome = run("at 1.5s supply J3 2.0V for 200ms");
  EXPECT_GT(time_of(outcome, j3, "limp"), 1.5);
  EXPECT_LE(time_of(outcome, j3, "limp"), 1.52);
  EXPECT_GT(time_of(outcome, j3, "starts", 1.7), 1.7);
  EXPECT_EQ(outcome.ends[j3], JointEnd::limp) << "it has sent EMCY 3220 before: its power is the host's decision";
}

TEST(FaultyRobot, AModuleThatRestartsJoinsAgain) {
  const Outcome outcome = run("at 1.5s reset J3");
  EXPECT_GT(time_of(outcome, j3, "EMCY 0xFF04"), 1.5);
  EXPECT_EQ(outcome.ends, all_in_operation);
}

TEST(FaultyRobot, AModuleWhoseConverterHangsIsInFault) {
  const Outcome outcome = run("at 1.5s adc J3 for 200ms");
  EXPECT_GT(time_of(outcome, j3, "EMCY 0x5210"), 1.5);
  EXPECT_LE(time_of(outcome, j3, "limp"), 1.6);
  EXPECT_EQ(outcome.ends[j3], JointEnd::limp);
}

TEST(FaultyRobot, AJammedServoIsLimpAfterHalfASecondOfTooMuchCurrent) {
  const Outcome outcome = run("at 1.5s jam J3 2.5A for 1s");
  EXPECT_GT(time_of(outcome, j3, "EMCY 0x2310"), 1.99);
  EXPECT_LE(time_of(outcome, j3, "EMCY 0x2310"), 2.05);
  EXPECT_EQ(outcome.ends[j3], JointEnd::limp);
  EXPECT_EQ(run("at 1.5s jam J3 1.5A for 1s").ends, all_in_operation) << "below the limit";
}

TEST(FaultyRobot, AJammedJointDoesNotTurn) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  HardwareOptions options;
  options.faults = parse_faults("at 1.5s jam J3 1A for 1s", "faults", scenario.robot, 5'000'000);
  HardwareLoop loop(scenario, std::move(options));
  double at_begin = 0.0;
  double moved = 0.0;
  double before = 0.0;
  while (loop.tick() < 240) {
    loop.advance();
    const double angle = loop.plant().joint_angles()[j3];
    if (loop.tick() == 152) {
      at_begin = angle;
    }
    moved = loop.tick() > 152 ? std::max(moved, std::abs(angle - at_begin)) : 0.0;
    before = loop.tick() <= 150 ? std::max(before, std::abs(angle)) : before;
  }
  EXPECT_GT(before, 0.3) << "rad: the joint turned";
  EXPECT_LT(moved, 0.01);
}

TEST(FaultyRobot, TouchSensorsFailAsTheScheduleSays) {
  const Scenario scenario = shipped("obstacle/reflex");
  const std::string undisturbed = run("at 4.99s touch J3 open for 1ms", scenario).setpoints;
  for (const char* fault : {"pressed", "open", "bouncing"}) {
    const Outcome outcome = run("at 0.5s touch J3 " + std::string(fault) + " for 3s", scenario);
    if (std::string(fault) != "open") {  // there is no contact there in this time
      EXPECT_NE(outcome.setpoints, undisturbed) << fault << ": the reflex reads contacts";
    }
    EXPECT_EQ(outcome.ends, all_in_operation) << fault;
  }
}

TEST(FaultyRobot, HoldsWhenANodeBabblesForLongerThanEightTicks) {
  const Outcome outcome = run("at 1.5s babble 001 for 600ms");
  EXPECT_EQ(std::ranges::count(outcome.ends, JointEnd::hold), 5);
  EXPECT_EQ(run("at 1.5s babble 001 for 20ms").ends, all_in_operation);
}

TEST(FaultyRobot, ADominantBusEndsInASafeState) {
  const Outcome outcome = run("at 1.5s dominant for 700ms");
  EXPECT_TRUE(outcome.violations.empty());
  EXPECT_EQ(std::ranges::count(outcome.ends, JointEnd::hold), 5);
}

TEST(FaultyRobot, FramesThatAreDestroyedAreSentAgain) {
  const Outcome outcome = run("at 1s corrupt 5% for 2s");
  EXPECT_EQ(outcome.ends, all_in_operation);
}

TEST(FaultyRobot, FramesThatAreLostForOneModuleDoNotStopTheOthers) {
  const Outcome outcome = run("at 1s lose J3 99% for 2s");
  EXPECT_NE(outcome.ends[j3], JointEnd::unsafe);
  EXPECT_EQ(outcome.ends[0], JointEnd::operation);
  EXPECT_GT(time_of(outcome, j3, "quick stop"), 1.0);
}

TEST(FaultyRobot, DelayedFramesLoseTheTickOfTheirModuleAtMost) {
  const Outcome outcome = run("at 1s delay J3 150ms for 1s");
  EXPECT_TRUE(outcome.violations.empty());
  EXPECT_NE(outcome.ends[j3], JointEnd::unsafe);
  EXPECT_EQ(std::ranges::count(outcome.ends, JointEnd::operation) + 1, 5);
}

TEST(FaultyRobot, AForeignNmtCommandStopsIt) {
  const Outcome outcome = run("at 1.5s send 000#0200");
  EXPECT_EQ(outcome.ends, Ends(5, JointEnd::limp));
  EXPECT_LE(time_of(outcome, j3, "limp"), 1.52);
}

TEST(FaultyRobot, ForeignSyncsDoNotDriveItFaster) {
  const Outcome outcome = run("at 1.5s send 080#05 every 3ms for 1s");
  EXPECT_TRUE(outcome.violations.empty());
  EXPECT_GT(time_of(outcome, j3, "EMCY 0x"), 1.5);
}

TEST(FaultyRobot, ASecondMasterDoesNotMakeItJump) {
  const Outcome outcome = run("at 1.5s master for 1s");
  EXPECT_TRUE(outcome.violations.empty());
  EXPECT_EQ(std::ranges::count(outcome.ends, JointEnd::unsafe), 0);
}

TEST(FaultyRobot, EndsTheSameTwice) {
  const std::string faults = "at 1s corrupt 60% for 1s\nat 1.2s unplug J2 for 700ms\nat 1.7s master for 1s\n";
  const Outcome first = run(faults);
  const Outcome second = run(faults);
  EXPECT_EQ(first.setpoints, second.setpoints);
  EXPECT_EQ(first.displacement, second.displacement);
  EXPECT_EQ(first.events.size(), second.events.size());
}

// ---------------------------------------------------------------------------------------------------------------------
// The watch itself, with pulses made by hand.

class Watch : public testing::Test {
 protected:
  Watch() { watch.start(1); }

  static constexpr BusTime ms = 1'000'000;
  /// As a native module says it; nothing: as measured at a chip.
  std::optional<bool> follows = true;
  void pulse(BusTime at, int width, canopen::PowerState power = canopen::PowerState::operation_enabled) {
    watch.note_pulse(0, {at, width, power, follows, true});
  }
  void host(BusTime at) {
    watch.note_frame(
        {at - 100'000, at, canopen::encode(canopen::Heartbeat{canopen::host_node, canopen::NmtState::operational}), 9});
  }
  void tick(BusTime at, bool has_computed = true) {
    watch.note_tick(0, at, {has_computed, true, canopen::PowerState::operation_enabled});
  }
  [[nodiscard]] std::string found() const { return watch.violations().empty() ? "" : watch.violations().front(); }

  const Scenario scenario = [] {
    Scenario given = shipped("travelling_wave/uniform");
    given.robot.servo.period_us = 20'000;
    given.robot.servo.command_speed = 720;
    given.joint_limits[0] = {-quarter_turn / 2, quarter_turn / 2};
    return given;
  }();
  MotionWatch watch{scenario};
};

constexpr int center = 18'000;
constexpr int step = 1'920;  ///< 14.4 degrees: 720 degrees a second in 20 ms

TEST_F(Watch, FindsAPulseBeyondTheLimits) {
  pulse(20 * ms, center + 6'000);
  EXPECT_EQ(found(), "");
  pulse(40 * ms, center + 6'020);
  EXPECT_NE(found().find("0.15 degrees beyond its limits"), std::string::npos) << found();
}

TEST_F(Watch, FindsAJump) {
  pulse(20 * ms, center);
  pulse(40 * ms, center + step);
  EXPECT_EQ(found(), "");
  pulse(60 * ms, center - 20);
  EXPECT_NE(found().find("a jump of"), std::string::npos) << found();
}

TEST_F(Watch, FindsPulsesThatAddUpToAHigherSpeed) {
  for (int i = 0; i < 6; ++i) {
    pulse((20 + 5 * static_cast<BusTime>(i)) * ms, center - 5'500 + i * step);
  }
  EXPECT_NE(found().find("above the greatest speed"), std::string::npos) << found();
}

TEST_F(Watch, FindsAPulseWithoutAnEnabledDrive) {
  pulse(20 * ms, center, canopen::PowerState::switched_on);
  EXPECT_NE(found().find("neither enabled nor in a quick stop"), std::string::npos) << found();
}

TEST_F(Watch, FindsMotionWithoutTicks) {
  pulse(20 * ms, center);
  tick(21 * ms);
  host(1'500 * ms);
  pulse(1'530 * ms, center + 100);
  tick(1'540 * ms, false);
  EXPECT_NE(found().find("s after the last tick"), std::string::npos) << found();
}

TEST_F(Watch, FindsMotionWithoutTheHost) {
  host(10 * ms);
  pulse(1'520 * ms, center);
  pulse(1'540 * ms, center + 100);
  tick(1'550 * ms);
  EXPECT_NE(found().find("after the last heartbeat of the host"), std::string::npos) << found();
}

TEST_F(Watch, FindsAServoThatIsEnabledWithoutTicksAtTheEnd) {
  pulse(20 * ms, center);
  tick(21 * ms);
  tick(600 * ms, false);
  watch.finish(600 * ms);
  EXPECT_EQ(watch.ends()[0], JointEnd::unsafe);
  EXPECT_NE(found().find("without a tick"), std::string::npos) << found();
}

TEST_F(Watch, AllowsAHiddenRequestBetweenTwoMeasuredPulses) {
  follows.reset();
  pulse(20 * ms, center - step);
  pulse(40 * ms, center + step);
  EXPECT_EQ(found(), "");
  pulse(60 * ms, center - step - 20);
  EXPECT_NE(found().find("a jump of"), std::string::npos) << found();
}

TEST_F(Watch, LetsTheFirstPulseBeAnywhereWithinTheLimits) {
  follows.reset();
  pulse(20 * ms, center - 6'000);
  pulse(500 * ms, center + 6'000);
  EXPECT_EQ(found(), "") << "the servo had no pulses for many periods";
}

}  // namespace
}  // namespace proleg::sim
