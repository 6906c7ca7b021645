#include "firmware/stm32f405/reset.hpp"

#include <gtest/gtest.h>

namespace proleg::stm32f405 {
namespace {

using firmware::ResetCause;

// RCC_CSR as the chip sets it (RM0090, section 7.3.21). The pin's flag (bit 26) comes with every other one.
TEST(ResetCauseTest, IsReadOffTheFlags) {
  EXPECT_EQ(reset_cause_of(0x0E00'0000), ResetCause::power_on) << "the register's reset value";
  EXPECT_EQ(reset_cause_of(0x0600'0000), ResetCause::power_on) << "brown-out";
  EXPECT_EQ(reset_cause_of(0x0400'0000), ResetCause::pin);
  EXPECT_EQ(reset_cause_of(0x1400'0000), ResetCause::software);
  EXPECT_EQ(reset_cause_of(0x2400'0000), ResetCause::watchdog);
}

TEST(ResetCauseTest, TheOscillatorsBitsDoNotMatter) {
  EXPECT_EQ(reset_cause_of(0x2400'0003), ResetCause::watchdog);
  EXPECT_EQ(reset_cause_of(0x0400'0001), ResetCause::pin);
}

}  // namespace
}  // namespace proleg::stm32f405
