#include "sim/optimize/adaptation/trial_table.hpp"

#include <gtest/gtest.h>

#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shipped_atlas.hpp"

namespace proleg::optimize {
namespace {

const std::vector<MadeTrial> two_trials{{1, 0.75, 0.125, 0.1, ""}, {0, 1.2, 1.25, 0.0, "the robot\tfell"}};

std::string message_of(const std::string& inputs, const std::string& text) {
  try {
    static_cast<void>(read_trial_table(small_atlas(), inputs, "trials.tsv", text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TrialTable, SaysOfEachTrialItsCellGaitAndScores) {
  EXPECT_EQ(trial_table(small_atlas(), "abc", two_trials),
            "# inputs: abc\n"
            "trial\tcell\theight (m)\tduty_factor\tamplitude:J5 (deg)\tamplitude:J4 (deg)\tamplitude:J3 (deg)\t"
            "amplitude:J2 (deg)\tamplitude:J1 (deg)\texpected (m)\tdeviation (m)\tmeasured (m)\tfailure\n"
            "1\t25,20\t0.049\t0.395\t30\t30\t30\t30\t30\t0.75\t0.125\t0.1\t\n"
            "2\t1,1\t0.001\t0.205\t10\t10\t10\t10\t10\t1.2\t1.25\t0\tthe robot fell\n");
}

TEST(TrialTable, IsReadBack) {
  const Atlas atlas = small_atlas();
  const std::vector<MadeTrial> read =
      read_trial_table(atlas, "abc", "trials.tsv", trial_table(atlas, "abc", two_trials));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].gait, 1U);
  EXPECT_EQ(read[0].expected, 0.75);
  EXPECT_EQ(read[0].deviation, 0.125);
  EXPECT_EQ(read[0].measured, 0.1);
  EXPECT_EQ(read[0].failure, "");
  EXPECT_EQ(read[1].gait, 0U);
  EXPECT_EQ(read[1].failure, "the robot fell");
}

TEST(TrialTable, IsRefusedForOtherInputsOrIfItIsDamaged) {
  const std::string table = trial_table(small_atlas(), "abc", two_trials);
  EXPECT_NE(message_of("abd", table).find("trials.tsv:1: found trials of another atlas"), std::string::npos);
  EXPECT_NE(message_of("abc", "").find("trials.tsv:1: found no table"), std::string::npos);
  const auto with = [&](const std::string& old_text, const std::string& new_text) {
    std::string changed = table;
    changed.replace(changed.find(old_text), old_text.size(), new_text);
    return message_of("abc", changed);
  };
  EXPECT_NE(with("trial\tcell", "trail\tcell").find("trials.tsv:2:"), std::string::npos);
  EXPECT_NE(with("\n2\t1,1\t", "\n2\t8,1\t").find("trials.tsv:4:"), std::string::npos) << "no gait in this cell";
  EXPECT_NE(with("\n2\t1,1\t", "\n3\t1,1\t").find("trials.tsv:4:"), std::string::npos) << "trial 2 is missing";
  EXPECT_NE(with("0.125\t0.1\t", "0.125\tinf\t").find("trials.tsv:3:"), std::string::npos);
  EXPECT_NE(with("0.125\t0.1\t", "0.125\t").find("trials.tsv:3:"), std::string::npos);
}

}  // namespace
}  // namespace proleg::optimize
