#include "tools/proleg/ui/proof_output.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace proleg::tools {
namespace {

using nlohmann::json;

TEST(ProofOutput, TheLastStepIsTheOneThatGoesOn) {
  const ProofStep step = proof_step(
      "proleg verify: 1 of 17: building the library\nwhat the algorithm prints: 9 of 9: no\n"
      "proleg verify: 2 of 17: playing library, one kernel\n");
  EXPECT_EQ(step.done, 2U);
  EXPECT_EQ(step.of, 17U);
  EXPECT_EQ(step.text, "playing library, one kernel");
  EXPECT_EQ(proof_step("").of, 0U);
  EXPECT_EQ(proof_step("proleg verify: 2 of many: x\nproleg verify: of : \nproleg verify: x: 1 of 2").of, 0U);
}

TEST(ProofOutput, TheObjectIsThereWhenItIsComplete) {
  EXPECT_EQ(proof_object(R"({"verified": true, "id": 119})")["id"], 119);
  for (const char* text : {"", "{\"verified\": tr", "[]", "{}", R"({"verified": 1})", "text"}) {
    EXPECT_TRUE(proof_object(text).is_null()) << text;
  }
}

TEST(ProofOutput, TheErrorIsTheLineOfTheProgram) {
  EXPECT_EQ(proof_error({{"verified", true}}, "", 0), "");
  EXPECT_EQ(proof_error({{"verified", false}}, "", 1), "what differs, or exceeds a limit, is in the table");
  EXPECT_EQ(proof_error(json(), "proleg verify: 1 of 17: building\nproleg verify: a.cpp:3: error: 'x' was not\n", 2),
            "a.cpp:3: error: 'x' was not");
  EXPECT_EQ(proof_error(json(), "proleg verify: 1 of 17: building\n", 137),
            "proleg verify has ended without a result, with exit status 137");
}

}  // namespace
}  // namespace proleg::tools
