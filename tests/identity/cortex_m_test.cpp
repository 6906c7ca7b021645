// The image for Cortex-M, on an emulated CPU, plays the same cases as five modules.

#include <gtest/gtest.h>

#include "tests/identity/cortex_m_player.hpp"
#include "tests/identity/expect_golden.hpp"
#include "tests/identity/sensing_probe.hpp"

namespace proleg::identity {
namespace {

class IdentityOfProcessors : public EachAlgorithm {
 protected:
  /// All cases for an algorithm of the core; the probe, which nobody ships, shows in a few that contacts arrive.
  static std::uint32_t cases() { return GetParam() == sensing_probe().declaration().id ? quick_cases : all_cases; }
};

TEST_P(IdentityOfProcessors, CortexM4GivesTheGoldenSetpoints) {
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m4); }, algorithm(), cases());
}

TEST_P(IdentityOfProcessors, CortexM0GivesTheGoldenSetpoints) {
  expect_golden([] { return make_cortex_m_player(cortex_m::Cpu::cortex_m0); }, algorithm(), cases());
}

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityOfProcessors, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
