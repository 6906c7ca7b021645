// The programs that gcc and clang make of the core without optimisation. They take many times as long as those of
// variants_test.cpp, so the ordinary suite plays the first cases and the slow suite all.

#include <gtest/gtest.h>

#include "tests/identity/expect_golden.hpp"

namespace proleg::identity {
namespace {

constexpr std::uint32_t cases = PROLEG_SLOW_CASES;

class IdentityWithoutOptimisation : public EachAlgorithm {};

TEST_P(IdentityWithoutOptimisation, GccGivesTheGoldenSetpoints) {
  expect_golden_from("identity_gcc_O0", algorithm(), cases);
}
TEST_P(IdentityWithoutOptimisation, ClangGivesTheGoldenSetpoints) {
  expect_golden_from("identity_clang_O0", algorithm(), cases);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityWithoutOptimisation, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
