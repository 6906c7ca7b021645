#include "sim/mcu/peripherals/usart.hpp"

#include "support/bench.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t sr = 0x00;
constexpr std::uint32_t dr = 0x04;
constexpr std::uint32_t brr = 0x08;
constexpr std::uint32_t cr1 = 0x0C;
constexpr std::uint32_t cr2 = 0x10;
constexpr std::uint32_t cr3 = 0x14;

constexpr std::uint32_t ore = 1U << 3U;
constexpr std::uint32_t rxne = 1U << 5U;
constexpr std::uint32_t tc = 1U << 6U;
constexpr std::uint32_t txe = 1U << 7U;
constexpr std::uint32_t on = 0x200C;  ///< UE, TE, RE

class UsartTest : public testing::Test {
 protected:
  UsartTest() { chip.settings = test::full_speed; }

  /// On, and done with the idle frame.
  void start(std::uint32_t divider = 42, std::uint32_t control = on) {
    port.write(brr, divider);
    port.write(cr1, control);
    chip.run_until(port.next_event(), port);
    begin = chip.time;
  }

  test::BenchChip chip;
  test::BenchBoard board;
  Usart port{chip, board};
  LocalTime begin = 0;
};

// RM0090 rev 21, 30.6.
TEST_F(UsartTest, ResetValuesAreThoseOfTheManual) {
  start();
  port.write(dr, 1);
  port.reset();
  test::expect_values(port, {{sr, 0xC0}, {dr, 0}, {brr, 0}, {cr1, 0}, {cr2, 0}, {cr3, 0}, {0x18, 0}});
  EXPECT_EQ(port.next_event(), never_on_chip);
}

// Baud rate: fck / (16 USARTDIV), with 4 bits of fraction, or fck / (8 USARTDIV), with 3 (RM0090, 30.3.4).
TEST_F(UsartTest, AByteTakesTenBitsOfTheBaudRate) {
  struct Row {
    std::uint32_t divider;
    bool over8;
    LocalTime clocks;  ///< of PCLK1, 24 units each
  };
  const std::vector<Row> rows = {{42, false, 42},  {0x16D, false, 0x16D}, {0xFFFF, false, 0xFFFF},    {16, false, 16},
                                 {0x52, true, 42}, {0x10, true, 8},       {0x2D5, true, 0x2D * 8 + 5}};
  for (const Row& row : rows) {
    port.reset();
    board.sent.clear();
    start(row.divider, on | (row.over8 ? 0x8000U : 0U));
    EXPECT_EQ(port.bit_time(), row.clocks * 24);
    port.write(dr, 0xA5);
    const LocalTime end = begin + 10 * row.clocks * 24;
    EXPECT_EQ(port.next_event(), end);
    chip.run_until(end - 1, port);
    EXPECT_TRUE(board.sent.empty());
    chip.run_until(end, port);
    EXPECT_EQ(board.sent, (std::vector<std::pair<unsigned, std::uint8_t>>{{2, 0xA5}}));
  }
}

TEST_F(UsartTest, TheTransmitterBeginsWithAnIdleFrame) {
  port.write(brr, 42);
  port.write(cr1, on);
  const LocalTime frame = 10 * 42 * 24;
  port.write(dr, 0x55);
  EXPECT_EQ(port.read(sr) & txe, 0U);
  chip.run_until(frame, port);
  EXPECT_TRUE(board.sent.empty());
  EXPECT_EQ(port.read(sr) & txe, txe);
  chip.run_until(2 * frame, port);
  EXPECT_EQ(board.sent.size(), 1U);
}

TEST_F(UsartTest, BytesFollowEachOtherWithoutGap) {
  start();
  const LocalTime frame = 10 * 42 * 24;
  static_cast<void>(port.read(sr));
  port.write(dr, 1);
  EXPECT_EQ(port.read(sr), txe) << "in the shift register at once";
  port.write(dr, 2);
  EXPECT_EQ(port.read(sr), 0U);
  chip.run_until(begin + frame, port);
  EXPECT_EQ(port.read(sr), txe);
  port.write(dr, 3);
  chip.run_until(begin + 3 * frame - 1, port);
  EXPECT_EQ(board.sent.size(), 2U);
  EXPECT_EQ(port.read(sr), txe);
  chip.run_until(begin + 3 * frame, port);
  EXPECT_EQ(port.read(sr), txe | tc);
  EXPECT_EQ(board.sent, (std::vector<std::pair<unsigned, std::uint8_t>>{{2, 1}, {2, 2}, {2, 3}}));
}

TEST_F(UsartTest, WorksTheSameWhenItIsAdvancedLate) {
  start();
  const LocalTime frame = 10 * 42 * 24;
  port.write(dr, 1);
  port.write(dr, 2);
  chip.time = begin + 10 * frame;
  EXPECT_EQ(port.read(sr), txe | tc);
  EXPECT_EQ(board.sent.size(), 2U);
}

TEST_F(UsartTest, TransmissionCompleteIsClearedByReadAndWriteOrByWritingZero) {
  start();
  port.write(dr, 1);
  EXPECT_EQ(port.read(sr) & tc, tc) << "a write without a read before does not clear it";
  port.write(dr, 2);
  EXPECT_EQ(port.read(sr) & tc, 0U);
  chip.run_until(port.next_event(), port);
  chip.run_until(port.next_event(), port);
  EXPECT_EQ(port.read(sr) & tc, tc);
  port.write(sr, ~tc);
  EXPECT_EQ(port.read(sr) & tc, 0U);
}

TEST_F(UsartTest, InterruptsFollowFlagsAndEnables) {
  start();
  const unsigned line = Usart::interrupt_position;
  EXPECT_EQ(line, 38U);
  EXPECT_FALSE(chip.interrupts.contains(line));
  port.write(cr1, on | 0x80);  // TXEIE
  EXPECT_TRUE(chip.interrupts.contains(line));
  port.write(dr, 1);
  EXPECT_TRUE(chip.interrupts.contains(line));
  port.write(dr, 2);
  EXPECT_FALSE(chip.interrupts.contains(line));
  chip.run_until(port.next_event(), port);
  EXPECT_TRUE(chip.interrupts.contains(line));
  port.write(cr1, on | 0x40);  // TCIE
  static_cast<void>(port.read(sr));
  port.write(dr, 3);
  EXPECT_FALSE(chip.interrupts.contains(line));
  chip.run_until(port.next_event(), port);
  EXPECT_FALSE(chip.interrupts.contains(line));
  chip.run_until(port.next_event(), port);
  EXPECT_TRUE(chip.interrupts.contains(line));
  port.write(cr1, on | 0x20);  // RXNEIE
  EXPECT_FALSE(chip.interrupts.contains(line));
  port.receive(9);
  EXPECT_TRUE(chip.interrupts.contains(line));
  EXPECT_EQ(port.read(dr), 9U);
  EXPECT_FALSE(chip.interrupts.contains(line));
}

TEST_F(UsartTest, AnOverrunKeepsTheOldByte) {
  start();
  port.receive(1);
  port.receive(2);
  EXPECT_EQ(port.read(sr) & (rxne | ore), rxne | ore);
  EXPECT_EQ(port.read(dr), 1U);
  EXPECT_EQ(port.read(sr) & (rxne | ore), 0U);
  port.receive(3);
  EXPECT_EQ(port.read(dr), 3U);
}

TEST_F(UsartTest, OverrunIsClearedOnlyByReadingStatusThenData) {
  start(42, on | 0x20);
  port.receive(1);
  port.receive(2);
  EXPECT_EQ(port.read(dr), 1U);
  EXPECT_EQ(port.read(sr) & (rxne | ore), ore);
  EXPECT_TRUE(chip.interrupts.contains(38)) << "ORE interrupts with RXNEIE";
  static_cast<void>(port.read(dr));
  EXPECT_EQ(port.read(sr) & ore, 0U);
  EXPECT_FALSE(chip.interrupts.contains(38));
}

TEST_F(UsartTest, AReceiverThatIsOffReceivesNothing) {
  start(42, 0x2008);
  port.receive(1);
  EXPECT_EQ(port.read(sr) & rxne, 0U);
}

TEST_F(UsartTest, RejectsWhatItDoesNotModelByName) {
  EXPECT_EQ(test::rejection([&] { port.write(cr3, 0x40); }),
            "USART2_CR3 = 0x40 at offset 0x14: DMA, flow control, half duplex, IrDA and smartcards are not modelled");
  EXPECT_NE(test::rejection([&] { port.write(cr2, 0x2000); }), "");
  EXPECT_NE(test::rejection([&] { port.write(cr1, 0x1000); }), "");
  EXPECT_NE(test::rejection([&] { port.write(cr1, 0x0400); }), "");
  EXPECT_EQ(test::rejection([&] { port.write(cr1, on); }), "USART2_CR1 = 0x200C at offset 0xC: USARTDIV is below 1");
  EXPECT_EQ(test::rejection([&] { port.write(dr, 1); }), "USART2_DR = 0x1 at offset 0x4: UE or TE is off");
  start();
  port.write(dr, 1);
  EXPECT_NE(test::rejection([&] { port.write(brr, 43); }), "");
  EXPECT_NE(test::rejection([&] { port.write(cr1, 0); }), "");
  EXPECT_NE(test::rejection([&] { port.clocks_change(Clocks{}); }), "");
}

}  // namespace
}  // namespace proleg::sim
