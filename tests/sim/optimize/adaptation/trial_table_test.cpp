#include "sim/optimize/adaptation/trial_table.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shipped_atlas.hpp"

namespace proleg::optimize {
namespace {

const TrialComments comments{"abc", "../atlas", "uniform.simulation.xml, jammed:J3=20"};
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
  EXPECT_EQ(trial_table(small_atlas(), comments, two_trials),
            "# inputs: abc\n"
            "# atlas: ../atlas\n"
            "# robot: uniform.simulation.xml, jammed:J3=20\n"
            "trial\tcell\theight (m)\tduty_factor\tamplitude:J5 (deg)\tamplitude:J4 (deg)\tamplitude:J3 (deg)\t"
            "amplitude:J2 (deg)\tamplitude:J1 (deg)\texpected (m)\tdeviation (m)\tmeasured (m)\tfailure\n"
            "1\t25,20\t0.049\t0.395\t30\t30\t30\t30\t30\t0.75\t0.125\t0.1\t\n"
            "2\t1,1\t0.001\t0.205\t10\t10\t10\t10\t10\t1.2\t1.25\t0\tthe robot fell\n");
}

TEST(TrialTable, IsReadBack) {
  const Atlas atlas = small_atlas();
  const std::vector<MadeTrial> read =
      read_trial_table(atlas, "abc", "trials.tsv", trial_table(atlas, comments, two_trials));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].gait, 1U);
  EXPECT_EQ(read[0].expected, 0.75);
  EXPECT_EQ(read[0].deviation, 0.125);
  EXPECT_EQ(read[0].measured, 0.1);
  EXPECT_EQ(read[0].failure, "");
  EXPECT_EQ(read[1].gait, 0U);
  EXPECT_EQ(read[1].failure, "the robot fell");
}

TEST(TrialTable, OfARobotThatHardlyMovesIsReadBackThoughItsCostsAreLarge) {
  const Atlas atlas = small_atlas();
  const std::vector<MadeTrial> made{{0, 1.2, 0.1, 3.1e17, ""}};
  EXPECT_EQ(read_trial_table(atlas, "abc", "trials.tsv", trial_table(atlas, comments, made)).at(0).measured, 3.1e17);
}

TEST(TrialTable, TellsGaitsOfOneCellApartByTheirValues) {
  Atlas atlas = small_atlas();
  atlas.gaits.push_back({atlas.gaits[0].cell, atlas.gaits[0].candidate, 0.5});
  atlas.gaits.back().candidate[3] += 1;
  const std::vector<MadeTrial> made{{2, 0.5, 0.1, 0.4, ""}, {0, 1.2, 0.1, 1.1, ""}};
  const std::vector<MadeTrial> read = read_trial_table(atlas, "abc", "trials.tsv", trial_table(atlas, comments, made));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].gait, 2U);
  EXPECT_EQ(read[1].gait, 0U);
}

TEST(TrialTable, IsRefusedForOtherInputsOrIfItIsDamaged) {
  const std::string table = trial_table(small_atlas(), comments, two_trials);
  EXPECT_NE(message_of("abd", table).find("trials.tsv:1: found trials of another atlas"), std::string::npos);
  EXPECT_NE(message_of("abc", "").find("trials.tsv:1: found no table"), std::string::npos);
  const auto with = [&](const std::string& old_text, const std::string& new_text) {
    std::string changed = table;
    changed.replace(changed.find(old_text), old_text.size(), new_text);
    return message_of("abc", changed);
  };
  EXPECT_NE(with("trial\tcell", "trail\tcell").find("trials.tsv:4:"), std::string::npos);
  EXPECT_NE(with("\n2\t1,1\t", "\n2\t8,1\t").find("trials.tsv:6:"), std::string::npos) << "no gait in this cell";
  EXPECT_NE(with("\n2\t1,1\t", "\n3\t1,1\t").find("trials.tsv:6:"), std::string::npos) << "trial 2 is missing";
  EXPECT_NE(with("0.125\t0.1\t", "0.125\tinf\t").find("trials.tsv:5:"), std::string::npos);
  EXPECT_NE(with("0.125\t0.1\t", "0.125\t1e200\t").find("trials.tsv:5:"), std::string::npos);
  EXPECT_NE(with("0.125\t0.1\t", "0.125\t").find("trials.tsv:5:"), std::string::npos);
}

/// The table as programs of people save it.
TEST(TrialTable, IsReadBackFromEditorsAndSpreadsheets) {
  const std::string table = trial_table(small_atlas(), comments, two_trials);
  const auto with_line_ends = [&](const std::string& end) {
    std::string text;
    for (const char c : table) {
      text += c == '\n' ? end : std::string(1, c);
    }
    return text;
  };
  std::string stripped = table;
  stripped.erase(stripped.find("\t0.1\t\n") + 4, 1);
  for (const std::string& text : {stripped, stripped.substr(0, stripped.size() - 1), with_line_ends("\r\n"),
                                  with_line_ends("\t\t\n"), "\xEF\xBB\xBF" + table, table + "\t\t\n\n"}) {
    EXPECT_EQ(message_of("abc", text), "no error") << text;
    const std::vector<MadeTrial> read = read_trial_table(small_atlas(), "abc", "trials.tsv", text);
    ASSERT_EQ(read.size(), 2U) << text;
    EXPECT_EQ(read[0].failure, "");
    EXPECT_EQ(read[1].failure, "the robot fell");
    EXPECT_EQ(look_at_trials(text, 2)->trials.size(), 2U) << text;
    EXPECT_EQ(look_at_trials(text, 2)->comments.inputs, "abc") << text;
  }
}

TEST(TrialTable, SaysWhichColumnIsWrong) {
  const std::string table = trial_table(small_atlas(), comments, two_trials);
  const auto with = [&](const std::string& old_text, const std::string& new_text) {
    std::string changed = table;
    changed.replace(changed.find(old_text), old_text.size(), new_text);
    return message_of("abc", changed);
  };
  EXPECT_EQ(with("\t0.125\t", "\t0,125\t"),
            "trials.tsv:5: found '0,125' in the column `deviation (m)`, expected a number, with a point before its "
            "decimals");
  EXPECT_NE(with("\t0.1\t\n", "\n").find("trials.tsv:5: found nothing in the column `measured (m)`"),
            std::string::npos);
  EXPECT_NE(with("\n2\t", "\n\"2\"\t").find("trials.tsv:6: found '\"2\"' in the column `trial`, expected trial 2"),
            std::string::npos);
  EXPECT_NE(with("\t0.1\t\n", "\t0.1\tit\tfell\n").find("trials.tsv:5: found 14 columns, expected 13"),
            std::string::npos);
}

TEST(TrialTable, OfAVersionWithoutTheAtlasIsReadToo) {
  std::string table = trial_table(small_atlas(), comments, two_trials);
  table.erase(table.find("# atlas"), table.find("trial\t") - table.find("# atlas"));
  EXPECT_EQ(read_trial_table(small_atlas(), "abc", "trials.tsv", table).size(), 2U);
  EXPECT_FALSE(look_at_trials(table, 2)) << "whose atlas is not known";
}

TEST(TrialTable, SaysWithoutItsAtlasWhatWasTriedAndWhere) {
  const std::string table = trial_table(small_atlas(), comments, two_trials);
  const std::optional<TrialNotes> notes = look_at_trials(table, 2);
  ASSERT_TRUE(notes);
  EXPECT_EQ(notes->comments.inputs, "abc");
  EXPECT_EQ(notes->comments.atlas, "../atlas");
  EXPECT_EQ(notes->comments.robot, "uniform.simulation.xml, jammed:J3=20");
  ASSERT_EQ(notes->trials.size(), 2U);
  EXPECT_EQ(notes->trials[0].place, "25,20");
  EXPECT_EQ(notes->trials[0].values, (std::vector<double>{30, 30, 30, 30, 30}));
  EXPECT_EQ(notes->trials[0].expected, 0.75);
  EXPECT_EQ(notes->trials[0].deviation, 0.125);
  EXPECT_EQ(notes->trials[0].measured, 0.1);
  EXPECT_EQ(notes->trials[1].failure, "the robot fell");
}

TEST(TrialTable, SaysWhatIsProbablyWrongIfSomethingWasSuspected) {
  TrialComments suspected = comments;
  suspected.diagnosis = "powerless:J4 92 %, none 6 %";
  const std::string table = trial_table(small_atlas(), suspected, two_trials);
  EXPECT_NE(table.find("\n# damage: powerless:J4 92 %, none 6 %\n"), std::string::npos) << table;
  EXPECT_EQ(look_at_trials(table, 2)->comments.diagnosis, suspected.diagnosis);
  EXPECT_EQ(read_trial_table(small_atlas(), "abc", "trials.tsv", table).size(), 2U);
}

TEST(TrialTable, IsLookedAtUpToWhatIsDamaged) {
  const std::string table = trial_table(small_atlas(), comments, two_trials);
  for (std::size_t size = 0; size <= table.size(); ++size) {
    const std::optional<TrialNotes> notes = look_at_trials(std::string_view(table).substr(0, size), 2);
    for (const NotedTrial& trial : notes ? notes->trials : std::vector<NotedTrial>()) {
      EXPECT_EQ(trial.values.size(), 5U) << size;
      EXPECT_GE(trial.expected, 0.75) << size;
    }
  }
  EXPECT_EQ(look_at_trials(table.substr(0, table.size() - 20), 2)->trials.size(), 1U);
  EXPECT_FALSE(look_at_trials("evaluation\tscore\n0\t1\n", 2));
  EXPECT_FALSE(look_at_trials("", 2));
}

}  // namespace
}  // namespace proleg::optimize
