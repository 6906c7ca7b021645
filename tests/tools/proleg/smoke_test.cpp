// The way of a recording through the programs under the sanitizers. What each program does is tested as it is built for
// users, and the rooms behind it under the sanitizers by their own tests.

#include "command_line.hpp"

namespace proleg::test {
namespace {

using SmokeTest = CommandLine;

TEST_F(SmokeTest, ARunIsRecordedVerifiedExportedAndDrawn) {
  const std::string recording = file("run.proleg").string();
  EXPECT_EQ(proleg({"simulate", scenario("coupled"), "--seconds", "1", "--set", "amplitude=20@50", "--json", "--record",
                    recording})
                .status,
            0);
  EXPECT_EQ(proleg({"replay", recording, "--verify"}).status, 0);
  EXPECT_EQ(proleg({"export", recording, "--tsv"}).status, 0);
  EXPECT_EQ(proleg({"plot", recording}).status, 0);
}

TEST_F(SmokeTest, BadInputIsRejected) {
  expect_refused({"simulate", scenario("coupled"), "--set", "amplitud=20"}, {"amplitud"});
  expect_refused({"simulate", source_path("/README.md")}, {"expected"});
}

}  // namespace
}  // namespace proleg::test
