#include "sim/mcu/peripherals/rcc.hpp"

#include <memory>
#include <random>

#include "sim/mcu/peripherals/gpio.hpp"
#include "sim/mcu/peripherals/timer.hpp"
#include "sim/mcu/peripherals/usart.hpp"
#include "support/bench.hpp"

namespace proleg::sim {
namespace {

class NoCells final : public FlashMemory {
 public:
  void read(std::uint32_t /*address*/, std::span<std::uint8_t> /*bytes*/) override {}
  void write(std::uint32_t /*address*/, std::span<const std::uint8_t> /*bytes*/) override {}
};

struct Pll {
  std::uint32_t m, n, p, q = 7;
  bool hse = true;

  [[nodiscard]] std::uint32_t value() const {
    return m | n << 6U | (p / 2 - 1) << 16U | (hse ? 1U << 22U : 0U) | q << 24U;
  }
};

class RccTest : public testing::Test {
 protected:
  static constexpr std::uint32_t cr = 0x00;
  static constexpr std::uint32_t pllcfgr = 0x04;
  static constexpr std::uint32_t cfgr = 0x08;
  static constexpr std::uint32_t ahb1enr = 0x30;
  static constexpr std::uint32_t apb1rstr = 0x20;
  static constexpr std::uint32_t apb1enr = 0x40;
  static constexpr std::uint32_t csr = 0x74;
  static constexpr std::uint32_t hsion = 0x81;
  static constexpr std::uint32_t hseon = 1U << 16U;
  static constexpr std::uint32_t hserdy = 1U << 17U;
  static constexpr std::uint32_t pllon = 1U << 24U;
  static constexpr std::uint32_t pllrdy = 1U << 25U;
  static constexpr LocalTime us = local_time_per_us;

  RccTest() {
    chip.clock_source = &rcc.clocks();
    for (Peripheral* peripheral : std::initializer_list<Peripheral*>{&timer, &port, &usart, &power}) {
      rcc.attach(*peripheral);
    }
  }

  void wait(LocalTime duration) { chip.run_until(chip.time + duration, rcc); }
  void start_hse() {
    rcc.write(cr, hsion | hseon);
    wait(Rcc::hse_start);
  }
  /// PLL on and locked, six wait states.
  void start_pll(const Pll& pll) {
    rcc.write(pllcfgr, pll.value());
    rcc.write(cr, hsion | (pll.hse ? hseon : 0U) | pllon);
    wait(Rcc::pll_start);
    flash.write(0x00, 5);
  }
  void full_speed() {
    start_hse();
    start_pll({.m = 8, .n = 336, .p = 2});
    rcc.write(cfgr, 0x9402);  // APB2 / 2, APB1 / 4, PLL
  }

  test::BenchChip chip;
  test::BenchBoard board;
  NoCells cells;
  FlashInterface flash{chip, cells};
  Pwr power{chip};
  Iwdg dog{chip};
  Rcc rcc{chip, flash, power, dog};
  Timer timer{chip, 2};
  Gpio port{chip, board, 'A'};
  Usart usart{chip, board};
};

bool equal(const Clocks& a, const Clocks& b) {
  return a.core == b.core && a.apb1 == b.apb1 && a.apb2 == b.apb2 && a.apb1_timers == b.apb1_timers &&
         a.apb2_timers == b.apb2_timers;
}

// RM0090 rev 21, 7.3. RCC_CR: the calibration in bits 8 to 15 differs from chip to chip.
TEST_F(RccTest, ResetValuesAreThoseOfTheManual) {
  const std::vector<test::ResetValue> table = {
      {0x04, 0x2400'3010}, {0x08, 0},           {0x0C, 0},           {0x10, 0},           {0x14, 0},
      {0x18, 0},           {0x20, 0},           {0x24, 0},           {0x30, 0x0010'0000}, {0x34, 0},
      {0x38, 0},           {0x40, 0},           {0x44, 0},           {0x50, 0x7E67'91FF}, {0x54, 0x0000'00F1},
      {0x58, 0x0000'0001}, {0x60, 0x36FE'C9FF}, {0x64, 0x0007'5F33}, {0x70, 0},           {0x74, 0x0E00'0000},
      {0x80, 0},           {0x84, 0x2000'3000}};
  rcc.note_start(ResetCause::power_on);
  test::expect_values(rcc, table);
  EXPECT_EQ(rcc.read(cr) & 0xFFFF'00FFU, 0x83U);
  full_speed();
  rcc.write(ahb1enr, 0x1FF);
  rcc.write(apb1rstr, 1);
  flash.reset();
  rcc.reset();
  test::expect_values(rcc, table);
  EXPECT_TRUE(equal(rcc.clocks(), Clocks{}));
}

TEST_F(RccTest, OscillatorsNeedTheirTime) {
  rcc.write(cr, hsion | hseon);
  chip.time = Rcc::hse_start - 1;
  EXPECT_EQ(rcc.read(cr) & (hseon | hserdy), hseon);
  chip.time = Rcc::hse_start;
  EXPECT_EQ(rcc.read(cr) & hserdy, hserdy);
  EXPECT_EQ(Rcc::hse_start, 2'000 * us);
  rcc.write(pllcfgr, Pll{.m = 8, .n = 336, .p = 2}.value());
  rcc.write(cr, hsion | hseon | pllon);
  const LocalTime begin = chip.time;
  chip.time = begin + Rcc::pll_start - 1;
  EXPECT_EQ(rcc.read(cr) & pllrdy, 0U);
  chip.time = begin + Rcc::pll_start;
  EXPECT_EQ(rcc.read(cr) & pllrdy, pllrdy);
  rcc.write(cr, hsion);
  EXPECT_EQ(rcc.read(cr) & (hserdy | pllrdy), hserdy) << "six more cycles of 8 MHz";
  chip.time += 6 * 126;
  EXPECT_EQ(rcc.read(cr) & hserdy, 0U);
}

TEST_F(RccTest, RunsAtFullSpeedAsTheFirmwareSetsIt) {
  full_speed();
  EXPECT_TRUE(equal(rcc.clocks(), test::full_speed));
  EXPECT_EQ(rcc.read(cfgr), 0x940AU);
}

TEST_F(RccTest, AClockThatIsNotReadyTakesOverWhenItIs) {
  rcc.write(cr, hsion | hseon);
  rcc.write(cfgr, 1);
  EXPECT_EQ(rcc.read(cfgr), 1U);
  EXPECT_EQ(rcc.next_event(), Rcc::hse_start);
  chip.run_until(Rcc::hse_start, rcc);
  EXPECT_EQ(rcc.read(cfgr), 5U);
  EXPECT_EQ(rcc.clocks().core, 126U);
}

TEST_F(RccTest, PrescalersDivideAndTimersCountTwiceDividedBuses) {
  const std::vector<std::pair<std::uint32_t, unsigned>> hpre = {{0, 1},   {7, 1},   {8, 2},    {9, 4},    {10, 8},
                                                                {11, 16}, {12, 64}, {13, 128}, {14, 256}, {15, 512}};
  const std::vector<std::pair<std::uint32_t, unsigned>> ppre = {{0, 1}, {3, 1}, {4, 2}, {5, 4}, {6, 8}, {7, 16}};
  for (const auto& [h, core] : hpre) {
    for (const auto& [p1, apb1] : ppre) {
      for (const auto& [p2, apb2] : ppre) {
        rcc.write(cfgr, h << 4U | p1 << 10U | p2 << 13U);
        const LocalTime hclk = LocalTime{63} * core;
        EXPECT_TRUE(equal(rcc.clocks(), {.core = hclk,
                                         .apb1 = hclk * apb1,
                                         .apb2 = hclk * apb2,
                                         .apb1_timers = hclk * (apb1 == 1 ? 1 : apb1 / 2),
                                         .apb2_timers = hclk * (apb2 == 1 ? 1 : apb2 / 2)}));
      }
    }
  }
}

// Every setting of the PLL from 8 MHz against the limits of RM0090, 7.3.2, in whole hertz.
TEST_F(RccTest, ThePllStartsWithinTheLimitsOfTheManualOnly) {
  start_hse();
  unsigned allowed = 0;
  for (std::uint32_t m = 0; m < 64; ++m) {
    for (std::uint32_t n = 0; n < 512; n += n < 60 || n > 420 ? 1 : 7) {
      for (const std::uint32_t p : {2U, 4U, 6U, 8U}) {
        rcc.write(pllcfgr, Pll{.m = m, .n = n, .p = p}.value());
        const std::string rejected = test::rejection([&] { rcc.write(cr, hsion | hseon | pllon); });
        const double in = m == 0 ? 0 : 8.0 / m;
        const double vco = 8.0 * n / (m == 0 ? 1 : m);
        const bool ok =
            m >= 2 && n >= 50 && n <= 432 && in >= 1 && in <= 2 && vco >= 100 && vco <= 432 && 8 * n <= 168 * m * p;
        EXPECT_EQ(rejected.empty(), ok) << m << " " << n << " " << p << " " << rejected;
        allowed += ok ? 1 : 0;
        rcc.write(cr, hsion | hseon);
      }
    }
  }
  EXPECT_GT(allowed, 100U);
}

TEST_F(RccTest, RejectionsByThePllHaveTheFigures) {
  start_hse();
  const auto with = [&](const Pll& pll) {
    rcc.write(pllcfgr, pll.value());
    return test::rejection([&] { rcc.write(cr, hsion | hseon | pllon); });
  };
  EXPECT_EQ(with({.m = 3, .n = 100, .p = 2}),
            "RCC_CR = 0x1010081 at offset 0x0: PLLON with VCO input of 2.666 MHz: expected 1 to 2 MHz (RM0090, 7.3.2)");
  EXPECT_EQ(with({.m = 8, .n = 99, .p = 2}),
            "RCC_CR = 0x1010081 at offset 0x0: PLLON with VCO of 99 MHz: expected 100 to 432 MHz (RM0090, 7.3.2)");
  EXPECT_EQ(with({.m = 4, .n = 170, .p = 2}),
            "RCC_CR = 0x1010081 at offset 0x0: PLLON with output of 170 MHz: expected at most 168 MHz (RM0090, 7.3.2)");
  EXPECT_NE(with({.m = 8, .n = 336, .p = 2, .q = 1}), "");
  rcc.reset();
  rcc.write(pllcfgr, Pll{.m = 8, .n = 336, .p = 2}.value());
  EXPECT_EQ(test::rejection([&] { rcc.write(cr, hsion | hseon | pllon); }),
            "RCC_CR = 0x1010081 at offset 0x0: PLLON while its clock HSE is not ready");
}

TEST_F(RccTest, EachClockThatDivides1008MegahertzIsPossible) {
  // HSI 16 MHz / 16 * n / p.
  for (const auto& [n, p, mhz] : std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>>{
           {336, 2, 168}, {288, 2, 144}, {252, 2, 126}, {224, 2, 112}, {168, 2, 84}, {192, 4, 48}, {336, 8, 42}}) {
    flash.reset();
    rcc.reset();
    start_pll({.m = 16, .n = n, .p = p, .hse = false});
    rcc.write(cfgr, 0x9402);
    EXPECT_EQ(rcc.clocks().core * mhz, local_time_per_us);
  }
  flash.reset();
  rcc.reset();
  start_pll({.m = 16, .n = 200, .p = 2, .hse = false});
  EXPECT_EQ(
      test::rejection([&] { rcc.write(cfgr, 0x9402); }),
      "RCC_CFGR = 0x9402 at offset 0x8: HCLK of 100 MHz does not divide 1008 MHz, in which the model counts time");
}

TEST_F(RccTest, BusesHaveTheirLimits) {
  start_hse();
  start_pll({.m = 8, .n = 336, .p = 2});
  EXPECT_EQ(test::rejection([&] { rcc.write(cfgr, 0x9002); }),
            "RCC_CFGR = 0x9002 at offset 0x8: PCLK1 of 84 MHz: at most 42 MHz (RM0090, 7.3.3)");
  EXPECT_EQ(test::rejection([&] { rcc.write(cfgr, 0x1402); }),
            "RCC_CFGR = 0x1402 at offset 0x8: PCLK2 of 168 MHz: at most 84 MHz (RM0090, 7.3.3)");
  power.write(0x00, 0);
  EXPECT_EQ(test::rejection([&] { rcc.write(cfgr, 0x9402); }),
            "RCC_CFGR = 0x9402 at offset 0x8: HCLK of 168 MHz: at most 144 MHz at this core voltage (PWR_CR.VOS)");
}

TEST_F(RccTest, FlashNeedsItsWaitStatesFirst) {
  start_hse();
  start_pll({.m = 8, .n = 336, .p = 2});
  flash.write(0x00, 4);
  EXPECT_EQ(test::rejection([&] { rcc.write(cfgr, 0x9402); }),
            "RCC_CFGR = 0x9402 at offset 0x8: HCLK of 168 MHz needs 5 wait states, FLASH_ACR has 4 (RM0090, table 10)");
  flash.write(0x00, 5);
  rcc.write(cfgr, 0x9402);
  EXPECT_NE(test::rejection([&] { flash.write(0x00, 0); }), "");
}

TEST_F(RccTest, TheSourcesOfTheSystemClockCannotBeSwitchedOff) {
  full_speed();
  rcc.write(cr, 0x80);
  EXPECT_EQ(rcc.read(cr) & (hseon | pllon), hseon | pllon);
  EXPECT_EQ(rcc.read(cr) & 1U, 0U) << "HSI is not needed";
  EXPECT_NE(test::rejection([&] { rcc.write(pllcfgr, Pll{.m = 8, .n = 200, .p = 2}.value()); }), "");
}

TEST_F(RccTest, ResetFlagsHoldTheCauseUntilRmvf) {
  const auto flags = [&] { return rcc.read(csr) >> 24U; };
  rcc.note_start(ResetCause::power_on);
  EXPECT_EQ(flags(), 0x0EU);
  rcc.write(csr, 1U << 24U);
  EXPECT_EQ(flags(), 0U);
  rcc.note_start(ResetCause::software);
  rcc.reset();
  EXPECT_EQ(flags(), 0x14U);
  rcc.note_start(ResetCause::independent_watchdog);
  rcc.reset();
  EXPECT_EQ(flags(), 0x34U) << "they stay until they are cleared";
  rcc.write(csr, 1U << 24U);
  rcc.note_start(ResetCause::pin);
  EXPECT_EQ(flags(), 0x04U);
  rcc.note_start(ResetCause::power_on);
  EXPECT_EQ(flags(), 0x0EU);
}

TEST_F(RccTest, TheWatchdogKeepsLsiOn) {
  EXPECT_EQ(rcc.read(csr) & 3U, 0U);
  rcc.write(csr, 1);
  EXPECT_EQ(rcc.read(csr) & 3U, 1U);
  chip.time += Rcc::lsi_start;
  EXPECT_EQ(rcc.read(csr) & 3U, 3U);
  rcc.write(csr, 0);
  chip.time += dog.lsi_cycles(3);
  EXPECT_EQ(rcc.read(csr) & 3U, 0U);
  dog.write(0x00, 0xCCCC);
  EXPECT_EQ(rcc.read(csr) & 3U, 2U);
}

TEST_F(RccTest, RegistersAnswerOnlyWithAClock) {
  EXPECT_FALSE(rcc.is_clocked(usart));
  EXPECT_TRUE(rcc.is_clocked(flash));
  EXPECT_TRUE(rcc.is_clocked(dog));
  EXPECT_EQ(test::rejection([&] { rcc.require_clock(usart, 0x08); }),
            "USART2_BRR: its clock is off (RCC_APB1ENR bit 17)");
  EXPECT_EQ(test::rejection([&] { rcc.require_clock(port, 0x14); }), "GPIOA_ODR: its clock is off (RCC_AHB1ENR bit 0)");
  rcc.write(apb1enr, 1U << 17U);
  EXPECT_TRUE(rcc.is_clocked(usart));
  EXPECT_EQ(test::rejection([&] { rcc.require_clock(usart, 0x08); }), "");
  rcc.write(apb1rstr, 1U << 17U);
  EXPECT_EQ(test::rejection([&] { rcc.require_clock(usart, 0x08); }),
            "USART2_BRR: it is held in reset (RCC_APB1RSTR bit 17)");
}

TEST_F(RccTest, ResetBitsResetTheirPeripheral) {
  usart.write(0x08, 42);
  timer.write(0x28, 7);
  rcc.write(apb1rstr, 1U << 17U);
  EXPECT_EQ(usart.read(0x08), 0U);
  EXPECT_EQ(timer.read(0x28), 7U);
  rcc.write(apb1rstr, 0);
  EXPECT_EQ(rcc.read(apb1rstr), 0U);
}

TEST_F(RccTest, ClocksOfBusyPeripheralsStayOn) {
  rcc.write(apb1enr, 1);
  timer.write(0x2C, 100);
  timer.write(0x00, 1);
  EXPECT_EQ(test::rejection([&] { rcc.write(apb1enr, 0); }),
            "RCC_APB1ENR = 0x0 at offset 0x40: the clock of TIM2 goes off while it works, which is not modelled");
  timer.write(0x00, 0);
  rcc.write(apb1enr, 0);
  EXPECT_NE(test::rejection([&] { rcc.write(0x60, 0); }).find("without clock in Sleep mode"), std::string::npos);
}

TEST_F(RccTest, RejectsWhatItDoesNotModelByName) {
  EXPECT_EQ(test::rejection([&] { rcc.write(cr, hsion | 1U << 18U); }),
            "RCC_CR = 0x40081 at offset 0x0: the board has a crystal, no clock to bypass it");
  EXPECT_NE(test::rejection([&] { rcc.write(cr, hsion | 1U << 26U); }), "");
  EXPECT_NE(test::rejection([&] { rcc.write(cr, 0x89); }).find("HSITRIM = 17"), std::string::npos);
  EXPECT_NE(test::rejection([&] { rcc.write(cfgr, 3); }).find("SW = 3"), std::string::npos);
  EXPECT_NE(test::rejection([&] { rcc.write(cfgr, 1U << 21U); }), "");
  EXPECT_NE(test::rejection([&] { rcc.write(0x0C, 1U << 8U); }), "");
  EXPECT_NE(test::rejection([&] { rcc.write(0x70, 1); }), "");
  EXPECT_NE(test::rejection([&] { rcc.write(0x80, 1); }), "");
  EXPECT_NE(test::rejection([&] { rcc.write(0x84, 0); }), "");
  EXPECT_EQ(test::rejection([&] { rcc.write(0x28, 1); }), "RCC at offset 0x28 = 0x1: writing it is not modelled");
}

// RM0090, 7.2.7: the clock security system.

TEST_F(RccTest, ACrystalThatNeverStartsIsNeverReady) {
  rcc.set_crystal(false);
  rcc.write(cr, hsion | hseon);
  wait(1'000 * Rcc::hse_start);
  EXPECT_EQ(rcc.read(cr) & hserdy, 0U);
  rcc.set_crystal(true);
  wait(Rcc::hse_start);
  EXPECT_EQ(rcc.read(cr) & hserdy, hserdy);
}

TEST_F(RccTest, APllThatDoesNotLockIsNeverReadyAndTakesOverLateIfItIsSelected) {
  start_hse();
  rcc.set_pll(false);
  start_pll({.m = 8, .n = 336, .p = 2});
  wait(1'000 * Rcc::pll_start);
  EXPECT_EQ(rcc.read(cr) & pllrdy, 0U);
  rcc.write(cfgr, 0x9402);
  EXPECT_EQ(rcc.read(cfgr), 0x9402U) << "still HSI";
  rcc.set_pll(true);
  wait(Rcc::pll_start);
  EXPECT_EQ(rcc.read(cfgr), 0x940AU);
}

TEST_F(RccTest, WithoutItsSourceTheCoreStandsStillUntilTheSourceIsBack) {
  full_speed();
  rcc.set_crystal(false);
  EXPECT_TRUE(rcc.core_stands_still());
  wait(1'000 * us);
  EXPECT_FALSE(chip.non_maskable);
  rcc.set_crystal(true);
  EXPECT_FALSE(rcc.core_stands_still());
  EXPECT_TRUE(equal(rcc.clocks(), test::full_speed));
}

TEST_F(RccTest, APllThatLosesItsLockRunsOnWithAnotherFrequency) {
  full_speed();
  rcc.set_pll(false);
  EXPECT_FALSE(rcc.core_stands_still());
  EXPECT_EQ(rcc.clocks().core, 8U) << "126 MHz";
  EXPECT_EQ(rcc.clocks().apb1, 32U);
  EXPECT_EQ(rcc.clocks().apb2, 16U);
  EXPECT_EQ(rcc.clocks().apb1_timers, 16U);
  EXPECT_EQ(rcc.read(cr) & pllrdy, 0U);
  EXPECT_EQ(rcc.read(cfgr) & 0xCU, 0x8U) << "SWS: PLL";
  rcc.set_crystal(false);
  EXPECT_TRUE(rcc.core_stands_still());
  rcc.set_crystal(true);
  rcc.set_pll(true);
  EXPECT_TRUE(equal(rcc.clocks(), test::full_speed));
  wait(Rcc::pll_start);
  EXPECT_EQ(rcc.read(cr) & pllrdy, pllrdy);
}

class SecuredClock : public RccTest {
 protected:
  static constexpr std::uint32_t cir = 0x0C;
  static constexpr std::uint32_t csson = 1U << 19U;
  static constexpr std::uint32_t cssf = 1U << 7U;
  static constexpr std::uint32_t cssc = 1U << 23U;

  SecuredClock() {
    full_speed();
    rcc.write(cr, rcc.read(cr) | csson);
  }
};

TEST_F(SecuredClock, IsTheInternalOscillatorAfterAFailureAndNmiIsHighUntilItIsCleared) {
  EXPECT_EQ(rcc.read(cr) & csson, csson);
  EXPECT_EQ(rcc.read(cir), 0U);
  rcc.set_crystal(false);
  EXPECT_TRUE(rcc.core_stands_still());
  wait(Rcc::failure_detection - 1);
  EXPECT_FALSE(chip.non_maskable);
  wait(1);
  EXPECT_TRUE(chip.non_maskable);
  EXPECT_FALSE(rcc.core_stands_still());
  EXPECT_EQ(rcc.read(cr) & (hseon | hserdy | pllon | pllrdy), 0U);
  EXPECT_EQ(rcc.read(cfgr), 0x9400U) << "SW and SWS: HSI; the prescalers stay";
  EXPECT_EQ(rcc.clocks().core, Clocks::hsi);
  EXPECT_EQ(rcc.clocks().apb1, 4 * Clocks::hsi);
  EXPECT_EQ(rcc.read(cir), cssf);
  rcc.write(cir, cssc);
  EXPECT_EQ(rcc.read(cir), 0U);
  EXPECT_FALSE(chip.non_maskable);
}

TEST_F(SecuredClock, EndsWithAReset) {
  rcc.set_crystal(false);
  wait(Rcc::failure_detection);
  flash.reset();
  rcc.reset();
  EXPECT_FALSE(chip.non_maskable);
  EXPECT_EQ(rcc.read(cir), 0U);
  EXPECT_EQ(rcc.read(cr) & csson, 0U);
  rcc.write(cr, hsion | hseon);
  wait(10 * Rcc::hse_start);
  EXPECT_EQ(rcc.read(cr) & hserdy, 0U) << "the crystal is still broken";
}

TEST_F(SecuredClock, DoesNotReactToAPllThatLosesItsLock) {
  rcc.set_pll(false);
  wait(1'000 * us);
  EXPECT_FALSE(chip.non_maskable);
  EXPECT_EQ(rcc.read(cir), 0U);
}

}  // namespace
}  // namespace proleg::sim
