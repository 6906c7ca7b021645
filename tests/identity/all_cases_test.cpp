// All cases where they take long. On both Cortex-M: the one of the modules, and the smallest, which multiplies 32 by 32
// bits to 32 and does the rest in software. On this computer without optimisation. cortex_m_test.cpp and
// variants_test.cpp play the first cases.

#include <gtest/gtest.h>

#include "tests/identity/cortex_m_player.hpp"
#include "tests/identity/expect_golden.hpp"

namespace proleg::identity {
namespace {

class AllCases : public EachAlgorithm {};

TEST_P(AllCases, GiveTheGoldenSetpointsOnCortexM4) {
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m4); }, algorithm(), all_cases);
}

TEST_P(AllCases, GiveTheGoldenSetpointsOnCortexM0) {
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m0); }, algorithm(), all_cases);
}

TEST_P(AllCases, GiveTheGoldenSetpointsFromGccWithoutOptimisation) {
  expect_golden_from("identity_gcc_O0", algorithm(), all_cases);
}

TEST_P(AllCases, GiveTheGoldenSetpointsFromClangWithoutOptimisation) {
  expect_golden_from("identity_clang_O0", algorithm(), all_cases);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, AllCases, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
