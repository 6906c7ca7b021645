// The programs that gcc and clang make of the core, without and with optimisation.

#include <gtest/gtest.h>

#include "tests/identity/expect_golden.hpp"

namespace proleg::identity {
namespace {

class IdentityOfCompilers : public EachAlgorithm {
 protected:
  static void expect_golden_from(std::string_view variant) {
    for (const Driver driver : {Driver::whole, Driver::modules}) {
      expect_golden([=] { return make_variant_player(variant, driver, all_cases); }, algorithm(), all_cases);
    }
  }
};

TEST_P(IdentityOfCompilers, GccWithoutOptimisationGivesTheGoldenSetpoints) { expect_golden_from("identity_gcc_O0"); }
TEST_P(IdentityOfCompilers, GccWithOptimisationGivesTheGoldenSetpoints) { expect_golden_from("identity_gcc_O2"); }
TEST_P(IdentityOfCompilers, ClangWithoutOptimisationGivesTheGoldenSetpoints) {
  expect_golden_from("identity_clang_O0");
}
TEST_P(IdentityOfCompilers, ClangWithOptimisationGivesTheGoldenSetpoints) { expect_golden_from("identity_clang_O2"); }

INSTANTIATE_TEST_SUITE_P(Algorithms, IdentityOfCompilers, testing::ValuesIn(algorithm_ids()), algorithm_name);

}  // namespace
}  // namespace proleg::identity
