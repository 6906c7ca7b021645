#include "sim/mcu/peripherals/syscfg.hpp"

#include "support/bench.hpp"

namespace proleg::sim {
namespace {

// RM0090 rev 21, 9.2; MEMRMP: boot from flash.
TEST(Syscfg, ReadsAsAfterReset) {
  test::BenchChip chip;
  Syscfg system(chip);
  test::expect_values(system, {{0x00, 0}, {0x04, 0}, {0x08, 0}, {0x0C, 0}, {0x10, 0}, {0x14, 0}, {0x20, 0}});
}

TEST(Syscfg, RejectsToBeChanged) {
  test::BenchChip chip;
  Syscfg system(chip);
  system.write(0x08, 0);
  EXPECT_EQ(test::rejection([&] { system.write(0x08, 2); }),
            "SYSCFG_EXTICR1 = 0x2 at offset 0x8: remapping, EXTI lines and the compensation cell are not modelled");
  EXPECT_NE(test::rejection([&] { system.write(0x18, 0); }), "");
}

}  // namespace
}  // namespace proleg::sim
