// All cases on the smallest Cortex-M, which multiplies 32 by 32 bits to 32 and does the rest in software.

#include <gtest/gtest.h>

#include "tests/identity/cortex_m_player.hpp"
#include "tests/identity/expect_golden.hpp"

namespace proleg::identity {
namespace {

class AllCasesOnCortexM0 : public EachAlgorithm {};

TEST_P(AllCasesOnCortexM0, GiveTheGoldenSetpoints) {
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m0); }, algorithm(), all_cases);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, AllCasesOnCortexM0, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
