#include "sim/mcu/peripherals/pwr.hpp"

#include "sim/mcu/peripherals/exti.hpp"
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
  power.write(0x00, 0xFFFF'FFFF);
  EXPECT_EQ(power.read(0x00), 0x43F3U);
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

class VoltageDetector : public testing::Test {
 protected:
  // RM0090, 5.4.1 and 12.3.
  static constexpr std::uint32_t cr = 0x00;
  static constexpr std::uint32_t csr = 0x04;
  static constexpr std::uint32_t pvde = 1U << 4U;
  static constexpr std::uint32_t pvdo = 1U << 2U;
  static constexpr std::uint32_t imr = 0x00;
  static constexpr std::uint32_t rtsr = 0x08;
  static constexpr std::uint32_t ftsr = 0x0C;
  static constexpr std::uint32_t pr = 0x14;
  static constexpr std::uint32_t line = 1U << 16U;

  void enable(std::uint32_t level) { power.write(cr, 0x4000 | level << 5U | pvde); }
  [[nodiscard]] bool is_low() { return (power.read(csr) & pvdo) != 0; }

  test::BenchChip chip;
  Exti exti{chip};
  Pwr power{chip, &exti};
};

TEST_F(VoltageDetector, ComparesWithItsThresholdAndItsHysteresis) {
  power.set_supply(2'000);
  EXPECT_FALSE(is_low()) << "it is off";
  // DS8626, embedded reset and power control block: typical thresholds.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> thresholds = {
      {2'040, 2'140}, {2'190, 2'300}, {2'350, 2'450}, {2'510, 2'600},
      {2'660, 2'760}, {2'820, 2'930}, {2'930, 3'030}, {3'030, 3'140}};
  for (std::uint32_t level = 0; level < thresholds.size(); ++level) {
    power.set_supply(3'300);
    enable(level);
    power.set_supply(thresholds[level].first);
    EXPECT_FALSE(is_low());
    power.set_supply(thresholds[level].first - 1);
    EXPECT_TRUE(is_low());
    power.set_supply(thresholds[level].second - 1);
    EXPECT_TRUE(is_low());
    power.set_supply(thresholds[level].second);
    EXPECT_FALSE(is_low());
  }
}

TEST_F(VoltageDetector, InterruptsByLine16OnTheEdgesThatAreEnabled) {
  enable(6);
  exti.write(rtsr, line);
  power.set_supply(2'900);
  EXPECT_EQ(exti.read(pr), line);
  EXPECT_TRUE(chip.interrupts.empty()) << "masked";
  exti.write(imr, line);
  EXPECT_EQ(chip.interrupts, std::set<unsigned>{1});
  exti.write(pr, line);
  EXPECT_TRUE(chip.interrupts.empty());
  power.set_supply(3'300);
  EXPECT_EQ(exti.read(pr), 0U) << "a falling edge";
  exti.write(ftsr, line);
  power.set_supply(2'900);
  exti.write(pr, line);
  power.set_supply(3'300);
  EXPECT_EQ(exti.read(pr), line);
  EXPECT_EQ(chip.interrupts, std::set<unsigned>{1});
  exti.reset();
  EXPECT_TRUE(chip.interrupts.empty());
  test::expect_values(exti, {{imr, 0}, {0x04, 0}, {rtsr, 0}, {ftsr, 0}, {0x10, 0}, {pr, 0}});
}

TEST_F(VoltageDetector, OtherLinesAreNotModelled) {
  EXPECT_EQ(test::rejection([&] { exti.write(imr, 1); }),
            "EXTI_IMR = 0x1 at offset 0x0: only line 16, the voltage detector, is modelled");
  EXPECT_NE(test::rejection([&] { exti.write(0x10, line); }), "");
  EXPECT_NE(test::rejection([&] { static_cast<void>(exti.read(0x18)); }), "");
}

TEST(Pwr, RejectsWhatItDoesNotModelByName) {
  test::BenchChip chip;
  Pwr power(chip);
  EXPECT_EQ(test::rejection([&] { power.write(0x04, 0x100); }),
            "PWR_CSR = 0x100 at offset 0x4: wake-up pin and backup regulator are not modelled");
  EXPECT_EQ(test::rejection([&] { power.write(0x08, 1); }), "PWR at offset 0x8 = 0x1: writing it is not modelled");
}

}  // namespace
}  // namespace proleg::sim
