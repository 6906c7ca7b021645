// The images for Cortex-M, on an emulated CPU, play the cases as five modules: for the CPU of the modules, and for the
// smallest, which multiplies 32 by 32 bits to 32 and does the rest in software. The ordinary suite plays the first
// five cases of each algorithm and compares them with the native player, the slow suite all.

#include <gtest/gtest.h>

#include "tests/identity/cortex_m_player.hpp"
#include "tests/identity/expect_golden.hpp"

namespace proleg::identity {
namespace {

constexpr std::uint32_t cases = PROLEG_EMULATED_CASES;

class IdentityOfProcessors : public EachAlgorithm {
 protected:
  static void expect_identity(cortex_m::Cpu cpu) {
    const auto make = [=] { return make_cortex_m_player(cpu); };
    if constexpr (cases == few_cases) {
      expect_as_native(make, algorithm(), cases);
    } else {
      expect_golden(make, algorithm(), cases);
    }
  }
};

TEST_P(IdentityOfProcessors, CortexM4GivesTheGoldenSetpoints) { expect_identity(cortex_m::Cpu::cortex_m4); }

TEST_P(IdentityOfProcessors, CortexM0GivesTheGoldenSetpoints) { expect_identity(cortex_m::Cpu::cortex_m0); }

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityOfProcessors, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
