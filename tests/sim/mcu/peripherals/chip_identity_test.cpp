#include "sim/mcu/peripherals/chip_identity.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace proleg::sim {
namespace {

std::uint32_t at(const std::array<std::uint8_t, system_memory_bytes>& bytes, std::uint32_t address, unsigned size) {
  std::uint32_t value = 0;
  for (unsigned i = size; i-- > 0;) {
    value = value << 8U | bytes[address - system_memory_address + i];
  }
  return value;
}

// RM0090 rev 21, 39.1 and 39.2; DS8626, tables of the calibration values.
TEST(ChipIdentity, LiesAtTheAddressesOfTheManual) {
  const auto bytes = system_memory({0x0123'4567, 0x89AB'CDEF, 0xFEDC'BA98});
  EXPECT_EQ(at(bytes, 0x1FFF'7A10, 4), 0x0123'4567U);
  EXPECT_EQ(at(bytes, 0x1FFF'7A14, 4), 0x89AB'CDEFU);
  EXPECT_EQ(at(bytes, 0x1FFF'7A18, 4), 0xFEDC'BA98U);
  EXPECT_EQ(at(bytes, 0x1FFF'7A22, 2), 1024U);
  EXPECT_EQ(at(bytes, 0x1FFF'7A2A, 2), vrefin_cal);
  EXPECT_EQ(at(bytes, 0x1FFF'7A2C, 2), ts_cal1);
  EXPECT_EQ(at(bytes, 0x1FFF'7A2E, 2), ts_cal2);
}

TEST(ChipIdentity, CalibrationIsWhatTheTypicalChipConverts) {
  const auto code = [](double volts) { return static_cast<int>(std::lround(volts / 3.3 * 4096)); };
  EXPECT_EQ(ts_cal1, code(0.76 + 5 * 0.0025));
  EXPECT_EQ(ts_cal2, code(0.76 + 85 * 0.0025));
  EXPECT_EQ(vrefin_cal, code(1.21));
}

TEST(ChipIdentity, AddressesWithoutModelHaveNames) {
  EXPECT_EQ(describe_address(0x4002'6010), "DMA1 at offset 0x10");
  EXPECT_EQ(describe_address(0x4001'3C00), "EXTI at offset 0x0");
  EXPECT_EQ(describe_address(0x5003'FFFC), "OTG_FS at offset 0x3FFFC");
  EXPECT_EQ(describe_address(0x4000'6000), "0x40006000");
}

}  // namespace
}  // namespace proleg::sim
