#include "sim/authoring/actuation_edit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <regex>
#include <sstream>

#include "memory_files.hpp"
#include "replaced.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

/// The small scenario with this actuation file.
Scenario with_modules(const std::string& text) {
  MemoryFiles files = small_scenario();
  files.texts["actuation.xml"] = text;
  return files.scenario();
}

Scenario with_settings(const Scenario& file, const std::vector<std::string>& words) {
  Scenario wanted = file;
  for (const std::string& word : words) {
    apply_setting(wanted, word);
  }
  return wanted;
}

/// The text of the actuation file with all edits for these words.
std::string applied(const Scenario& file, const std::vector<std::string>& words) {
  return edited(actuation_source(file).text, actuation_edits(file, with_settings(file, words)));
}

const std::string& module_text() {
  static const std::string text = R"(<!-- kept -->
<actuation>
  <actuationModule name="PatternGenerator_sinusoidal">
	<jointConfiguration joints="11"/>
    <parameter   NAME='amplitude' value = '30'/> <!-- wide -->
    <parameter name="amplitude" joint="J1"
               Value="10" unit="deg"></parameter>
  </actuationModule>
</actuation>
)";
  return text;
}

TEST(ActuationEdit, NothingIsWrittenForWhatTheFileSays) {
  EXPECT_TRUE(actuation_edits(with_modules(module_text()), with_modules(module_text())).empty());
}

TEST(ActuationEdit, AValueOfOneJointChangesItsTagAndNothingElse) {
  const Scenario file = with_modules(module_text());
  EXPECT_EQ(applied(file, {"amplitude:J1=12.5"}), replaced(module_text(), "\"10\"", "\"12.5\""));
}

TEST(ActuationEdit, AValueOfAllOtherJointsChangesTheCommonTag) {
  const Scenario file = with_modules(module_text());
  EXPECT_EQ(applied(file, {"amplitude:J2=31"}), replaced(module_text(), "'30'", "'31'"));
}

TEST(ActuationEdit, AValueThatTheFileDoesNotHaveIsAddedBehindTheOthers) {
  const Scenario file = with_modules(module_text());
  EXPECT_EQ(applied(file, {"frequency=2"}),
            replaced(module_text(), "</parameter>\n",
                     "</parameter>\n    <parameter name=\"frequency\" value=\"2\" unit=\"Hz\"/>\n"));
}

TEST(ActuationEdit, AValueOfSomeJointsGetsTagsOfItsOwnBehindTheCommonOne) {
  const std::string text = replaced(module_text(), "name=\"amplitude\" joint=\"J1\"", "name=\"frequency\"");
  const Scenario file = with_modules(replaced(text, "unit=\"deg\"", ""));
  const std::string before = actuation_source(file).text;
  EXPECT_EQ(applied(file, {"amplitude:J2=0"}),
            replaced(before, "<!-- wide -->\n",
                     "<!-- wide -->\n    <parameter name=\"amplitude\" value=\"0\" unit=\"deg\" joint=\"J2\"/>\n"));
}

TEST(ActuationEdit, AModuleWithoutParametersGetsThemBehindItsJoints) {
  const Scenario file = with_modules(
      "<actuation>\r\n\t<actuationModule name=\"DirectJointAccess\">\r\n\t\t<jointConfiguration joints=\"11\"/>\r\n"
      "\t</actuationModule>\r\n</actuation>\r\n");
  EXPECT_EQ(applied(file, {"angle=5"}),
            replaced(actuation_source(file).text, "\"11\"/>\r\n",
                     "\"11\"/>\r\n\t\t<parameter name=\"angle\" value=\"5\" unit=\"deg\"/>\r\n"));
}

TEST(ActuationEdit, ATextInOneLineStaysInOneLine) {
  const Scenario file = with_modules(
      "<actuation><actuationModule name=\"DirectJointAccess\"><jointConfiguration joints=\"11\"/></actuationModule>"
      "</actuation>");
  const std::vector<ActuationEdit> edits = actuation_edits(file, with_settings(file, {"angle:J1=5"}));
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edited(actuation_source(file).text, edits),
            "<actuation><actuationModule name=\"DirectJointAccess\"><jointConfiguration joints=\"11\"/>"
            "<parameter name=\"angle\" value=\"5\" unit=\"deg\" joint=\"J1\"/></actuationModule></actuation>");
  EXPECT_EQ(edits[0].old_line, actuation_source(file).text);
}

TEST(ActuationEdit, ACommentIsNoTag) {
  const Scenario file =
      with_modules(replaced(module_text(), "<!-- wide -->", "<!-- <parameter name=\"amplitude\" value=\"1\"/> -->"));
  EXPECT_EQ(applied(file, {"amplitude:J1=12.5"}), replaced(actuation_source(file).text, "\"10\"", "\"12.5\""));
}

TEST(ActuationEdit, ShowsTheLineBeforeAndAfter) {
  const Scenario file = with_modules(module_text());
  const std::vector<ActuationEdit> edits =
      actuation_edits(file, with_settings(file, {"amplitude:J1=12.5", "frequency=2"}));
  ASSERT_EQ(edits.size(), 2U);
  EXPECT_EQ(edits[0].line, 7);
  EXPECT_EQ(edits[0].old_line, "Value=\"10\" unit=\"deg\"></parameter>");
  EXPECT_EQ(edits[0].new_line, "Value=\"12.5\" unit=\"deg\"></parameter>");
  EXPECT_EQ(edits[1].line, 7);
  EXPECT_EQ(edits[1].old_line, std::nullopt);
  EXPECT_EQ(edits[1].new_line, "<parameter name=\"frequency\" value=\"2\" unit=\"Hz\"/>");
}

TEST(ActuationEdit, AJointNameIsWrittenAsXml) {
  MemoryFiles files = small_scenario();
  files.replace("robot.xml", "<Joint name=\"J2\"", "<Joint name=\"&quot;A &amp; B&lt;\"");
  const Scenario file = files.scenario();
  Scenario wanted = file;
  set_start_value(wanted, {1, 0, 0, false, 12345});  // the only joint of the second module
  set_start_value(wanted, {0, 0, 0, false, 54321});
  const Scenario again = with_actuation_text(file, edited(actuation_source(file).text, actuation_edits(file, wanted)));
  EXPECT_EQ(start_value(again, 0, 0, 0), 54321);
  EXPECT_EQ(start_value(again, 1, 0, 0), 12345);
}

/// Start values at random, most of them as they are.
Scenario with_random_values(const Scenario& file, std::mt19937& random) {
  Scenario wanted = file;
  for (const unsigned slot : used_slots(file)) {
    const Declaration& declaration = file.kernel.slots[slot].algorithm->declaration();
    for (unsigned number = 0; number < declaration.parameters.size(); ++number) {
      const Parameter& parameter = declaration.parameters[number];
      std::uniform_int_distribution<std::int32_t> values(parameter.minimum, parameter.maximum);
      const std::int32_t common = values(random);
      const unsigned kind = random() % 4;  // 0, 1: none, 2: one value for all, 3: some joints
      for (const unsigned joint : file.kernel.slots[slot].group) {
        if (kind == 2 || (kind == 3 && random() % 2 == 0)) {
          set_start_value(wanted, {static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(joint),
                                   static_cast<std::uint8_t>(number), false, kind == 2 ? common : values(random)});
        }
      }
    }
  }
  return wanted;
}

void expect_only_values_and_new_tags(const std::string& before, const std::string& after) {
  static const std::regex value("value=\"[^\"]*\"");
  static const std::regex new_tag("\\s*<parameter name=\"\\w+\" value=\"\"( unit=\"[^\"]*\")?( joint=\"\\w+\")?/>");
  std::istringstream old_lines(std::regex_replace(before, value, "value=\"\""));
  std::istringstream new_lines(std::regex_replace(after, value, "value=\"\""));
  std::string old_line;
  std::getline(old_lines, old_line);
  for (std::string line; std::getline(new_lines, line);) {
    if (line == old_line) {
      old_line.clear();
      std::getline(old_lines, old_line);
    } else {
      EXPECT_TRUE(std::regex_match(line, new_tag)) << line;
    }
  }
  EXPECT_TRUE(old_lines.eof()) << "from here on lines are missing: " << old_line;
}

class ShippedActuation : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, ShippedActuation,
                         testing::Values("travelling_wave/uniform", "travelling_wave/tail_fixed",
                                         "travelling_wave/coupled", "obstacle/reflex", "long_chain/twenty"));

TEST_P(ShippedActuation, WrittenAndReadAgainGivesTheChosenRawValuesAndKeepsAllOtherBytes) {
  DiskFiles files;
  Scenario file = read_scenario(source_path("/sim/scenarios/") + GetParam() + ".simulation.xml", files);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const Scenario wanted = with_random_values(file, random);
    std::vector<ActuationEdit> edits = actuation_edits(file, wanted);
    // Some of them: the others must not matter.
    std::erase_if(edits, [&](const ActuationEdit&) { return seed % 2 == 0 && random() % 2 == 0; });
    const std::string text = edited(actuation_source(file).text, edits);
    expect_only_values_and_new_tags(actuation_source(file).text, text);
    const Scenario again = with_actuation_text(file, text);
    for (const unsigned slot : used_slots(file)) {
      for (unsigned number = 0; number < file.kernel.slots[slot].algorithm->declaration().parameters.size(); ++number) {
        for (const unsigned joint : file.kernel.slots[slot].group) {
          const bool is_chosen = std::ranges::any_of(edits, [&](const ActuationEdit& edit) {
            return edit.slot == slot && edit.number == number && edit.joints.contains(joint);
          });
          EXPECT_EQ(start_value(again, slot, joint, number),
                    start_value(is_chosen ? wanted : file, slot, joint, number));
        }
      }
    }
    file = again;  // the next changes begin with what was written
  }
}

}  // namespace
}  // namespace proleg::sim
