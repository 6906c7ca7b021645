// The programs that gcc and clang make of the core with optimisation. The ordinary suite plays the first cases, the
// slow suite all. (The preset host is built by gcc with optimisation, too; it plays all cases in every suite.)

#include <gtest/gtest.h>

#include "tests/identity/expect_golden.hpp"

namespace proleg::identity {
namespace {

class IdentityOfCompilers : public EachAlgorithm {};

TEST_P(IdentityOfCompilers, GccGivesTheGoldenSetpoints) {
  expect_golden_from("identity_gcc_O2", algorithm(), PROLEG_SLOW_CASES);
}
TEST_P(IdentityOfCompilers, ClangGivesTheGoldenSetpoints) {
  expect_golden_from("identity_clang_O2", algorithm(), PROLEG_SLOW_CASES);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityOfCompilers, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
