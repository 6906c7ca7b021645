#include "shared/gait/joint_readings.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>

namespace proleg {
namespace {

/// One sensor, by the text of the rule: it counts the equal samples in a row that differ from the accepted value.
class SlowModel {
 public:
  bool sample(bool raw) {
    in_a_row_ = raw == accepted_ ? 0 : in_a_row_ + 1;
    if (in_a_row_ == 2) {
      accepted_ = raw;
      in_a_row_ = 0;
    }
    return accepted_;
  }

 private:
  bool accepted_ = false;
  int in_a_row_ = 0;
};

TEST(ContactDebouncer, AcceptsAChangeAtItsSecondEqualSampleInEverySequenceOfSixteen) {
  for (unsigned sequence = 0; sequence < 1U << 16U; ++sequence) {
    ContactDebouncer debouncer;
    SlowModel model;
    for (unsigned tick = 0; tick < 16; ++tick) {
      const unsigned raw = (sequence >> tick) & 1U;
      ASSERT_EQ(debouncer.sample(static_cast<std::uint8_t>(raw)), model.sample(raw != 0) ? 1 : 0)
          << "sequence " << sequence << " tick " << tick;
    }
  }
}

TEST(ContactDebouncer, TakesEachOfFourSensorsForItselfInEverySequenceOfFive) {
  constexpr unsigned length = 5;
  for (unsigned sequence = 0; sequence < 1U << (4 * length); ++sequence) {
    ContactDebouncer debouncer;
    std::array<SlowModel, 4> models;
    for (unsigned tick = 0; tick < length; ++tick) {
      const unsigned raw = (sequence >> (4 * tick)) & 15U;
      unsigned expected = 0;
      for (unsigned sensor = 0; sensor < 4; ++sensor) {
        expected |= models[sensor].sample(((raw >> sensor) & 1U) != 0) ? 1U << sensor : 0U;
      }
      ASSERT_EQ(debouncer.sample(static_cast<std::uint8_t>(raw)), expected)
          << "sequence " << sequence << " tick " << tick;
    }
  }
}

TEST(ContactDebouncer, ReportsASensorThatBouncesOnceAsItClosesAndOnceAsItOpens) {
  constexpr unsigned seed = 31;
  std::mt19937 random(seed);
  for (int run = 0; run < 1000; ++run) {
    // While a contact bounces no two samples in a row are equal; how long that takes, and in which phase, varies.
    std::string samples(2, '0');
    for (const char settled : {'1', '0'}) {
      const auto bounces = 2 * (random() % 5);
      for (std::uint_fast32_t i = 0; i < bounces; ++i) {
        samples += i % 2 == 0 ? settled : static_cast<char>('0' + '1' - settled);
      }
      samples.append(2 + random() % 20, settled);
    }
    ContactDebouncer debouncer;
    int changes = 0;
    std::uint8_t before = 0;
    for (const char sample : samples) {
      const std::uint8_t now = debouncer.sample(sample == '1' ? 8 : 0);
      changes += now != before ? 1 : 0;
      before = now;
    }
    EXPECT_EQ(changes, 2) << samples << ", seed " << seed << " run " << run;
    EXPECT_EQ(before, 0);
  }
}

TEST(ContactDebouncer, DoesNotHearAPressOrAReleaseOfASingleTick) {
  ContactDebouncer debouncer;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(debouncer.sample(i % 2 == 0 ? 15 : 0), 0);
  }
  debouncer.sample(15);
  EXPECT_EQ(debouncer.sample(15), 15);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(debouncer.sample(i % 2 == 0 ? 0 : 15), 15);
  }
}

TEST(ContactDebouncer, IgnoresBitsThatAreNoContacts) {
  for (unsigned raw = 0; raw < 256; ++raw) {
    ContactDebouncer debouncer;
    debouncer.sample(static_cast<std::uint8_t>(raw));
    EXPECT_EQ(debouncer.sample(static_cast<std::uint8_t>(raw)), raw & StateFrame::contact_bits);
  }
}

TEST(ContactDebouncer, HasNothingPressedAtTheStartAndAfterAReset) {
  ContactDebouncer debouncer;
  EXPECT_EQ(debouncer.sample(5), 0);
  EXPECT_EQ(debouncer.sample(5), 5);
  debouncer.reset();
  EXPECT_EQ(debouncer.sample(5), 0) << "neither what was accepted nor the last sample outlives it";
  EXPECT_EQ(debouncer.sample(5), 5);
}

}  // namespace
}  // namespace proleg
