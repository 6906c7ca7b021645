// The image for Cortex-M, on an emulated CPU, plays the first cases as five modules;
// all_cases_test.cpp plays all.

#include <gtest/gtest.h>

#include "tests/identity/cortex_m_player.hpp"
#include "tests/identity/expect_golden.hpp"

namespace proleg::identity {
namespace {

class IdentityOfProcessors : public EachAlgorithm {};

TEST_P(IdentityOfProcessors, CortexM4GivesTheGoldenSetpoints) {
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m4); }, algorithm(), quick_cases);
}

TEST_P(IdentityOfProcessors, CortexM0GivesTheGoldenSetpoints) {
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m0); }, algorithm(), quick_cases);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityOfProcessors, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
