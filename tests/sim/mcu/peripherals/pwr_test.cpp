#include "sim/mcu/peripherals/pwr.hpp"

#include "support/bench.hpp"

namespace proleg::sim {
namespace {

// RM0090 rev 21, 5.4. VOSRDY is set always, see the header.
TEST(Pwr, ResetValuesAreThoseOfTheManual) {
  test::BenchChip chip;
  Pwr power(chip);
  power.write(0x00, 0x0101);
  power.reset();
  test::expect_values(power, {{0x00, 0x4000}, {0x04, 0x4000}});
}

TEST(Pwr, KeepsWhatCanBeWritten) {
  test::BenchChip chip;
  Pwr power(chip);
  power.write(0x00, 0xFFFF'FFEF);
  EXPECT_EQ(power.read(0x00), 0x43E3U);
}

TEST(Pwr, Scale2Allows144Megahertz) {
  test::BenchChip chip;
  Pwr power(chip);
  EXPECT_EQ(power.max_core_mhz(), 168U);
  chip.settings.core = 7;  // 144 MHz
  power.write(0x00, 0);
  EXPECT_EQ(power.max_core_mhz(), 144U);
  power.write(0x00, 0x4000);
  chip.settings.core = 6;
  EXPECT_EQ(test::rejection([&] { power.write(0x00, 0); }),
            "PWR_CR = 0x0 at offset 0x0: scale 2 allows 144 MHz, HCLK is 168 MHz");
}

TEST(Pwr, RejectsWhatItDoesNotModelByName) {
  test::BenchChip chip;
  Pwr power(chip);
  EXPECT_EQ(test::rejection([&] { power.write(0x00, 0x4010); }),
            "PWR_CR = 0x4010 at offset 0x0: the voltage detector is not modelled");
  EXPECT_EQ(test::rejection([&] { power.write(0x04, 0x100); }),
            "PWR_CSR = 0x100 at offset 0x4: wake-up pin and backup regulator are not modelled");
  EXPECT_EQ(test::rejection([&] { power.write(0x08, 1); }), "PWR at offset 0x8 = 0x1: writing it is not modelled");
}

}  // namespace
}  // namespace proleg::sim
