#include "sim/mcu/peripherals/gpio.hpp"

#include <stdexcept>

#include "support/bench.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t moder = 0x00;
constexpr std::uint32_t otyper = 0x04;
constexpr std::uint32_t pupdr = 0x0C;
constexpr std::uint32_t idr = 0x10;
constexpr std::uint32_t odr = 0x14;
constexpr std::uint32_t bsrr = 0x18;

class GpioTest : public testing::Test {
 protected:
  [[nodiscard]] bool input(unsigned pin) { return bit(port.read(idr), pin); }

  test::BenchChip chip;
  test::BenchBoard board;
  Gpio port{chip, board, 'C'};
};

// RM0090 rev 21, 8.4 (port A's OSPEEDR: the text of 8.4.3; table 40 of the same edition has 0).
TEST_F(GpioTest, ResetValuesAreThoseOfTheManual) {
  const std::vector<test::ResetValue> a = {{0x00, 0xA800'0000}, {0x04, 0}, {0x08, 0x0C00'0000},
                                           {0x0C, 0x6400'0000}, {0x14, 0}, {0x18, 0},
                                           {0x1C, 0},           {0x20, 0}, {0x24, 0}};
  const std::vector<test::ResetValue> b = {{0x00, 0x0000'0280}, {0x04, 0}, {0x08, 0x0000'00C0},
                                           {0x0C, 0x0000'0100}, {0x14, 0}, {0x18, 0},
                                           {0x1C, 0},           {0x20, 0}, {0x24, 0}};
  const std::vector<test::ResetValue> others = {{0x00, 0}, {0x04, 0}, {0x08, 0}, {0x0C, 0}, {0x14, 0},
                                                {0x18, 0}, {0x1C, 0}, {0x20, 0}, {0x24, 0}};
  for (char letter = 'A'; letter <= 'I'; ++letter) {
    Gpio any(chip, board, letter);
    EXPECT_EQ(any.base(), 0x4002'0000U + 0x400U * static_cast<unsigned>(letter - 'A'));
    for (const std::uint32_t offset : {0x00U, 0x04U, 0x08U, 0x0CU, 0x14U, 0x20U, 0x24U}) {
      any.write(offset, 0x1111'1111);
    }
    any.reset();
    test::expect_values(any, letter == 'A' ? a : letter == 'B' ? b : others);
  }
}

TEST_F(GpioTest, AnInputHasTheLevelOfTheBoardElseOfItsPull) {
  port.write(pupdr, 0b10'01'00);  // pin 1 up, pin 2 down
  EXPECT_FALSE(input(0));
  EXPECT_TRUE(input(1));
  EXPECT_FALSE(input(2));
  board.pins = {{{'C', 0}, true}, {{'C', 1}, false}, {{'C', 2}, true}, {{'D', 3}, true}};
  EXPECT_TRUE(input(0));
  EXPECT_FALSE(input(1));
  EXPECT_TRUE(input(2));
  EXPECT_FALSE(input(3));
}

TEST_F(GpioTest, APushPullOutputDrivesBothLevels) {
  port.write(moder, 0b01);
  EXPECT_EQ(port.output(0), false);
  EXPECT_FALSE(input(0));
  port.write(odr, 1);
  EXPECT_EQ(port.output(0), true);
  EXPECT_TRUE(input(0));
  EXPECT_EQ(port.output(1), std::nullopt);
}

// RM0090, 8.3.11: the input of an alternate function is sampled as any other.
TEST_F(GpioTest, AnAlternateFunctionHasTheLevelOfThePeripheralElseOfTheBoard) {
  port.write(moder, 0b10'10'00);
  bool high = true;
  port.set_alternate_output([&](unsigned pin) { return pin != 1 ? std::optional(high) : std::nullopt; });
  board.pins = {{{'C', 0}, false}, {{'C', 1}, true}, {{'C', 2}, false}};
  EXPECT_FALSE(input(0)) << "a plain input";
  EXPECT_TRUE(input(1));
  EXPECT_TRUE(input(2));
  high = false;
  EXPECT_FALSE(input(2));
}

TEST_F(GpioTest, AnOpenDrainOutputDrivesLowOnly) {
  port.write(moder, 0b01);
  port.write(otyper, 1);
  port.write(pupdr, 0b01);
  EXPECT_EQ(port.output(0), false);
  EXPECT_FALSE(input(0));
  port.write(odr, 1);
  EXPECT_EQ(port.output(0), std::nullopt);
  EXPECT_TRUE(input(0));
  board.pins[{'C', 0}] = false;
  EXPECT_FALSE(input(0));
}

TEST_F(GpioTest, AnAnalogPinReadsLow) {
  board.pins[{'C', 5}] = true;
  EXPECT_TRUE(input(5));
  port.write(moder, 0b11U << 10U);
  EXPECT_FALSE(input(5));
  EXPECT_EQ(port.mode(5), Gpio::Mode::analog);
}

TEST_F(GpioTest, SetHasPrecedenceOverResetInBsrr) {
  port.write(odr, 0x00F0);
  port.write(bsrr, 0x0030'0001);
  EXPECT_EQ(port.read(odr), 0x00C1U);
  port.write(bsrr, 0xFFFF'0F00);
  EXPECT_EQ(port.read(odr), 0x0F00U);
}

TEST_F(GpioTest, ReportsModeAndAlternateFunctionOfAPin) {
  port.write(moder, 0b10U << 18U);  // pin 9
  port.write(0x20, 0x7000'0001);    // pin 7: AF7, pin 0: AF1
  port.write(0x24, 0x0000'0090);    // pin 9: AF9
  EXPECT_EQ(port.mode(9), Gpio::Mode::alternate);
  EXPECT_EQ(port.mode(8), Gpio::Mode::input);
  EXPECT_EQ(port.alternate_function(9), 9U);
  EXPECT_EQ(port.alternate_function(7), 7U);
  EXPECT_EQ(port.alternate_function(0), 1U);
}

TEST_F(GpioTest, RejectsWhatItDoesNotModelByName) {
  EXPECT_EQ(test::rejection([&] { port.write(0x1C, 0x1'0001); }),
            "GPIOC_LCKR = 0x10001 at offset 0x1C: locking is not modelled");
  EXPECT_EQ(test::rejection([&] { port.write(pupdr, 0xC0); }),
            "GPIOC_PUPDR = 0xC0 at offset 0xC: 11 for pin 3 is reserved");
  EXPECT_EQ(test::rejection([&] { static_cast<void>(port.read(0x28)); }),
            "GPIOC at offset 0x28: reading it is not modelled");
  EXPECT_THROW(Gpio(chip, board, 'J'), std::invalid_argument);
}

}  // namespace
}  // namespace proleg::sim
