// The pulses at PA5, edge by edge.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

constexpr std::int32_t right_angle = 1 << 30;
constexpr BusTime tick = 10 * ms;
/// A SYNC is noted with the microsecond that has begun.
constexpr BusTime early = us;
/// From SYNC, or from the deadline of an interval, to the pulse: interrupt and program.
constexpr BusTime max_latency = 30 * us;

struct Pulse {
  BusTime start;
  BusTime length;
};

class ServoPin : public testing::Test {
 protected:
  ServoPin() {
    rig_.chip.set_pin_watch('A', 5, [this](BusTime time, bool high) {
      EXPECT_NE(high, is_high_);
      is_high_ = high;
      if (high) {
        rise_ = time;
      } else {
        pulses_.push_back({rise_, time - rise_});
        fall_ = time;
      }
    });
  }

  [[nodiscard]] BusTime sync(std::size_t number) const { return rig_.frames(0x080).at(number).time; }
  struct Place {
    BusTime interval;  ///< of the servo, since SYNC 0
    BusTime late;      ///< after its begin, plus `early`
  };
  /// By the SYNC of the tick.
  [[nodiscard]] Place place_of(const Pulse& pulse, BusTime period) const {
    const std::vector<LoggedFrame> syncs = rig_.frames(0x080);
    std::size_t number = 0;
    while (number + 1 < syncs.size() && syncs[number + 1].time <= pulse.start + early) {
      ++number;
    }
    const BusTime since_begin = number * tick + pulse.start + early - syncs.at(number).time;
    return {since_begin / period, since_begin % period};
  }
  void go_to(std::int32_t target, std::uint8_t controlword = 0x0F) {
    CanFrame command{0x203, 6, {controlword, 0}};
    for (unsigned i = 0; i < 4; ++i) {
      command.data[2 + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(target) >> 8U * i);
    }
    rig_.host.send(command);
  }
  /// In the middle of a pulse.
  void run_into_pulse() {
    ASSERT_TRUE(rig_.run_until_true([this] { return !is_high_; }));
    ASSERT_TRUE(rig_.run_until_true([this] { return is_high_; }));
    rig_.run_for(100 * us);
    ASSERT_TRUE(is_high_);
  }

  ChipRig rig_;
  bool is_high_ = false;
  BusTime rise_ = 0;
  BusTime fall_ = 0;
  std::vector<Pulse> pulses_;
};

/// A width in twelfths of a microsecond, exactly: 1 ns for the rounding of both edges.
void expect_width(const Pulse& pulse, double width) {
  EXPECT_NEAR(static_cast<double>(pulse.length), width * 1e3 / 12, 1.01) << "pulse at " << pulse.start;
}

double width_of(double angle) { return std::floor(18'000 + 12'000 * angle / right_angle + 0.5); }

TEST_F(ServoPin, IsLowUntilTheServoIsEnabled) {
  rig_.start_robot(20'000);
  rig_.run_for(100 * ms);
  EXPECT_TRUE(pulses_.empty());
  EXPECT_FALSE(is_high_);
}

class ServoPeriod : public ServoPin, public testing::WithParamInterface<unsigned> {
 protected:
  const BusTime period_ = GetParam() * us;
};

TEST_P(ServoPeriod, EveryPulseIsAsWideAsItsAngleAndStartsOnTheSchedule) {
  rig_.start_robot(GetParam());
  rig_.enable_servo(0);
  for (const std::int32_t target : {0, 1, right_angle / 3, -right_angle / 7, right_angle, -right_angle}) {
    go_to(target);
    rig_.run_for(60 * ms);  // it is there
    const std::size_t first = pulses_.size();
    rig_.run_for(200 * ms);
    ASSERT_GE(pulses_.size() - first, 200 * ms / period_ - 1);
    for (std::size_t i = first; i < pulses_.size(); ++i) {
      expect_width(pulses_[i], width_of(target));
      const Place place = place_of(pulses_[i], period_);
      EXPECT_LT(place.late, max_latency + early) << "pulse at " << pulses_[i].start;
      EXPECT_TRUE(i == first || place.interval == place_of(pulses_[i - 1], period_).interval + 1) << "none is left out";
    }
  }
}

TEST_P(ServoPeriod, BetweenTwoSetPointsThePulsesAreOnTheLine) {
  rig_.start_robot(GetParam());
  rig_.enable_servo(0);
  rig_.run_for(60 * ms);
  // To be there before a SYNC, in the middle of a tick.
  while ((rig_.bus.now() - sync(0)) % tick > tick / 2) {
    rig_.run_for(ms);
  }
  const std::size_t change = rig_.frames(0x080).size();  // tick of the next SYNC: out(change) = 0, then the target
  go_to(right_angle / 2);
  const std::size_t first = pulses_.size();
  rig_.run_for(60 * ms);
  std::size_t on_the_way = 0;
  for (std::size_t i = first; i < pulses_.size(); ++i) {
    const BusTime interval = place_of(pulses_[i], period_).interval;
    const BusTime number = interval * period_ / tick;
    const BusTime middle_ns = interval * period_ % tick + period_ / 2;
    const double middle = static_cast<double>(middle_ns) / static_cast<double>(tick);
    const double way = number < change ? 0.0 : number > change ? 1.0 : std::min(middle, 1.0);
    on_the_way += way > 0 && way < 1 ? 1 : 0;
    // docs/protocol.md rounds the fraction down to 2^-15: less than a step of 6000.
    EXPECT_NEAR(static_cast<double>(pulses_[i].length) * 12e-3, width_of(way * 0.5 * right_angle), 1.02)
        << "pulse at " << pulses_[i].start;
  }
  EXPECT_TRUE(on_the_way >= 2 || period_ >= tick);
}

TEST_P(ServoPeriod, PulsesOfAHungProgramContinueAQuarterLaterUntilTheWatchdogResetsIt) {
  rig_.start_robot(GetParam());
  rig_.enable_servo(right_angle / 4);
  rig_.run_for(100 * ms);
  run_into_pulse();
  const std::size_t first = pulses_.size();
  rig_.break_program({branch_to_itself});
  ASSERT_TRUE(rig_.run_until_true([this] { return !rig_.events.empty(); }, 300 * ms));
  const BusTime reset = rig_.events[0].time;
  EXPECT_EQ(rig_.events[0].cause, ResetCause::independent_watchdog);
  ASSERT_GE(pulses_.size() - first, 150 * ms / (period_ / 4 * 5));
  for (std::size_t i = first + 1; i < pulses_.size(); ++i) {
    if (pulses_[i].start + 3 * ms < reset) {
      expect_width(pulses_[i], width_of(0.25 * right_angle));
    }
    EXPECT_NEAR(static_cast<double>(pulses_[i].start - pulses_[i - 1].start), static_cast<double>(period_) * 1.25, 2.0);
  }
  rig_.run_for(50 * ms);
  EXPECT_FALSE(is_high_);
  EXPECT_LE(fall_, reset) << "low from the reset on";
}

INSTANTIATE_TEST_SUITE_P(Servos, ServoPeriod, testing::Values(20'000U, 10'000U, 3'300U));

/// Periods that are shorter than pulse and pause together: pulses are left out, none is cut short. Where in the
/// millisecond they start depends on the pulses before: the timer repeats some of them before the program runs.
TEST_F(ServoPin, APeriodOfOneMillisecondIsThinnedSoThatPulsesStayWhole) {
  rig_.start_robot(1'000);
  rig_.enable_servo(0);
  for (const auto& [target, every] :
       {std::pair{-right_angle, ms}, std::pair{0, 2 * ms}, std::pair{right_angle, 3 * ms}}) {
    go_to(target);
    rig_.run_for(60 * ms);
    const std::size_t first = pulses_.size();
    rig_.run_for(120 * ms);
    ASSERT_GE(pulses_.size() - first, 120 * ms / every - 1);
    for (std::size_t i = first; i < pulses_.size(); ++i) {
      expect_width(pulses_[i], width_of(target));
      if (i != first) {
        const auto distance = static_cast<double>(pulses_[i].start - pulses_[i - 1].start);
        EXPECT_NEAR(distance, static_cast<double>(every), static_cast<double>(max_latency));
      }
    }
  }
}

TEST_F(ServoPin, AThreeMillisecondServoGetsEveryPulseAtItsWidest) {
  rig_.start_robot(3'000);
  rig_.enable_servo(right_angle);
  rig_.run_for(60 * ms);
  const std::size_t first = pulses_.size();
  rig_.run_for(300 * ms);
  EXPECT_NEAR(static_cast<double>(pulses_.size() - first), 100, 1);
  for (std::size_t i = first + 1; i < pulses_.size(); ++i) {
    expect_width(pulses_[i], width_of(right_angle));
    EXPECT_NEAR(static_cast<double>(pulses_[i].start - pulses_[i - 1].start), 3.0 * ms,
                static_cast<double>(max_latency));
  }
}

TEST_F(ServoPin, OffLetsThePulseEndWithItsWidthAndGivesNoFurther) {
  rig_.start_robot(20'000);
  rig_.enable_servo(0);
  rig_.run_for(50 * ms);
  run_into_pulse();
  const std::size_t count = pulses_.size();
  const BusTime before = rig_.bus.now();
  go_to(0, 0);
  rig_.run_for(150 * ms);
  ASSERT_EQ(rig_.frames(0x203, before).size(), 1U);
  ASSERT_LT(rig_.frames(0x203, before)[0].time, fall_) << "it came in the pulse";
  ASSERT_EQ(pulses_.size(), count + 1);
  expect_width(pulses_.back(), width_of(0));
  EXPECT_FALSE(is_high_);
}

TEST_F(ServoPin, OffBetweenTwoPulsesGivesNoFurther) {
  rig_.start_robot(20'000);
  rig_.enable_servo(0);
  rig_.run_for(50 * ms);
  run_into_pulse();
  rig_.run_for(5 * ms);
  const std::size_t count = pulses_.size();
  go_to(0, 0);
  rig_.run_for(150 * ms);
  EXPECT_EQ(pulses_.size(), count);
  EXPECT_FALSE(is_high_);
}

TEST_F(ServoPin, IsOnAgainWithWholePulses) {
  rig_.start_robot(20'000);
  rig_.enable_servo(0);
  rig_.run_for(50 * ms);
  for (const BusTime pause : {0 * us, 300 * us, 5 * ms, 40 * ms}) {
    run_into_pulse();
    go_to(0, 0);
    rig_.run_for(pause);
    const std::size_t first = pulses_.size();
    for (const std::uint8_t controlword : std::array<std::uint8_t, 3>{6, 7, 15}) {
      go_to(0, controlword);
    }
    rig_.run_for(100 * ms);
    ASSERT_GE(pulses_.size(), first + 3);
    for (std::size_t i = first; i < pulses_.size(); ++i) {
      expect_width(pulses_[i], width_of(0));
    }
  }
}

TEST_F(ServoPin, AResetIsLowAtOnce) {
  rig_.start_robot(20'000);
  rig_.enable_servo(0);
  rig_.run_for(50 * ms);
  run_into_pulse();
  const BusTime now = rig_.bus.now();
  rig_.power_on();
  EXPECT_FALSE(is_high_);
  EXPECT_LE(fall_, now + us);
  const std::size_t count = pulses_.size();
  rig_.run_for(200 * ms);
  EXPECT_EQ(pulses_.size(), count);
}

TEST_F(ServoPin, ItsFirstPulseIsWholeToAMicrosecond) {
  rig_.start_robot(20'000);
  rig_.enable_servo(0);
  rig_.run_for(100 * ms);
  ASSERT_FALSE(pulses_.empty());
  EXPECT_NEAR(static_cast<double>(pulses_[0].length), 1'500.0 * us, us);
}

/// PC7 of the reference board.
class ServoSupply : public testing::Test {
 protected:
  ServoSupply() {
    rig_.chip.set_pin_watch('C', 7, [this](BusTime time, bool high) {
      is_on_ = high;
      changed_ = time;
    });
  }
  void move() {
    rig_.start_robot(20'000);
    EXPECT_FALSE(is_on_);
    rig_.enable_servo(0);
    rig_.run_for(100 * ms);
    ASSERT_TRUE(is_on_);
  }
  ChipRig rig_;
  bool is_on_ = false;
  BusTime changed_ = 0;
};

TEST_F(ServoSupply, IsOnWhileTheServoHasPower) {
  move();
  rig_.write(0x6040, 0, 2, 0x02);
  rig_.run_for(1'500 * ms);
  EXPECT_TRUE(is_on_) << "the servo holds the safe pose";
  rig_.write(0x6040, 0, 2, 0x80);
  EXPECT_FALSE(is_on_);
}

TEST_F(ServoSupply, IsOffInAFault) {
  move();
  rig_.board.temperature = 120'000;
  rig_.run_for(100 * ms);
  EXPECT_FALSE(is_on_);
}

TEST_F(ServoSupply, IsOffWhenTheProgramHasAFaultAndAfterTheReset) {
  move();
  const BusTime start = rig_.bus.now();
  rig_.break_program({0xDE00});  // udf: an undefined instruction
  rig_.run_for(50 * ms);
  EXPECT_FALSE(is_on_);
  EXPECT_LT(changed_, start + 50 * ms);
  EXPECT_GT(changed_, start);
}

TEST_F(ServoSupply, IsOffFromAResetByThePinOn) {
  move();
  const BusTime start = rig_.bus.now();
  rig_.chip.pull_reset_pin();
  rig_.run_for(200 * ms);
  EXPECT_FALSE(is_on_);
  EXPECT_LT(changed_, start + ms);
}

}  // namespace
}  // namespace proleg::sim
