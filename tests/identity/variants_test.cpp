// The programs that gcc and clang make of the core, with and without optimisation. Those without optimisation take many
// times as long, so they play the first cases; all_cases_test.cpp plays all.

#include <gtest/gtest.h>

#include "tests/identity/expect_golden.hpp"

namespace proleg::identity {
namespace {

class IdentityOfCompilers : public EachAlgorithm {};

TEST_P(IdentityOfCompilers, GccWithoutOptimisationGivesTheGoldenSetpoints) {
  expect_golden_from("identity_gcc_O0", algorithm(), quick_cases);
}
TEST_P(IdentityOfCompilers, GccWithOptimisationGivesTheGoldenSetpoints) {
  expect_golden_from("identity_gcc_O2", algorithm(), all_cases);
}
TEST_P(IdentityOfCompilers, ClangWithoutOptimisationGivesTheGoldenSetpoints) {
  expect_golden_from("identity_clang_O0", algorithm(), quick_cases);
}
TEST_P(IdentityOfCompilers, ClangWithOptimisationGivesTheGoldenSetpoints) {
  expect_golden_from("identity_clang_O2", algorithm(), all_cases);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityOfCompilers, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
