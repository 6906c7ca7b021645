#include "firmware/stm32f405/led.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>

namespace proleg::stm32f405 {
namespace {

constexpr Microseconds second = 1'000'000;
constexpr std::array patterns{LedPattern::bootloader, LedPattern::pre_operational, LedPattern::stopped,
                              LedPattern::operational, LedPattern::fault};

/// The changes from off to on in a time.
unsigned flashes(LedPattern pattern, Microseconds from, Microseconds to) {
  unsigned count = 0;
  for (Microseconds now = from + 1'000; now <= to; now += 1'000) {
    count += is_on(pattern, now) && !is_on(pattern, now - 1'000) ? 1U : 0U;
  }
  return count;
}

TEST(LedPattern, HasTheFlashesOfTheManual) {
  EXPECT_EQ(flashes(LedPattern::bootloader, 0, 16 * second), 160U);
  EXPECT_EQ(flashes(LedPattern::pre_operational, 0, 16 * second), 40U);
  EXPECT_EQ(flashes(LedPattern::stopped, 0, 16 * second), 10U);
  EXPECT_EQ(flashes(LedPattern::fault, 0, 16 * second), 20U);
  EXPECT_EQ(flashes(LedPattern::operational, 0, 16 * second), 0U);
  EXPECT_TRUE(is_on(LedPattern::operational, 7 * second));
}

TEST(LedPattern, IsAnotherOneAlsoIfTheLedIsInverted) {
  std::set<std::string> seen;
  for (const LedPattern pattern : patterns) {
    std::string text;
    std::string inverted;
    for (Microseconds now = 0; now < 1'600'000; now += 50'000) {
      text += is_on(pattern, now) ? '1' : '0';
      inverted += is_on(pattern, now) ? '0' : '1';
    }
    EXPECT_TRUE(seen.insert(text).second) << text;
    if (pattern != LedPattern::bootloader && pattern != LedPattern::pre_operational) {  // these are the same, shifted
      EXPECT_TRUE(seen.insert(inverted).second) << inverted;
    }
  }
}

}  // namespace
}  // namespace proleg::stm32f405
