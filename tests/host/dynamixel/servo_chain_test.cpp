#include "host/dynamixel/servo_chain.hpp"

#include <gtest/gtest.h>

#include "chain_rig.hpp"

namespace proleg::host {
namespace {

using test::ChainRig;
using test::EmulatedServo;

bool any_has_power(const ChainRig& rig) {
  return std::ranges::any_of(rig.servos.servos, [](const EmulatedServo& servo) { return servo.has_power(); });
}

TEST(ServoChain, ReadsAllAnglesAndGivesNoPowerWhenItConnects) {
  ChainRig rig(3);
  rig.servos.servo(2).set_number(132, 4, 3072);
  rig.servos.servo(3).set_number(132, 4, 1024);
  rig.connect();
  EXPECT_EQ(rig.chain.readings()[0].angle_deg, 0.0);
  EXPECT_EQ(rig.chain.readings()[1].angle_deg, 90.0);
  EXPECT_EQ(rig.chain.readings()[2].angle_deg, -90.0);
  EXPECT_EQ(rig.chain.readings()[0].temperature_c, 31.0);
  EXPECT_FALSE(any_has_power(rig));
  EXPECT_EQ(rig.servos.bad_instructions, 0U);
  for (const EmulatedServo& servo : rig.servos.servos) {
    EXPECT_TRUE(servo.goals.empty());
    EXPECT_EQ(servo.eeprom_writes, 0U);
  }
}

TEST(ServoChain, TakesThePowerFromServosThatHaveItAndClearsTheirWatchdog) {
  ChainRig rig(2);
  rig.servos.servo(1).table[64] = 1;
  rig.servos.servo(1).table[98] = 255;
  rig.connect();
  EXPECT_FALSE(any_has_power(rig));
  EXPECT_EQ(rig.servos.servo(1).table[98], 0);
}

TEST(ServoChain, ServosHoldTheirAnglesWhenTheyAreSwitchedOn) {
  ChainRig rig(2);
  rig.servos.servo(1).set_number(132, 4, 2500);
  rig.connect();
  rig.switch_on();
  ASSERT_EQ(rig.servos.servo(1).goals.size(), 1U);
  EXPECT_EQ(rig.servos.servo(1).goals[0].position, 2500);
  EXPECT_FALSE(rig.servos.servo(1).goals[0].has_power);
  EXPECT_EQ(rig.servos.servo(1).position(), 2500);
  EXPECT_TRUE(rig.servos.servo(1).has_power());
  EXPECT_EQ(rig.servos.servo(1).table[98], 10);  // 200 ms
}

TEST(ServoChain, WritesTheEepromOnlyIfItIsWrongAndShowsIt) {
  ChainRig rig(2);
  rig.servos.servo(2).table[11] = 1;   // velocity control
  rig.servos.servo(2).table[10] = 12;  // power with each goal, profile in times
  rig.connect();
  EXPECT_EQ(rig.servos.servo(2).table[11], 3);
  EXPECT_EQ(rig.servos.servo(2).table[10], 0);
  EXPECT_EQ(rig.servos.servo(2).eeprom_writes, 2U);
  EXPECT_EQ(rig.shown, (std::vector<std::string>{"servo 2 (joint J2): Operating Mode(11) was 1, is 3 now",
                                                 "servo 2 (joint J2): Drive Mode(10) was 12, is 0 now"}));
}

TEST(ServoChain, ConnectsToServosThatDoNotAnswerWrites) {
  ChainRig rig(2);
  rig.servos.servo(1).table[68] = 1;
  rig.connect();
  EXPECT_EQ(rig.servos.servo(1).table[68], 2);
}

TEST(ServoChain, TheProfileVelocityIsThatOfTheJoint) {
  ChainSettings settings = test::chain_settings(1);
  settings.servos[0].max_speed_deg_s = 258.0;  // 43 rev/min
  ChainRig rig(settings);
  rig.connect();
  EXPECT_EQ(rig.servos.servo(1).number(112, 4), 187U);  // 43 / 0.229, rounded down
  EXPECT_EQ(rig.servos.servo(1).number(108, 4), 0U);
}

TEST(ServoChain, AMissingServoIsNamedWithThoseThatAnswerAndNothingHasPower) {
  ChainRig rig(5);
  rig.servos.servo(3).is_missing = true;
  EXPECT_EQ(ChainRig::error_of([&] { rig.connect(); }),
            "servo 3 (joint J3) does not answer on /dev/servos at 1000000 baud (servos that answer: 1, 2, 4, 5); check "
            "cable, power, id and Baud Rate(8)");
  EXPECT_FALSE(any_has_power(rig));
}

TEST(ServoChain, AServoWithAWrongIdIsNamed) {
  ChainRig rig(2);
  rig.servos.servo(2).id = 9;
  EXPECT_EQ(
      ChainRig::error_of([&] { rig.connect(); }),
      "servo 2 (joint J2) does not answer on /dev/servos at 1000000 baud (servos that answer: 1, 9); check cable, "
      "power, id and Baud Rate(8)");
}

TEST(ServoChain, RefusesWhatItCannotDrive) {
  const auto error_with = [](const auto& change) {
    ChainRig rig(1);
    change(rig.servos.servo(1));
    return ChainRig::error_of([&] { rig.connect(); });
  };
  EXPECT_EQ(error_with([](EmulatedServo& servo) { servo.set_number(0, 2, 350); }),
            "servo 1 (joint J1) has the model number 350, expected one of the X series or MX(2.0)");
  EXPECT_EQ(error_with([](EmulatedServo& servo) { servo.fail(0x24); }),
            "servo 1 (joint J1) has a hardware error: overheating, overload; remove the cause, then switch the servo "
            "off and on");
  EXPECT_EQ(error_with([](EmulatedServo& servo) { servo.set_number(48, 4, 3000); }),
            "servo 1 (joint J1) allows positions 0 to 3000, expected 1024 to 3072 for the limits of the joint: change "
            "Min and Max Position Limit(52, 48), or set lower_limit and upper_limit");
}

TEST(ServoChain, APositionBeyondOneTurnIsNamedWithItsCauseBeforeThereIsPower) {
  const auto error_with = [](std::uint32_t position, std::uint32_t homing_offset) {
    ChainRig rig(1);
    rig.servos.servo(1).set_number(132, 4, position);
    rig.servos.servo(1).set_number(20, 4, homing_offset);
    const std::string error = ChainRig::error_of([&] { rig.connect(); });
    EXPECT_FALSE(any_has_power(rig));
    return error;
  };
  EXPECT_EQ(error_with(static_cast<std::uint32_t>(-3000), 0),
            "servo 1 (joint J1) is at position -3000, expected 0 to 4095; its Homing Offset(20) is 0, so the joint was "
            "turned by more than one revolution: turn it back, or switch the servo off and on");
  EXPECT_EQ(error_with(5000, static_cast<std::uint32_t>(-12)),
            "servo 1 (joint J1) is at position 5000, expected 0 to 4095; its Homing Offset(20) is -12: set it to 0, or "
            "turn the joint back");
  EXPECT_NE(error_with(0x80000000U, 0), "");
  EXPECT_EQ(error_with(4100, 0), "");
}

TEST(ServoChain, RepeatsARequestTwiceAfterAFaultyAnswer) {
  for (unsigned EmulatedServo::*const fault :
       {&EmulatedServo::silent, &EmulatedServo::corrupt, &EmulatedServo::truncated, &EmulatedServo::with_wrong_id,
        &EmulatedServo::with_noise, &EmulatedServo::crc_errors}) {
    ChainRig rig(2);
    rig.servos.servo(2).*fault = 2;
    rig.connect();
    EXPECT_TRUE(rig.chain.is_connected());
  }
}

TEST(ServoChain, AnAnswerThatComesAfterItsRepetitionIsNotThatToTheNextRequest) {
  // The answer comes when the repetition has been answered, after one request or some later.
  for (std::uint32_t late_us = 39'000; late_us < 46'000; late_us += 100) {
    for (unsigned answer = 1; answer < 20; ++answer) {
      ChainRig rig(1);
      EmulatedServo& servo = rig.servos.servo(1);
      servo.table[9] = 17;
      servo.set_number(132, 4, 2600);
      servo.until_late = answer;
      servo.late_us = late_us;
      ASSERT_EQ(ChainRig::error_of([&] {
                  rig.connect();
                  rig.switch_on();
                }),
                "")
          << late_us << ' ' << answer;
      ASSERT_EQ(servo.eeprom_writes, 0U) << late_us << ' ' << answer;
      ASSERT_EQ(servo.position(), 2600) << late_us << ' ' << answer;
    }
  }
}

TEST(ServoChain, TwoServosWithOneIdAreFoundAndNothingIsWritten) {
  for (const std::uint8_t id : {std::uint8_t{1}, std::uint8_t{3}, std::uint8_t{5}}) {
    for (const std::uint32_t delay_us : {0U, 508U, 16'000U}) {  // in front of the second answer
      ChainRig rig(5);
      EmulatedServo second(id);
      second.delay_us = delay_us;
      second.table[10] = 1;
      rig.servos.servos.insert(rig.servos.servos.begin() + id, second);
      const auto before = rig.servos.servos;
      EXPECT_EQ(ChainRig::error_of([&] { rig.connect(); }),
                "two servos have the id " + std::to_string(id) +
                    ": one request got two answers; connect one of them alone, and change its ID(7)");
      for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(rig.servos.servos[i].table, before[i].table);
      }
    }
  }
}

TEST(ServoChain, OneAnswerOfASecondServoWritesNoEeprom) {
  for (unsigned answer = 1; answer < 40; ++answer) {
    ChainRig rig(1);
    EmulatedServo second(1);
    second.only_answer = answer;
    second.table[10] = 1;
    second.table[11] = 1;
    rig.servos.servos.push_back(second);  // it answers last: when the next request has been sent
    EXPECT_EQ(ChainRig::error_of([&] { rig.connect(); }), "") << answer;
    EXPECT_EQ(rig.servos.servos[0].eeprom_writes + rig.servos.servos[1].eeprom_writes, 0U) << answer;
  }
}

TEST(ServoChain, AServoThatRestsOutsideOfItsLimitGoesToIt) {
  ChainRig rig(1);
  rig.servos.servo(1).set_number(52, 4, 1024);
  rig.servos.servo(1).set_number(132, 4, 1010);
  rig.connect();
  rig.switch_on();
  EXPECT_EQ(rig.servos.servo(1).goals.back().position, 1024);
}

TEST(ServoChain, NamesTheKindOfAFaultThatStays) {
  const auto error_with = [](unsigned EmulatedServo::*fault) {
    ChainRig rig(1);
    rig.servos.servo(1).*fault = 1000;
    return ChainRig::error_of([&] { rig.connect(); });
  };
  EXPECT_NE(error_with(&EmulatedServo::corrupt).find("answers were damaged: two servos with one id"),
            std::string::npos);
  EXPECT_NE(error_with(&EmulatedServo::truncated).find("its answer was cut short"), std::string::npos);
  EXPECT_NE(error_with(&EmulatedServo::with_wrong_id).find("servo 99 answered instead"), std::string::npos);
}

TEST(ServoChain, WorksWithAnAdapterThatReturnsWhatIsSent) {
  ChainRig rig(3);
  rig.servos.echoes = true;
  rig.connect();
  rig.switch_on();
  rig.tick(10.0);
  EXPECT_EQ(rig.servos.servo(3).position(), 2048 + 114);
}

TEST(ServoChain, ATickWritesAllGoalsAndReadsTheAngles) {
  ChainRig rig(5);
  rig.connect();
  rig.switch_on();
  EXPECT_EQ(rig.chain.reads_per_tick(), 5U);
  for (int i = 0; i < 40; ++i) {
    rig.tick(i);
    EXPECT_EQ(rig.overrun_us, 0U) << i;
  }
  for (std::size_t joint = 0; joint < 5; ++joint) {
    EXPECT_NEAR(rig.chain.readings()[joint].angle_deg, 39.0, 0.05);
  }
}

TEST(ServoChain, ReadsAsManyServosInATickAsTheLineAllows) {
  ChainSettings settings = test::chain_settings(6);
  settings.rate = 115'200;
  ChainRig rig(settings);
  rig.connect();
  rig.switch_on();
  EXPECT_EQ(rig.chain.reads_per_tick(), 1U);
  for (int i = 0; i < 64; ++i) {
    rig.tick(20.0);
    EXPECT_EQ(rig.overrun_us, 0U) << i;
  }
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_NEAR(rig.chain.readings()[joint].angle_deg, 20.0, 0.05);
  }
}

TEST(ServoChain, ToleratesTwoMissedAnswersInARow) {
  for (unsigned EmulatedServo::*const fault :
       {&EmulatedServo::silent, &EmulatedServo::corrupt, &EmulatedServo::truncated, &EmulatedServo::with_wrong_id}) {
    ChainRig rig(5);
    rig.connect();
    rig.switch_on();
    for (int i = 0; i < 30; ++i) {
      if (i % 5 == 0) {
        rig.servos.servo(3).*fault = 2;
      }
      rig.tick(i);
      EXPECT_EQ(rig.overrun_us, 0U);
    }
  }
}

TEST(ServoChain, AServoThatStopsAnsweringIsNamedWhileTheOthersGetTheirGoals) {
  ChainRig rig(5);
  rig.connect();
  rig.switch_on();
  rig.tick(5.0);
  rig.servos.servo(4).is_missing = true;
  std::string error;
  int ticks = 0;
  for (; error.empty() && ticks < 100; ++ticks) {
    error = ChainRig::error_of([&] { rig.tick(6.0); });
    EXPECT_EQ(rig.overrun_us, 0U);
  }
  EXPECT_EQ(error, "servo 4 (joint J4) has not answered 3 times in a row; check its cable and its power");
  EXPECT_EQ(ticks, 3);
  EXPECT_FALSE(ChainRig::error_of([&] { rig.tick(7.0); }).empty());
  EXPECT_NEAR(rig.servos.servo(5).position(), 2048 + 7 * 4096 / 360, 1);
}

TEST(ServoChain, AHardwareErrorWhileMovingIsNamed) {
  ChainRig rig(2);
  rig.connect();
  rig.switch_on();
  rig.tick(1.0);
  rig.servos.servo(2).fail(0x20);
  EXPECT_EQ(ChainRig::error_of([&] { rig.tick(2.0); }),
            "servo 2 (joint J2) has a hardware error: overload; remove the cause, then switch the servo off and on");
}

TEST(ServoChain, ServosStopWhenTheHostIsSilentAndTheChainReportsIt) {
  ChainRig rig(2);
  rig.connect();
  rig.switch_on();
  rig.tick(1.0);
  rig.now_us += 190'000;
  rig.servos.advance(rig.now_us);
  EXPECT_FALSE(rig.servos.servo(1).was_stopped_by_watchdog());
  rig.now_us += 20'000;
  rig.servos.advance(rig.now_us);
  EXPECT_TRUE(rig.servos.servo(1).was_stopped_by_watchdog());
  std::string error;
  for (int i = 0; error.empty() && i < 100; ++i) {
    error = ChainRig::error_of([&] { rig.tick(30.0); });
  }
  EXPECT_EQ(error.substr(0, 55), "servo 1 (joint J1) was stopped by its bus watchdog: it ");
  EXPECT_LT(rig.servos.servo(1).position(), 2048 + 12);  // it has not followed the goals
}

TEST(ServoChain, SwitchesOffTheOthersIfAServoIsMissing) {
  ChainRig rig(5);
  rig.connect();
  rig.switch_on();
  rig.servos.servo(1).is_missing = true;
  const std::string error = ChainRig::error_of([&] { rig.chain.switch_off(rig.now_us + 1'000'000); });
  EXPECT_EQ(error, "servo 1 (joint J1) did not confirm that the power is off; switch the supply of the servos off");
  for (std::uint8_t id = 2; id <= 5; ++id) {
    EXPECT_FALSE(rig.servos.servo(id).has_power());
  }
}

}  // namespace
}  // namespace proleg::host
