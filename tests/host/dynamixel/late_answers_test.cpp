// Answers that take longer than usual: an adapter that keeps bytes, a hub, a bridge. And bytes that are no answers.

#include <gtest/gtest.h>

#include "chain_rig.hpp"

namespace proleg::host {
namespace {

using test::ChainRig;
using test::EmulatedServo;

const std::string advice =
    "set the latency timer of the adapter to 1 ms (install 70-proleg.rules, docs/installing.md, or echo 1 > "
    "/sys/bus/usb-serial/devices/ttyUSB0/latency_timer), or use a longer tick";

void delay_all(ChainRig& rig, std::uint32_t delay_us) {
  for (EmulatedServo& servo : rig.servos.servos) {
    servo.delay_us = delay_us;
  }
}

TEST(LateAnswers, ThatDoNotFitInATickAreNamedBeforeThereIsPower) {
  ChainRig rig(5);
  delay_all(rig, 16'000);
  rig.servos.servo(2).table[11] = 1;
  // 15 + 32 bytes take 0.47 ms; five goals, 0.39 ms of the 9 ms for goals and reads. Of what is above the 1.97 ms of
  // an adapter with low latency, a quarter stays free.
  EXPECT_EQ(ChainRig::error_of([&] { rig.connect(); }),
            "answers take 16.5 ms, a tick of 10 ms has time for 7.3 ms: " + advice);
  for (const EmulatedServo& servo : rig.servos.servos) {
    EXPECT_FALSE(servo.has_power());
    EXPECT_EQ(servo.eeprom_writes, 0U);
  }
}

TEST(LateAnswers, ThatFitInATickReduceWhatIsRead) {
  struct Case {
    std::uint32_t delay_us;
    std::size_t reads;
  };
  // An answer takes its delay and 0.32 ms, a request 0.15 ms. 8.6 ms are there. Answers may vary if several are read.
  for (const Case& entry : {Case{500, 5}, Case{2000, 2}, Case{3000, 1}, Case{4000, 1}, Case{6000, 1}}) {
    ChainRig rig(5);
    delay_all(rig, entry.delay_us);
    rig.connect();
    EXPECT_EQ(rig.chain.reads_per_tick(), entry.reads) << entry.delay_us;
    rig.switch_on();
    for (int i = 0; i < 100; ++i) {
      rig.tick(10.0);
      EXPECT_EQ(rig.overrun_us, 0U) << entry.delay_us;
    }
    EXPECT_NEAR(rig.chain.readings()[4].angle_deg, 10.0, 0.05);
  }
}

TEST(LateAnswers, FitInALongerTick) {
  ChainSettings settings = test::chain_settings(5);
  settings.tick_us = 30'000;
  ChainRig rig(settings);
  delay_all(rig, 16'000);
  rig.connect();
  EXPECT_EQ(rig.chain.reads_per_tick(), 1U);
}

TEST(LateAnswers, AreNotTakenForThoseToTheNextRequest) {
  for (int tick = 0; tick < 8; ++tick) {
    ChainRig rig(1);
    rig.connect();
    rig.switch_on();
    for (int i = 0; i < tick; ++i) {
      rig.tick(0.0);
    }
    EmulatedServo& servo = rig.servos.servo(1);
    servo.until_late = 1;
    servo.late_us = 10'000;
    rig.tick(30.0);
    servo.silent = 1;
    rig.tick(60.0);
    EXPECT_EQ(rig.chain.readings()[0].angle_deg, 0.0) << tick;
    rig.tick(60.0);
    rig.tick(60.0);
    EXPECT_NEAR(rig.chain.readings()[0].angle_deg, 60.0, 0.05) << tick;
  }
}

TEST(LateAnswers, ThatContinueEndTheRunAndAreNamed) {
  ChainRig rig(3);
  rig.connect();
  rig.switch_on();
  for (int i = 0; i < 20; ++i) {
    rig.tick(i);
  }
  rig.servos.servo(2).delay_us = 12'000;
  std::string error;
  for (int i = 0; error.empty() && i < 40; ++i) {
    error = ChainRig::error_of([&] { rig.tick(20.0); });
    EXPECT_EQ(rig.overrun_us, 0U);
  }
  EXPECT_EQ(error.substr(0, 71), "servo 2 (joint J2) has not answered in its tick 10 times in a row, but ");
  EXPECT_EQ(error.substr(error.find(';') + 2), advice);
}

TEST(LateAnswers, ThatComeInTwoPartsAreRead) {
  ChainRig rig(3);
  for (EmulatedServo& servo : rig.servos.servos) {
    servo.split_us = 3000;
  }
  rig.connect();
  EXPECT_EQ(rig.chain.reads_per_tick(), 1U);
  rig.switch_on();
  for (int i = 0; i < 40; ++i) {
    rig.tick(10.0);
  }
  EXPECT_NEAR(rig.chain.readings()[2].angle_deg, 10.0, 0.05);
  // The rest comes after the next goals are sent, and before the next answer.
  rig.servos.servo(2).split_us = 9'200;
  std::string error;
  for (int i = 0; error.empty() && i < 200; ++i) {
    error = ChainRig::error_of([&] { rig.tick(20.0); });
  }
  EXPECT_EQ(error.substr(0, 71), "servo 2 (joint J2) has not answered in its tick 10 times in a row, but ");
}

TEST(LateAnswers, ADelayOfSomeTicksEndsNoRun) {
  ChainRig rig(3);
  rig.connect();
  rig.switch_on();
  for (int i = 0; i < 100; ++i) {
    rig.servos.servo(2).delay_us = i % 20 >= 15 ? 10'000 : 500;
    rig.tick(i);
  }
}

TEST(LateAnswers, ThatAreDamagedAreNamed) {
  ChainRig rig(3);
  rig.connect();
  rig.switch_on();
  rig.servos.servo(2).corrupt = 1000;
  std::string error;
  for (int i = 0; error.empty() && i < 40; ++i) {
    error = ChainRig::error_of([&] { rig.tick(20.0); });
  }
  EXPECT_EQ(
      error,
      "servo 2 (joint J2) has not answered 3 times in a row, and 3 damaged answers were received; check its cable "
      "and the ground of the line");
}

TEST(LateAnswers, ThatRejectTheReadAreNamed) {
  ChainRig rig(3);
  rig.connect();
  rig.switch_on();
  rig.servos.servo(2).crc_errors = 1000;
  std::string error;
  for (int i = 0; error.empty() && i < 40; ++i) {
    error = ChainRig::error_of([&] { rig.tick(20.0); });
  }
  EXPECT_EQ(error,
            "servo 2 (joint J2) rejects reads with CRC Error, 3 times in a row; check its cable and the ground of the "
            "line");
}

/// A line on which there is always another byte.
class NoisyLine final : public Line {
 public:
  [[nodiscard]] std::uint64_t now_us() override { return now_us_; }
  void write(std::span<const std::uint8_t> /*bytes*/) override {}
  std::size_t read(std::span<std::uint8_t> into, std::uint64_t /*deadline_us*/) override {
    now_us_ += 10;
    into[0] = 0x55;
    return 1;
  }
  void discard_input() override {}

 private:
  std::uint64_t now_us_ = 0;
};

TEST(LateAnswers, ALineThatIsNeverSilentKeepsTheDeadline) {
  NoisyLine line;
  ServoChain chain(line, test::chain_settings(2), [](const std::string&) {});
  EXPECT_EQ(ChainRig::error_of([&] { chain.connect(1'000'000); }).substr(0, 34), "servo 1 (joint J1) does not answer");
  EXPECT_LT(line.now_us(), 1'400'000U);
}

}  // namespace
}  // namespace proleg::host
