#include "sim/mcu/peripherals/usart.hpp"

#include "support/bench.hpp"

namespace proleg::sim {
namespace {

class UsartTest : public testing::Test {
 protected:
  static constexpr std::uint32_t sr = 0x00;
  static constexpr std::uint32_t dr = 0x04;
  static constexpr std::uint32_t brr = 0x08;
  static constexpr std::uint32_t cr1 = 0x0C;
  static constexpr std::uint32_t cr2 = 0x10;
  static constexpr std::uint32_t cr3 = 0x14;

  static constexpr std::uint32_t ore = 1U << 3U;
  static constexpr std::uint32_t rxne = 1U << 5U;
  static constexpr std::uint32_t tc = 1U << 6U;
  static constexpr std::uint32_t txe = 1U << 7U;
  static constexpr std::uint32_t on = 0x200C;  ///< UE, TE, RE

  UsartTest() { chip.settings = test::full_speed; }

  /// A character of the same baud rate, from now to the end of its stop bit.
  void receive(std::uint8_t byte) {
    port.begin_receive(chip.time, {byte}, *port.bit_time());
    const LocalTime end = chip.time + 10 * *port.bit_time();
    while (port.next_event() < end) {
      chip.time = port.next_event();
      port.advance();
    }
    chip.time = end;
  }

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
  receive(9);
  EXPECT_TRUE(chip.interrupts.contains(line));
  EXPECT_EQ(port.read(dr), 9U);
  EXPECT_FALSE(chip.interrupts.contains(line));
}

TEST_F(UsartTest, AnOverrunKeepsTheOldByte) {
  start();
  receive(1);
  receive(2);
  EXPECT_EQ(port.read(sr) & (rxne | ore), rxne | ore);
  EXPECT_EQ(port.read(dr), 1U);
  EXPECT_EQ(port.read(sr) & (rxne | ore), 0U);
  receive(3);
  EXPECT_EQ(port.read(dr), 3U);
}

TEST_F(UsartTest, OverrunIsClearedOnlyByReadingStatusThenData) {
  start(42, on | 0x20);
  receive(1);
  receive(2);
  EXPECT_EQ(port.read(dr), 1U);
  EXPECT_EQ(port.read(sr) & (rxne | ore), ore);
  EXPECT_TRUE(chip.interrupts.contains(38)) << "ORE interrupts with RXNEIE";
  static_cast<void>(port.read(dr));
  EXPECT_EQ(port.read(sr) & ore, 0U);
  EXPECT_FALSE(chip.interrupts.contains(38));
}

TEST_F(UsartTest, AReceiverThatIsOffReceivesNothing) {
  start(42, 0x2008);
  receive(1);
  EXPECT_EQ(port.read(sr) & rxne, 0U);
}

// RM0090, 30.6.1 and 30.6.4: IDLE (bit 4), IDLEIE.
TEST_F(UsartTest, FindsAnIdleLineOnceAfterTheLastCharacter) {
  constexpr std::uint32_t idle = 1U << 4U;
  constexpr LocalTime character = 10 * 42 * 24;
  start(42, on | idle);  // IDLEIE has the same position in CR1
  chip.run_until(begin + 20 * character, port);
  EXPECT_EQ(port.read(sr) & idle, 0U) << "nothing was received";
  receive(1);
  EXPECT_EQ(port.read(dr), 1U);
  receive(2);
  EXPECT_EQ(port.read(dr), 2U);
  EXPECT_EQ(port.read(sr) & idle, 0U);
  chip.run_until(chip.time + character, port);
  EXPECT_TRUE(chip.interrupts.contains(38));
  EXPECT_EQ(port.read(sr) & idle, idle);
  static_cast<void>(port.read(dr));
  EXPECT_EQ(port.read(sr) & idle, 0U);
  EXPECT_FALSE(chip.interrupts.contains(38));
  chip.run_until(chip.time + 20 * character, port);
  EXPECT_EQ(port.read(sr) & idle, 0U) << "once";
}

TEST_F(UsartTest, AMissingStopBitIsAFramingError) {
  constexpr std::uint32_t fe = 1U << 1U;
  start();
  port.begin_receive(chip.time, {0xFF, false}, *port.bit_time());
  chip.run_until(chip.time + 10 * *port.bit_time(), port);
  EXPECT_EQ(port.read(sr) & (rxne | fe), rxne | fe);
  EXPECT_EQ(port.read(dr), 0xFFU);
  EXPECT_EQ(port.read(sr) & fe, 0U);
}

TEST_F(UsartTest, DmaReceivesWithoutTheCpuAndEieReportsErrors) {
  std::vector<unsigned> written;
  Dma dma{chip, 1, {{}, [&](std::uint32_t, std::span<const std::uint8_t> bytes) { written.push_back(bytes[0]); }}};
  Usart by_dma{chip, board, &dma};
  by_dma.write(brr, 42);
  by_dma.write(cr3, 0x41);  // DMAR, EIE
  by_dma.write(cr1, on);
  dma.write(0x90, 0x4000'4404);
  dma.write(0x94, 0x2000'0000);
  dma.write(0x8C, 8);
  dma.write(0x88, 4U << 25U | 1U << 10U | 1U << 8U | 1U);
  const LocalTime bit = *by_dma.bit_time();
  for (const std::uint8_t byte : std::array<std::uint8_t, 3>{11, 12, 13}) {
    by_dma.begin_receive(chip.time, {byte}, bit);
    chip.run_until(chip.time + 10 * bit, by_dma);
  }
  EXPECT_EQ(written, (std::vector<unsigned>{11, 12, 13}));
  EXPECT_EQ(by_dma.read(sr) & (rxne | ore), 0U);
  EXPECT_FALSE(chip.interrupts.contains(38));
  by_dma.begin_receive(chip.time, {14, false}, bit);
  chip.run_until(chip.time + 10 * bit, by_dma);
  EXPECT_EQ(written.back(), 14U);
  EXPECT_TRUE(chip.interrupts.contains(38)) << "framing error";
}

TEST_F(UsartTest, DmaSendsWithoutGap) {
  Dma dma{chip,
          1,
          {[&](std::uint32_t address, std::span<std::uint8_t> bytes) { bytes[0] = static_cast<std::uint8_t>(address); },
           {}}};
  Usart by_dma{chip, board, &dma};
  std::vector<LocalTime> ends;
  by_dma.watch_output([&](LocalTime end, std::uint8_t) { ends.push_back(end); });
  by_dma.write(brr, 42);
  by_dma.write(cr1, on);
  by_dma.write(cr3, 0x80);  // DMAT
  const LocalTime character = 10 * *by_dma.bit_time();
  chip.run_until(character, by_dma);
  dma.write(0xA8, 0x4000'4404);
  dma.write(0xAC, 0x2000'0020);
  dma.write(0xA4, 4);
  dma.write(0xA0, 4U << 25U | 1U << 10U | 1U << 6U | 1U << 4U | 1U);
  chip.run_until(4 * character, by_dma);
  EXPECT_TRUE(chip.interrupts.contains(17)) << "the last byte is in the data register or beyond";
  EXPECT_EQ(board.sent.size(), 3U);
  chip.run_until(6 * character, by_dma);
  EXPECT_EQ(board.sent, (std::vector<std::pair<unsigned, std::uint8_t>>{{2, 0x20}, {2, 0x21}, {2, 0x22}, {2, 0x23}}));
  EXPECT_EQ(ends, (std::vector<LocalTime>{2 * character, 3 * character, 4 * character, 5 * character}));
}

TEST_F(UsartTest, RejectsWhatItDoesNotModelByName) {
  EXPECT_EQ(test::rejection([&] { port.write(cr3, 0x100); }),
            "USART2_CR3 = 0x100 at offset 0x14: flow control, half duplex, IrDA and smartcards are not modelled");
  EXPECT_EQ(test::rejection([&] { port.write(cr3, 0x40); }),
            "USART2_CR3 = 0x40 at offset 0x14: DMA is not modelled here");
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
