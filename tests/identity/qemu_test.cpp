// The image for Cortex-M4 in QEMU's machine netduinoplus2, an STM32F405, plays the cases as five modules.

#include <gtest/gtest.h>

#include "tests/cortex_m/core_image.hpp"
#include "tests/identity/expect_golden.hpp"
#include "tests/identity/qemu_player.hpp"

namespace proleg::identity {
namespace {

class IdentityInQemu : public EachAlgorithm {};

TEST_P(IdentityInQemu, CortexM4GivesTheGoldenSetpoints) {
  const auto make = [] { return make_qemu_player(PROLEG_QEMU, cortex_m::core_image_file(cortex_m::Cpu::cortex_m4)); };
  expect_golden(make, algorithm(), PROLEG_QEMU_CASES);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityInQemu, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
