// The image for Cortex-M, on an emulated CPU, plays the same cases as five modules.

#include <gtest/gtest.h>

#include "tests/identity/cortex_m_player.hpp"
#include "tests/identity/expect_golden.hpp"
#include "tests/identity/sensing_probe.hpp"

namespace proleg::identity {
namespace {

class IdentityOfProcessors : public EachAlgorithm {};

TEST_P(IdentityOfProcessors, CortexM4GivesTheGoldenSetpoints) {
  // All cases for an algorithm of the core; the probe, which nobody ships, shows in a few that contacts arrive.
  const bool is_probe = GetParam() == sensing_probe().declaration().id;
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m4); }, algorithm(),
                is_probe ? quick_cases : all_cases);
}

TEST_P(IdentityOfProcessors, CortexM0GivesTheGoldenSetpoints) {
  // No module has this processor; cortex_m0_test.cpp plays all cases.
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m0); }, algorithm(), quick_cases);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityOfProcessors, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
