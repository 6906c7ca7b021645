#include "sim/mcu/peripherals/dma.hpp"

#include "sim/mcu/peripherals/adc.hpp"
#include "sim/mcu/peripherals/timer.hpp"
#include "support/bench.hpp"

namespace proleg::sim {
namespace {

// RM0090 rev 21, 10.5.
constexpr std::uint32_t lisr = 0x00;
constexpr std::uint32_t lifcr = 0x08;
constexpr std::uint32_t s0cr = 0x10;
constexpr std::uint32_t s0ndtr = 0x14;
constexpr std::uint32_t s0par = 0x18;
constexpr std::uint32_t s0m0ar = 0x1C;
constexpr std::uint32_t enabled = 0x2D01;  ///< EN, CIRC, MINC, 16 bits on both sides
constexpr std::uint32_t adc1_dr = 0x4001'204C;
constexpr std::uint32_t buffer = 0x2000'1000;

class DmaTest : public testing::Test {
 protected:
  void enable(std::uint32_t count) {
    dma.write(s0par, adc1_dr);
    dma.write(s0m0ar, buffer);
    dma.write(s0ndtr, count);
    dma.write(s0cr, enabled);
  }

  test::BenchChip chip;
  std::vector<std::pair<std::uint32_t, unsigned>> written;
  Dma dma{chip, [this](std::uint32_t address, std::span<const std::uint8_t> bytes) {
            ASSERT_EQ(bytes.size(), 2U);
            written.emplace_back(address, bytes[0] | unsigned{bytes[1]} << 8U);
          }};
};

TEST_F(DmaTest, ResetValuesAreThoseOfTheManual) {
  enable(3);
  dma.reset();
  test::expect_values(dma, {{lisr, 0}, {0x04, 0}, {s0cr, 0}, {s0ndtr, 0}, {s0par, 0}, {s0m0ar, 0}, {0x24, 0x21}});
}

TEST_F(DmaTest, WritesHalfwordsInACircleAndCountsDown) {
  EXPECT_FALSE(dma.transfer(1)) << "off";
  enable(4);
  std::vector<std::uint32_t> counts;
  for (const std::uint16_t data : std::array<std::uint16_t, 5>{0x111, 0x222, 0x333, 0x444, 0x555}) {
    EXPECT_TRUE(dma.transfer(data));
    counts.push_back(dma.read(s0ndtr));
  }
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{3, 2, 1, 4, 3}));
  EXPECT_EQ(written,
            (std::vector<std::pair<std::uint32_t, unsigned>>{
                {buffer, 0x111}, {buffer + 2, 0x222}, {buffer + 4, 0x333}, {buffer + 6, 0x444}, {buffer, 0x555}}));
  EXPECT_EQ(dma.read(lisr), 0x30U) << "half and whole";
  dma.write(lifcr, 0x30);
  EXPECT_EQ(dma.read(lisr), 0U);
}

TEST_F(DmaTest, RejectsWhatItDoesNotModelByName) {
  enable(4);
  EXPECT_EQ(test::rejection([&] { dma.write(s0ndtr, 5); }),
            "DMA2_S0NDTR = 0x5 at offset 0x14: the stream is enabled (RM0090, 10.5)");
  dma.write(s0cr, 0);
  EXPECT_NE(test::rejection([&] { dma.write(s0cr, enabled | 1U << 4U); }), "") << "interrupt";
  EXPECT_NE(test::rejection([&] { dma.write(s0cr, enabled | 1U << 25U); }), "") << "channel 1";
  EXPECT_NE(test::rejection([&] { dma.write(0x28, 1); }), "") << "stream 1";
  dma.write(s0m0ar, 0x2002'0000);
  EXPECT_NE(test::rejection([&] { dma.write(s0cr, enabled); }), "") << "beyond the RAM";
}

/// TIM3 starts conversions, whose results DMA writes.
TEST_F(DmaTest, TakesTheConversionsThatTheTimerStarts) {
  chip.settings = test::full_speed;
  test::BenchBoard board;
  board.voltages[5] = 1'650'000;
  Adc adc(chip, board, &dma);
  Timer timer(chip, 3);
  timer.set_trigger_output([&] { adc.trigger(); });
  enable(8);
  adc.write(0x304, 1U << 16U);  // PCLK2 / 4
  adc.write(0x34, 5);
  // ADON, DMA, DDS, EXTSEL = TIM3_TRGO, EXTEN = rising edge (13.13.3, table 68).
  adc.write(0x08, 0x1800'0301);
  timer.write(0x28, 83);
  timer.write(0x2C, 238);
  timer.write(0x14, 1);
  timer.write(0x04, 0x20);
  timer.write(0x00, 1);
  const LocalTime start = chip.time;
  while (written.size() < 5) {
    chip.time = std::min(timer.next_event(), adc.next_event());
    timer.advance();
    adc.advance();
  }
  // The counter starts one clock after CEN; a conversion takes 15 ADC clocks of 48.
  EXPECT_EQ(chip.time, start + 12 + 5 * 239 * local_time_per_us + 15 * 48);
  EXPECT_EQ(written.back(), (std::pair{buffer + 8, 2'048U}));
  EXPECT_EQ(adc.read(0x00) & 0x22U, 0U) << "no EOC: DMA has read DR; no overrun";
  dma.write(s0cr, 0);
  for (unsigned i = 0; i < 4; ++i) {
    chip.time = std::min(timer.next_event(), adc.next_event());
    timer.advance();
    adc.advance();
  }
  EXPECT_EQ(adc.read(0x00) & 0x20U, 0x20U) << "overrun without DMA (13.8.1)";
}

TEST(Timer3, Counts16Bits) {
  test::BenchChip chip;
  Timer timer(chip, 3);
  EXPECT_EQ(timer.name(), "TIM3");
  EXPECT_EQ(timer.base(), 0x4000'0400U);
  EXPECT_EQ(timer.read(0x2C), 0xFFFFU);
  timer.write(0x2C, 0x1'0005);
  EXPECT_EQ(timer.read(0x2C), 5U);
  EXPECT_NE(test::rejection([&] { timer.write(0x04, 0x20); }), "") << "nothing is connected";
}

}  // namespace
}  // namespace proleg::sim
