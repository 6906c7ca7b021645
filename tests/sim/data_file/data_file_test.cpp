#include "sim/data_file/data_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "printed_data.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "table_of.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::sim {
namespace {

const std::string printed(printed_data);

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return at == std::string::npos ? text : text.replace(at, old.size(), by);
}

std::string message(const std::string& text) {
  return message_of<InputError>([&] { static_cast<void>(table_of_text(text)); });
}

TEST(DataFile, TheListingOfTheThesisIsReadWithEveryDigit) {
  const ReadTable table = table_of_text(printed);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.remark, "");
  const std::vector<std::string> first{"5.80648", "-29.297", "-7.10298", "28.9827", "8.38557"};
  const std::vector<std::string> second{"11.3934", "-27.4934", "-12.6101", "26.9354", "13.802"};
  for (std::size_t part = 0; part < 5; ++part) {
    const std::string name = "Angle." + std::to_string(part + 1);
    EXPECT_EQ(table.rows[0].at(name), first[part]);
    EXPECT_EQ(table.rows[1].at(name), second[part]);
  }
  EXPECT_EQ(table.rows[1].at("Time.5"), "0.062");
  EXPECT_EQ(table.rows[0].at("Frequency.1"), "") << "infinite";
  EXPECT_EQ(table.rows[0].at("z_pos.6"), "-2.69615");
  EXPECT_EQ(table.number(0, "servo_speeds.5"), 1.34228e+09);
  EXPECT_EQ(table.number(0, "desired_joint_positions.1"), 1.58101e-322) << "less than the smallest normal double";
}

TEST(DataFile, ARowHasTickSimulatedTimeAndTimeOfDay) {
  const ReadTable table = table_of_text(printed);
  EXPECT_EQ(std::vector(table.columns.begin(), table.columns.begin() + 4),
            (std::vector<std::string>{"tick", "time_s", "realtime_ms", "desired_angle.1"}));
  EXPECT_EQ(table.rows[1].at("tick"), "1");
  EXPECT_EQ(table.rows[1].at("time_s"), "0.061");
  EXPECT_EQ(table.rows[1].at("realtime_ms"), "1361368880632");
}

TEST(DataFile, CellsOfAModuleWithoutAFrameAtThatTimeAreEmpty) {
  const ReadTable table = table_of_text(printed);
  EXPECT_EQ(table.rows[1].size(), table.columns.size());
  EXPECT_EQ(table.rows[1].at("x_pos.1"), "") << "its second frame is left out";
  EXPECT_EQ(table.rows[1].at("desired_angle.1"), "0");
}

TEST(DataFile, PartsHaveTheNamesOfTheHeader) {
  const std::string text = replaced(printed, R"(sinusoidal parts="5")", R"(sinusoidal names="a b c d e" parts="5")");
  const ReadTable table = table_of_text(replaced(
      text, R"(robot_data parts="13")", R"(robot_data names="1 2 3 4 5 6" jointnames="p q r s t" parts="13")"));
  EXPECT_EQ(table.rows[0].at("Angle.b"), "-29.297");
  EXPECT_EQ(table.rows[0].at("x_pos.6"), "5.00018");
  EXPECT_EQ(table.rows[0].at("servo_currents.r"), "101");
}

TEST(DataFile, PartsWithOneNameHaveDifferentColumns) {
  const ReadTable table =
      table_of_text(replaced(printed, R"(sinusoidal parts="5")", R"(sinusoidal names="a a a b a" parts="5")"));
  const std::string second = "Angle.a.PatternGenerator_sinusoidal";
  EXPECT_EQ(table.rows[0].at("Angle.a"), "5.80648");
  EXPECT_EQ(table.rows[0].at(second), "-29.297");
  EXPECT_EQ(table.rows[0].count(second + ".2"), 1U);
  EXPECT_EQ(table.rows[0].count(second + ".3"), 1U);
}

TEST(DataFile, TwoModulesWithOneTypeHaveDifferentColumns) {
  std::string text = replaced(printed, "<typenames>desired_angle", "<typenames>Angle");
  for (int i = 0; i < 2; ++i) {
    text = replaced(text, "<desired_angle>0 0 0 0 0</desired_angle>", "<Angle>7 7 7 7 7</Angle>");
  }
  const ReadTable table = table_of_text(text);
  EXPECT_EQ(table.rows[0].at("Angle.1"), "7");
  EXPECT_EQ(table.rows[0].at("Angle.1.PatternGenerator_sinusoidal"), "5.80648");
}

TEST(DataFile, RoundsFollowEachOther) {
  const std::string second_round = R"(  <round number="1">
    <PatternGenerator_sinusoidal>
      <frame index="2" realtime="1361368880650" simtime="92">
        <Angle>1 2 3 4 5</Angle><Time>1 1 1 1 1</Time><Frequency>1 1 1 1 1</Frequency><!-- the order is free -->
        <Phase_Difference>1 1 1 1 1</Phase_Difference>
      </frame>
    </PatternGenerator_sinusoidal>
  </round>
</dataroot>)";
  const ReadTable table = table_of_text(replaced(printed, "</dataroot>", second_round));
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_EQ(table.rows[2].at("Angle.5"), "5");
  EXPECT_EQ(table.rows[2].at("desired_angle.1"), "");
}

TEST(DataFile, AFileThatIsCutAnywhereGivesItsWholeFramesAndALine) {
  const ReadTable whole = table_of_text(printed);
  const std::size_t first_frame = printed.find("</frame>") + 8;
  const std::size_t end = printed.find("</dataroot>") + 11;
  for (std::size_t size = 0; size < end; ++size) {
    const std::string text = printed.substr(0, size);
    if (size < first_frame) {
      EXPECT_NE(message(text), "") << size;
      continue;
    }
    const ReadTable cut = table_of_text(text);
    const auto line = 1 + std::count(text.begin(), text.end(), '\n');
    EXPECT_EQ(cut.remark.find("some.data.xml:" + std::to_string(line) + ": the file ends in the middle; its "), 0U)
        << size << ": " << cut.remark;
    std::size_t whole_frames = 0;
    for (std::size_t at = text.find("</frame>"); at != std::string::npos; at = text.find("</frame>", at + 1)) {
      ++whole_frames;
    }
    EXPECT_NE(cut.remark.find(" " + std::to_string(whole_frames) + " whole frames"), std::string::npos) << cut.remark;
    ASSERT_LE(cut.rows.size(), whole.rows.size());
    for (std::size_t row = 0; row < cut.rows.size(); ++row) {
      for (const auto& [column, cell] : cut.rows[row]) {
        EXPECT_TRUE(cell.empty() || cell == whole.rows[row].at(column)) << size << " " << column << ": " << cell;
      }
    }
  }
  EXPECT_EQ(table_of_text(printed.substr(0, end)).remark, "");
}

TEST(DataFile, WhatIsWrongIsOneLineWithFileAndLine) {
  const auto expect = [](const std::string& text, const std::string& expected) { EXPECT_EQ(message(text), expected); };
  expect(replaced(printed, "-7.10298", "-7.1O298"), "some.data.xml:29: found '-7.1O298' in <Angle>, expected a number");
  expect(replaced(printed, "28.9827 8.38557", "28.9827"),
         "some.data.xml:35: found 5 numbers in <Angle>, expected 4, as in the frames before");
  expect(replaced(printed, "<Time>0.031 0", "<Time>0 0.031 0"),
         "some.data.xml:30: found 6 numbers in <Time>, expected 1 to 5, the parts of PatternGenerator_sinusoidal");
  expect(replaced(printed, "</Angle>", "</Angel>"), "some.data.xml:29: found '</Angel>', expected </Angle>");
  expect(replaced(printed, "simtime=\"61\"", "simtime=\"30\""),
         "some.data.xml:23: found simtime 30 after 30, expected frames of a module in the order of time");
  expect(
      replaced(printed, "simtime=\"30\"", ""),
      "some.data.xml:20: found simtime='' in <frame>, expected index, realtime and simtime: the number of the frame, "
      "and milliseconds");
  expect(replaced(printed, "index=\"0\"", "index=\"-1\""),
         "some.data.xml:20: found index='-1' in <frame>, expected the number of the frame");
  expect(replaced(printed, "<tactile></tactile>", "<touch></touch>"),
         "some.data.xml:41: found <touch>, expected a module of the header or </round>");
  expect(replaced(printed, "<tactile parts=\"12\"", "<tactile parts=\"0\""),
         "some.data.xml:10: found parts='0' in <tactile>, expected 1 to 4096 parts");
  expect(replaced(printed, "</dataroot>", "</dataroot><more>"),
         "some.data.xml:60: found <more>, expected nothing behind </dataroot>");
  expect(replaced(printed, "Phase_Difference Frequency realtime", "Frequency realtime"),
         "some.data.xml:31: found <Phase_Difference> in <frame>, expected types: Angle, Time, Frequency");
  expect(replaced(printed, "<typenames>Angle", "<typenames>Angle Bend"),
         "some.data.xml:28: found a frame without <Bend>, expected every type of the header");
  expect("", "some.data.xml:1: found the end of the file, expected <dataroot>, as a data file begins");
  expect("<simulation/>", "some.data.xml:1: found <simulation>, expected <dataroot>, as a data file begins");
  expect("<dataroot>\n<header>\n</header>\n</dataroot>",
         "some.data.xml: found no frame, expected at least one <frame> with the numbers of a module");
}

TEST(DataFile, AFileOfTheDiskIsRecognisedByItsFirstCharacter) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.xml") << "\xEF\xBB\xBF\n" << printed;
  std::ofstream(folder / "b.xml") << "SQLite format 3";
  EXPECT_TRUE(is_xml_file(folder / "a.xml"));
  EXPECT_FALSE(is_xml_file(folder / "b.xml"));
  EXPECT_FALSE(is_xml_file(folder / "none.xml"));
  EXPECT_FALSE(is_xml_file(folder.path()));
  DataFile data(folder / "a.xml");
  EXPECT_EQ(table_of(data).rows.size(), 2U);
  EXPECT_EQ(data.rows(), 2U);
  EXPECT_EQ(data.last_time_s(), 0.061);
}

}  // namespace
}  // namespace proleg::sim
