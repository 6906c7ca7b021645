// The state of a servo that ends while the robot moves: torque, modes, supply, movement.

#include <gtest/gtest.h>

#include <functional>

#include "chain_rig.hpp"

namespace proleg::host {
namespace {

using test::ChainRig;
using test::EmulatedServo;

/// Drives five servos; after 20 ticks something happens to servo 3. Returns the error that ends the run.
struct EventRun {
  explicit EventRun(const std::function<void(EmulatedServo&)>& event,
                    const ChainSettings& settings = test::chain_settings(5))
      : rig(settings) {
    rig.connect();
    rig.switch_on();
    for (int i = 0; i < 20; ++i) {
      rig.tick(i);
    }
    event(rig.servos.servo(3));
    for (; error.empty() && ticks < 400; ++ticks) {
      error = ChainRig::error_of([&] { rig.tick(ticks / 2 % 2 == 0 ? 19.0 : 18.0); });
      EXPECT_EQ(rig.overrun_us, 0U) << ticks;
    }
  }

  ChainRig rig;
  std::string error;
  int ticks = 0;
};

TEST(ServoState, AServoThatRestartsEndsTheRun) {
  EventRun run([](EmulatedServo& servo) { servo.restart(); });
  EXPECT_EQ(run.error,
            "servo 3 (joint J3) has lost its torque: it has restarted, its Bus Watchdog(98) is 0; check its supply and "
            "its cable");
  EXPECT_LE(run.ticks, 8);
  EXPECT_FALSE(ChainRig::error_of([&] {
                 for (int i = 0; i < 8; ++i) {
                   run.rig.tick(10.0);
                 }
               }).empty());
  EXPECT_EQ(run.rig.servos.servo(5).position(), 2048 + 114);  // the others still get goals: they can ramp down
}

TEST(ServoState, TorqueThatAnotherProgramTakesEndsTheRun) {
  EventRun run([](EmulatedServo& servo) { servo.table[64] = 0; });
  EXPECT_EQ(run.error,
            "servo 3 (joint J3) has lost its torque: another program has set Torque Enable(64) to 0; end that program");
  EXPECT_LE(run.ticks, 8);
}

TEST(ServoState, ARestartIsNoticedAlsoIfTheServoHasTorqueAgain) {
  EventRun run([](EmulatedServo& servo) {
    servo.restart();
    servo.table[64] = 1;
  });
  EXPECT_EQ(run.error,
            "servo 3 (joint J3) has the Bus Watchdog(98) 0, expected 10: it has restarted, or another program has "
            "changed it; check its supply, end that program");
}

TEST(ServoState, AModeThatAnotherProgramChangesEndsTheRun) {
  EXPECT_EQ(EventRun([](EmulatedServo& servo) { servo.table[11] = 1; }).error,
            "servo 3 (joint J3) has the Operating Mode(11) 1, expected 3: another program has changed it; end that "
            "program");
  EXPECT_EQ(
      EventRun([](EmulatedServo& servo) { servo.table[10] = 1; }).error,
      "servo 3 (joint J3) has the Drive Mode(10) 1, expected 0: another program has changed it; end that program");
}

TEST(ServoState, AWatchdogThatHasStoppedTheServoEndsTheRun) {
  EXPECT_EQ(
      EventRun([](EmulatedServo& servo) { servo.table[98] = 255; }).error,
      "servo 3 (joint J3) was stopped by its bus watchdog: it received nothing for 200 ms; reduce the load of the "
      "computer, or set a longer 'watchdog'");
}

TEST(ServoState, AServoWhoseIdIsChangedEndsTheRun) {
  EXPECT_EQ(EventRun([](EmulatedServo& servo) { servo.id = 9; }).error,
            "servo 3 (joint J3) has not answered 3 times in a row; check its cable and its power");
}

TEST(ServoState, IsLookedAtAlsoOnALineThatReadsOneServoInATick) {
  ChainSettings settings = test::chain_settings(6);
  settings.rate = 115'200;
  EventRun run([](EmulatedServo& servo) { servo.restart(); }, settings);
  EXPECT_EQ(run.error.substr(0, 58), "servo 3 (joint J3) has lost its torque: it has restarted, ");
  EXPECT_LE(run.ticks, 6 * 8);
}

TEST(ServoState, IsNotLookedAtBeforeTheServosHavePowerAndAfterIt) {
  ChainRig rig(3);
  rig.connect();
  for (int i = 0; i < 40; ++i) {
    rig.tick(0.0);
  }
  rig.switch_on();
  rig.tick(0.0);
  rig.chain.switch_off(rig.now_us + 1'000'000);
  for (int i = 0; i < 40; ++i) {
    rig.tick(0.0);
  }
  EXPECT_TRUE(rig.shown.empty());
}

TEST(ServoState, AServoThatStandsStillIsShown) {
  EventRun run([](EmulatedServo& servo) { servo.is_blocked = true; });
  EXPECT_EQ(run.error, "");
  EXPECT_TRUE(run.rig.shown.empty());  // one degree from its goal
  for (int i = 0; i < 150; ++i) {
    run.rig.tick(i % 50 - 25.0);
  }
  ASSERT_EQ(run.rig.shown.size(), 1U);
  EXPECT_EQ(run.rig.shown[0].substr(0, 80),  // 500 steps
            "servo 3 (joint J3) has power, but has stood still for 1.0 s, up to 43.9 degrees ");
}

TEST(ServoState, AServoThatIsSlowIsNotShown) {
  EventRun run([](EmulatedServo& servo) { servo.steps_per_goal = 1; });  // 9 degrees a second
  for (int i = 0; i < 300; ++i) {
    run.rig.tick(60.0);
  }
  EXPECT_TRUE(run.rig.shown.empty());
}

TEST(ServoState, AVoltageBelowTheLimitOfTheServoIsShownOnce) {
  ChainRig rig(2);
  rig.servos.servo(2).set_number(34, 2, 95);
  rig.servos.servo(2).set_number(144, 2, 95);
  rig.connect();
  rig.switch_on();
  EXPECT_TRUE(rig.shown.empty());
  rig.servos.servo(2).set_number(144, 2, 94);
  for (int i = 0; i < 200; ++i) {
    rig.tick(0.0);
  }
  EXPECT_EQ(rig.shown,
            (std::vector<std::string>{"servo 2 (joint J2) has 9.4 V, expected at least the 9.5 V of its Min Voltage "
                                      "Limit(34); charge the battery, or use a stronger supply"}));
}

}  // namespace
}  // namespace proleg::host
