#include "sim/mcu/peripherals/adc.hpp"

#include <cmath>
#include <random>

#include "sim/mcu/peripherals/chip_identity.hpp"
#include "support/bench.hpp"

namespace proleg::sim {
namespace {

class AdcTest : public testing::Test {
 protected:
  static constexpr std::uint32_t sr = 0x00;
  static constexpr std::uint32_t cr1 = 0x04;
  static constexpr std::uint32_t cr2 = 0x08;
  static constexpr std::uint32_t smpr1 = 0x0C;
  static constexpr std::uint32_t smpr2 = 0x10;
  static constexpr std::uint32_t sqr1 = 0x2C;
  static constexpr std::uint32_t sqr3 = 0x34;
  static constexpr std::uint32_t jsqr = 0x38;
  static constexpr std::uint32_t jdr1 = 0x3C;
  static constexpr std::uint32_t dr = 0x4C;
  static constexpr std::uint32_t ccr = 0x304;

  static constexpr std::uint32_t eoc = 1U << 1U;
  static constexpr std::uint32_t jeoc = 1U << 2U;
  static constexpr std::uint32_t jstrt = 1U << 3U;
  static constexpr std::uint32_t strt = 1U << 4U;
  static constexpr std::uint32_t ovr = 1U << 5U;
  static constexpr std::uint32_t adon = 1;
  static constexpr std::uint32_t eocs = 1U << 10U;
  static constexpr std::uint32_t swstart = 1U << 30U;
  static constexpr std::uint32_t jswstart = 1U << 22U;
  static constexpr std::uint32_t scan = 1U << 8U;

  static constexpr LocalTime adc_clock = 48;  ///< 84 MHz / 4 = 21 MHz
  static constexpr LocalTime fastest = (3 + 12) * adc_clock;

  AdcTest() {
    chip.settings = test::full_speed;
    for (unsigned channel = 0; channel < 16; ++channel) {
      board.voltages[channel] = 100'000 * (channel + 1);
    }
  }

  void start() {
    adc.write(ccr, 0x0001'0000);  // PCLK2 / 4
    adc.write(cr2, adon);
    chip.time += Adc::stabilisation;
    begin = chip.time;
  }
  [[nodiscard]] static std::uint32_t code_of_channel(unsigned channel) {
    return static_cast<std::uint32_t>(std::lround(0.1 * (channel + 1) / 3.3 * 4096));
  }

  test::BenchChip chip;
  test::BenchBoard board;
  Adc adc{chip, board};
  LocalTime begin = 0;
};

// RM0090 rev 21, 13.13.
TEST_F(AdcTest, ResetValuesAreThoseOfTheManual) {
  start();
  adc.write(smpr1, 0x07FF'FFFF);
  adc.write(0x24, 0);
  adc.write(cr2, adon | swstart);
  adc.reset();
  for (std::uint32_t offset = 0; offset <= dr; offset += 4) {
    EXPECT_EQ(adc.read(offset), offset == 0x24 ? 0xFFFU : 0U) << adc.register_name(offset);
  }
  test::expect_values(adc, {{0x300, 0}, {ccr, 0}, {0x308, 0}});
  EXPECT_EQ(adc.next_event(), never_on_chip);
}

TEST_F(AdcTest, AConversionTakesItsSamplingTimeAndTwelveClocks) {
  const std::vector<LocalTime> cycles = {3, 15, 28, 56, 84, 112, 144, 480};
  start();
  for (std::uint32_t setting = 0; setting < cycles.size(); ++setting) {
    for (unsigned channel = 0; channel < 16; ++channel) {
      adc.write(channel < 10 ? smpr2 : smpr1, setting << (3 * (channel % 10)));
      adc.write(sqr3, channel);
      const LocalTime now = chip.time;
      adc.write(cr2, adon | swstart);
      EXPECT_EQ(adc.read(cr2), adon);
      EXPECT_EQ(adc.read(sr), strt);
      const LocalTime end = now + (cycles[setting] + 12) * adc_clock;
      EXPECT_EQ(adc.next_event(), end);
      chip.run_until(end - 1, adc);
      EXPECT_EQ(adc.read(sr), strt);
      chip.run_until(end, adc);
      EXPECT_EQ(adc.read(sr), strt | eoc);
      EXPECT_EQ(adc.read(0x300), strt | eoc);
      EXPECT_EQ(adc.read(dr), code_of_channel(channel));
      EXPECT_EQ(adc.read(sr), strt) << "reading DR clears EOC";
      adc.write(sr, 0);
    }
    adc.write(smpr1, 0);
    adc.write(smpr2, 0);
  }
}

TEST_F(AdcTest, TheClockIsPclk2DividedByTwoToEight) {
  chip.settings.apb2 = 63;  // 16 MHz
  start();
  for (std::uint32_t prescaler = 0; prescaler < 4; ++prescaler) {
    adc.write(ccr, prescaler << 16U);
    adc.write(cr2, adon | swstart);
    EXPECT_EQ(adc.next_event(), chip.time + 15 * 63 * 2 * (prescaler + 1));
    chip.run_until(adc.next_event(), adc);
  }
}

TEST_F(AdcTest, VoltagesBecomeCodesOfAnIdealConverter) {
  EXPECT_EQ(adc_code(0), 0U);
  EXPECT_EQ(adc_code(vdda_uv), 4095U);
  EXPECT_EQ(adc_code(vdda_uv / 2), 2048U);
  for (std::uint32_t uv = 0; uv <= vdda_uv; uv += 37) {
    const double exact = uv * 4096.0 / vdda_uv;
    EXPECT_LE(std::abs(std::min(exact, 4095.0) - adc_code(uv)), 0.5) << uv;
  }
}

TEST_F(AdcTest, ASequenceFlagsItsEndOrEachConversion) {
  start();
  adc.write(cr1, scan);
  adc.write(sqr1, 2U << 20U);  // three
  adc.write(sqr3, 4U | 7U << 5U | 2U << 10U);
  adc.write(cr2, adon | swstart);
  chip.run_until(begin + 3 * fastest - 1, adc);
  EXPECT_EQ(adc.read(sr), strt);
  chip.run_until(begin + 3 * fastest, adc);
  EXPECT_EQ(adc.read(sr), strt | eoc);
  EXPECT_EQ(adc.read(dr), code_of_channel(2));

  begin = chip.time;
  adc.write(cr2, adon | eocs | swstart);
  for (const unsigned channel : {4U, 7U, 2U}) {
    chip.run_until(adc.next_event(), adc);
    EXPECT_EQ(adc.read(sr) & eoc, eoc);
    EXPECT_EQ(adc.read(dr), code_of_channel(channel));
  }
  EXPECT_EQ(chip.time, begin + 3 * fastest);
  EXPECT_EQ(adc.next_event(), never_on_chip);
  EXPECT_EQ(adc.read(sr) & ovr, 0U);
}

TEST_F(AdcTest, SixteenConversionsComeFromThreeSequenceRegisters) {
  start();
  std::mt19937 random(16);
  std::vector<unsigned> channels;
  std::array<std::uint32_t, 3> sequence{15U << 20U, 0, 0};
  for (unsigned rank = 0; rank < 16; ++rank) {
    channels.push_back(static_cast<unsigned>(random() % 16));
    sequence[2 - rank / 6] |= channels.back() << (5 * (rank % 6));
  }
  for (unsigned i = 0; i < 3; ++i) {
    adc.write(sqr1 + 4 * i, sequence[i]);
  }
  adc.write(cr1, scan);
  adc.write(cr2, adon | eocs | swstart);
  for (const unsigned channel : channels) {
    chip.run_until(adc.next_event(), adc);
    EXPECT_EQ(adc.read(dr), code_of_channel(channel));
  }
}

TEST_F(AdcTest, UnreadDataIsAnOverrunAndEndsTheSequence) {
  start();
  adc.write(cr1, scan | 1U << 26U);  // OVRIE
  adc.write(sqr1, 3U << 20U);
  adc.write(sqr3, 1U | 2U << 5U | 3U << 10U | 4U << 15U);
  adc.write(cr2, adon | eocs | swstart);
  chip.run_until(begin + 2 * fastest - 1, adc);
  EXPECT_FALSE(chip.interrupts.contains(Adc::interrupt_position));
  chip.run_until(begin + 100 * fastest, adc);
  EXPECT_EQ(adc.read(sr), strt | eoc | ovr);
  EXPECT_TRUE(chip.interrupts.contains(Adc::interrupt_position));
  EXPECT_EQ(adc.read(dr), code_of_channel(1));
  EXPECT_EQ(adc.next_event(), never_on_chip);
  adc.write(cr2, adon | eocs | swstart);
  EXPECT_EQ(adc.next_event(), never_on_chip) << "starts are ignored while OVR is set";
  adc.write(sr, ~ovr);
  adc.write(cr2, adon | eocs | swstart);
  EXPECT_NE(adc.next_event(), never_on_chip);
}

// RM0090, note on JL in 13.13.12.
TEST_F(AdcTest, TheInjectedGroupEndsWithJsq4) {
  start();
  adc.write(cr1, scan | 1U << 7U);  // JEOCIE
  const std::uint32_t channels = 1U | 2U << 5U | 3U << 10U | 4U << 15U;
  for (std::uint32_t length = 1; length <= 4; ++length) {
    adc.write(jsqr, channels | (length - 1) << 20U);
    const LocalTime now = chip.time;
    adc.write(cr2, adon | jswstart);
    EXPECT_EQ(adc.read(sr), jstrt);
    chip.run_until(now + length * fastest - 1, adc);
    EXPECT_FALSE(chip.interrupts.contains(18));
    chip.run_until(now + length * fastest, adc);
    EXPECT_TRUE(chip.interrupts.contains(18));
    EXPECT_EQ(adc.read(sr), jstrt | jeoc);
    for (std::uint32_t rank = 0; rank < length; ++rank) {
      EXPECT_EQ(adc.read(jdr1 + 4 * rank), code_of_channel(4 - length + rank + 1));
    }
    adc.write(sr, 0);
    EXPECT_FALSE(chip.interrupts.contains(18));
  }
}

TEST_F(AdcTest, OffsetsAreSubtractedFromInjectedData) {
  start();
  adc.write(0x14, 4095);
  adc.write(jsqr, 3U << 15U);
  adc.write(cr2, adon | jswstart);
  chip.run_until(adc.next_event(), adc);
  EXPECT_EQ(adc.read(jdr1), (code_of_channel(3) - 4095) & 0xFFFFU);
}

TEST_F(AdcTest, AnInjectedGroupInterruptsTheRegularOne) {
  start();
  adc.write(cr1, scan);
  adc.write(sqr1, 1U << 20U);
  adc.write(sqr3, 5U | 6U << 5U);
  adc.write(jsqr, 3U << 15U);
  adc.write(cr2, adon | swstart);
  chip.time = begin + fastest + 5 * adc_clock;  // in the second conversion
  adc.write(cr2, adon | jswstart);
  EXPECT_EQ(adc.next_event(), chip.time + fastest);
  chip.run_until(chip.time + fastest, adc);
  EXPECT_EQ(adc.read(sr), strt | jstrt | jeoc);
  // The conversion that was interrupted is done again.
  chip.run_until(chip.time + fastest - 1, adc);
  EXPECT_EQ(adc.read(sr) & eoc, 0U);
  chip.run_until(chip.time + 1, adc);
  EXPECT_EQ(adc.read(sr) & eoc, eoc);
  EXPECT_EQ(adc.read(dr), code_of_channel(6));
}

TEST_F(AdcTest, ARegularGroupWaitsForTheInjectedOne) {
  start();
  adc.write(sqr3, 5);
  adc.write(jsqr, 3U << 15U);
  adc.write(cr2, adon | jswstart);
  adc.write(cr2, adon | swstart);
  chip.run_until(begin + 2 * fastest, adc);
  EXPECT_EQ(adc.read(dr), code_of_channel(5));
  EXPECT_EQ(adc.next_event(), never_on_chip);
}

TEST_F(AdcTest, TemperatureFollowsFromTheFactoryCalibration) {
  start();
  adc.write(ccr, 0x0081'0000);  // TSVREFE
  adc.write(smpr1, 7U << 18U | 7U << 21U);
  chip.time += Adc::sensor_start;
  adc.write(sqr3, 16);
  for (std::int32_t celsius = -40; celsius <= 125; celsius += 5) {
    board.temperature = 1000 * celsius;
    adc.write(cr2, adon | swstart);
    chip.run_until(adc.next_event(), adc);
    const double code = adc.read(dr);
    const double measured = 80.0 / (ts_cal2 - ts_cal1) * (code - ts_cal1) + 30;
    EXPECT_NEAR(measured, celsius, 0.6);
    EXPECT_NEAR((code * 3.3 / 4096 - 0.76) / 0.0025 + 25, celsius, 0.2);
  }
  adc.write(sqr3, 17);
  adc.write(cr2, adon | swstart);
  chip.run_until(adc.next_event(), adc);
  EXPECT_EQ(adc.read(dr), vrefin_cal);
}

TEST_F(AdcTest, SwitchingOffEndsAConversion) {
  start();
  adc.write(cr2, adon | swstart);
  adc.write(cr2, 0);
  EXPECT_EQ(adc.next_event(), never_on_chip);
}

TEST_F(AdcTest, RejectsWhatTheDatasheetForbids) {
  EXPECT_EQ(test::rejection([&] { adc.write(cr2, swstart); }),
            "ADC1_CR2 = 0x40000000 at offset 0x8: a start without ADON");
  adc.write(cr2, adon);
  chip.time += Adc::stabilisation - 1;
  EXPECT_EQ(test::rejection([&] { adc.write(cr2, adon | swstart); }),
            "ADC1_CR2 = 0x40000001 at offset 0x8: a start earlier than 3 us after ADON");
  chip.time += 1;
  EXPECT_EQ(test::rejection([&] { adc.write(cr2, adon | swstart); }),
            "ADC1_CR2 = 0x40000001 at offset 0x8: ADCCLK of 42000 kHz: expected 600 to 36000 kHz");
  adc.write(ccr, 0x0001'0000);
  adc.write(sqr3, 16);
  EXPECT_NE(test::rejection([&] { adc.write(cr2, adon | swstart); }).find("without TSVREFE"), std::string::npos);
  adc.write(ccr, 0x0081'0000);
  EXPECT_NE(test::rejection([&] { adc.write(cr2, adon | swstart); }).find("10 us after TSVREFE"), std::string::npos);
  chip.time += Adc::sensor_start;
  adc.write(smpr1, 6U << 18U);
  EXPECT_NE(test::rejection([&] { adc.write(cr2, adon | swstart); }).find("less than 10 us"), std::string::npos);
  adc.write(sqr3, 18);
  EXPECT_NE(test::rejection([&] { adc.write(cr2, adon | swstart); }).find("channel 18"), std::string::npos);
  adc.write(sqr3, 0);
  adc.write(sqr1, 1U << 20U);
  EXPECT_NE(test::rejection([&] { adc.write(cr2, adon | swstart); }).find("without SCAN"), std::string::npos);
}

TEST_F(AdcTest, RejectsWhatItDoesNotModelByName) {
  EXPECT_EQ(test::rejection([&] { adc.write(cr2, 0x100); }),
            "ADC1_CR2 = 0x100 at offset 0x8: DMA is modelled with DDS = 1 only");
  for (const std::uint32_t value : {1U << 1U, 1U << 11U, 1U << 20U, 1U << 28U}) {
    EXPECT_NE(test::rejection([&] { adc.write(cr2, value); }), "") << value;
  }
  for (const std::uint32_t value : {1U << 10U, 1U << 11U, 1U << 12U, 1U << 22U, 1U << 23U, 1U << 24U}) {
    EXPECT_NE(test::rejection([&] { adc.write(cr1, value); }), "") << value;
  }
  EXPECT_EQ(test::rejection([&] { adc.write(ccr, 6); }),
            "ADC_CCR = 0x6 at offset 0x304: several ADCs together are not modelled");
  EXPECT_EQ(test::rejection([&] { static_cast<void>(adc.read(0x104)); }),
            "ADC2 at offset 0x4: reading it is not modelled");
  EXPECT_EQ(test::rejection([&] { static_cast<void>(adc.read(0x50)); }),
            "ADC1 at offset 0x50: reading it is not modelled");
}

}  // namespace
}  // namespace proleg::sim
