// Warnings on robots that are valid and probably not meant.

#include "sim/scenario/plausibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "memory_files.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

const std::filesystem::path scenarios = source_path("/sim/scenarios");

/// The shipped robot of five pitch joints.
MemoryFiles caterpillar_files() {
  MemoryFiles files;
  const std::filesystem::path folder = scenarios / "travelling_wave";
  for (const char* name : {"caterpillar.robot.xml", "uniform.actuation.xml", "flat.environment.xml",
                           "modules/head.kinbody.xml", "modules/segment.kinbody.xml", "modules/tail.kinbody.xml"}) {
    files.texts[name] = file_contents(folder / name);
  }
  files.texts["top.xml"] = file_contents(folder / "uniform.simulation.xml");
  return files;
}

const char* const robot_file = "caterpillar.robot.xml";

/// The only warning; it must begin and end like this.
void expect_warning(MemoryFiles& files, const std::string& start, const std::string& end) {
  const std::vector<std::string> warnings = files.scenario().warnings;
  ASSERT_EQ(warnings.size(), 1U) << testing::PrintToString(warnings);
  EXPECT_TRUE(warnings[0].starts_with(start)) << warnings[0];
  EXPECT_TRUE(warnings[0].ends_with(end)) << warnings[0];
}

TEST(Plausibility, NoShippedScenarioAndNoFileOfTheThesisCausesAWarning) {
  DiskFiles files;
  std::size_t read = 0;
  for (const std::filesystem::path& folder : {scenarios, std::filesystem::path(source_path("/tests/sim/scenario"))}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.path().string().ends_with(".simulation.xml")) {
        ++read;
        EXPECT_EQ(read_scenario(entry.path(), files).warnings, std::vector<std::string>{}) << entry.path();
      }
    }
  }
  EXPECT_GE(read, 8U);
  EXPECT_EQ(small_scenario().scenario().warnings, std::vector<std::string>{});
}

TEST(Plausibility, AMissingOffsetfromPutsAJointFarFromItsLinks) {
  MemoryFiles files = caterpillar_files();
  files.replace(robot_file, "      <offsetfrom>3Seg</offsetfrom>\n", "");
  expect_warning(files,
                 "caterpillar.robot.xml:40: joint 'J3' is 144 mm outside of its body '3Seg', which is 72 mm long",
                 "; usually <offsetfrom> is missing or names a wrong body, or the <translation> of the body is wrong");
}

TEST(Plausibility, AWrongOffsetfromDoesTheSame) {
  MemoryFiles files = caterpillar_files();
  files.replace(robot_file, "<offsetfrom>Head</offsetfrom>", "<offsetfrom>2Seg</offsetfrom>");
  EXPECT_FALSE(files.scenario().warnings.empty());
}

TEST(Plausibility, ALinkFarFromItsJointIsNamed) {
  MemoryFiles files = caterpillar_files();
  files.replace(robot_file, "<translation>0 0.288 0</translation>", "<translation>1 0.288 0</translation>");
  expect_warning(files, "caterpillar.robot.xml:58: joint 'J5' is 974 mm outside of its body '4Seg'", "is wrong");
}

TEST(Plausibility, AJointInTheFrameOfItsBodyMayBeFarFromTheShellOfTheOther) {
  MemoryFiles files = caterpillar_files();
  files.replace(robot_file, "<translation>0 0.288 0</translation>", "<translation>0.1 0.288 0</translation>");
  EXPECT_EQ(files.scenario().warnings, std::vector<std::string>{});
}

TEST(Plausibility, OneJointWithItsBodiesInTheOppositeOrderIsNamed) {
  MemoryFiles files = caterpillar_files();
  files.replace(robot_file, "<body>2Seg</body>\n      <body>3Seg</body>", "<body>3Seg</body>\n      <body>2Seg</body>");
  expect_warning(files, "caterpillar.robot.xml:40: joint 'J3' lists its two bodies in the opposite order",
                 "usually every joint lists the body towards the tail first");
}

TEST(Plausibility, AnOppositeOrderWithAnOppositeAxisIsMeant) {
  MemoryFiles files = caterpillar_files();
  files.replace(robot_file,
                "<body>2Seg</body>\n      <body>3Seg</body>\n      <offsetfrom>3Seg</offsetfrom>\n      <axis>1",
                "<body>3Seg</body>\n      <body>2Seg</body>\n      <offsetfrom>3Seg</offsetfrom>\n      <axis>-1");
  EXPECT_EQ(files.scenario().warnings, std::vector<std::string>{});
}

TEST(Plausibility, AChainThatFoldsBackIsNamed) {
  MemoryFiles files = caterpillar_files();
  const std::string turn = " 0</translation><rotationaxis>0 0 1 180</rotationaxis>";
  files.replace(robot_file, "0.072 0</translation>", "0.072" + turn)
      .replace(robot_file, "0.144 0</translation>", "0" + turn)
      .replace(robot_file, "0.216 0</translation>", "-0.072" + turn)
      .replace(robot_file, "0.288 0</translation>", "-0.144" + turn);
  const std::vector<std::string> warnings = files.scenario().warnings;
  EXPECT_NE(testing::PrintToString(warnings).find("the chain folds back at joint 'J2'"), std::string::npos)
      << testing::PrintToString(warnings);
}

TEST(Plausibility, TwoLinksAtTheSamePlaceAreNamed) {
  MemoryFiles files = caterpillar_files();
  files.replace(robot_file, "<translation>0 0.072 0</translation>", "");
  const std::vector<std::string> warnings = files.scenario().warnings;
  EXPECT_NE(testing::PrintToString(warnings).find(
                "body '1Seg' is at the same place as '2Seg'; usually the <translation> of one of them is missing"),
            std::string::npos)
      << testing::PrintToString(warnings);
}

TEST(Plausibility, AnInertiaThatNoSolidHasIsNamed) {
  MemoryFiles files = small_scenario();
  files.replace("end.xml", "3e-4", "9e-4");
  expect_warning(files, "end.xml:2: body 'TailEnd' has an inertia that no solid has",
                 "usually a number in <inertia> is wrong");
}

TEST(Plausibility, AnInertiaInOtherUnitsIsNamed) {
  MemoryFiles files = small_scenario();
  files.replace("end.xml", "1e-4 0 0 0 2e-4 0 0 0 3e-4", "1000 0 0 0 2000 0 0 0 2500");  // g cm^2
  const std::vector<std::string> warnings = files.scenario().warnings;
  EXPECT_NE(testing::PrintToString(warnings).find("usually <inertia> is not in kg m^2"), std::string::npos)
      << testing::PrintToString(warnings);
}

TEST(Plausibility, AMassInGramsIsNamed) {
  MemoryFiles files = caterpillar_files();
  files.replace("modules/head.kinbody.xml", "<total>0.05</total>", "<total>50</total>");
  expect_warning(files, "modules/head.kinbody.xml:5: body 'Head' has 50 kg, which is 513",
                 "usually <total> is not in kilograms, or a length is not in metres");
}

/// Multiplies the numbers of the first <extents> after a tag, as if they were in millimetres.
void use_millimetres(MemoryFiles& files, const std::string& file, const std::string& tag) {
  std::string& text = files.texts.at(file);
  const std::size_t start = text.find("<extents>", text.find(tag)) + std::string("<extents>").size();
  const std::size_t end = text.find("</extents>", start);
  std::istringstream metres(text.substr(start, end - start));
  std::ostringstream millimetres;
  for (double number = 0.0; metres >> number;) {
    millimetres << number * 1000.0 << ' ';
  }
  text.replace(start, end - start, millimetres.str());
}

TEST(Plausibility, ExtentsInMillimetresAreNamedAndNoPlaceIsBlamed) {
  for (const std::string tag : {"<Mass", "<Geom"}) {
    MemoryFiles files = caterpillar_files();
    use_millimetres(files, "modules/segment.kinbody.xml", tag);
    const std::vector<std::string> warnings = files.scenario().warnings;
    EXPECT_EQ(warnings.size(), 4U) << "one for each segment: " << testing::PrintToString(warnings);
    for (const std::string& warning : warnings) {
      EXPECT_TRUE(
          warning.ends_with("usually <inertia> is not in kg m^2, or <extents> or another length of <Mass> or "
                            "<Geom> is not in metres"))
          << warning;
    }
  }
}

TEST(Plausibility, AllExtentsInMillimetresMakeAWrongDensityAndNoPlaceIsBlamed) {
  MemoryFiles files = caterpillar_files();
  use_millimetres(files, "modules/segment.kinbody.xml", "<Mass");
  use_millimetres(files, "modules/segment.kinbody.xml", "<Geom");
  const std::vector<std::string> warnings = files.scenario().warnings;
  EXPECT_EQ(warnings.size(), 4U) << testing::PrintToString(warnings);
  for (const std::string& warning : warnings) {
    EXPECT_TRUE(warning.ends_with("or a length is not in metres")) << warning;
  }
}

TEST(Plausibility, GravityThatDoesNotHoldTheRobotOnTheGroundIsNamed) {
  for (const auto& [gravity, where] : {std::pair{"0 0 9.81", "gravity points upwards;"},
                                       {"0 -9.81 0", "gravity points to the side;"},
                                       {"9.81 0 -1", "gravity points to the side;"},
                                       {"0 0 0", "gravity is 0, so that nothing holds"}}) {
    MemoryFiles files = caterpillar_files();
    files.replace("flat.environment.xml", "0 0 -9.81", gravity);
    expect_warning(files, std::string("flat.environment.xml:7: ") + where, "usually it is 0 0 -9.81");
  }
}

TEST(Plausibility, GravityOfASlopeOrOfAnotherPlanetIsMeant) {
  for (const char* gravity : {"0 -4.9 -8.5", "0 0 -1.62"}) {
    MemoryFiles files = caterpillar_files();
    files.replace("flat.environment.xml", "0 0 -9.81", gravity);
    EXPECT_EQ(files.scenario().warnings, std::vector<std::string>{}) << gravity;
  }
}

TEST(Plausibility, AModuleThatDrivesNoJointIsNamed) {
  MemoryFiles files = caterpillar_files();
  files.replace("uniform.actuation.xml", "11111", "00000");
  expect_warning(files, "uniform.actuation.xml:", ": <actuationModule> has no effect: it drives no joint");
  Scenario scenario = files.scenario();
  for (const char* word : {"amplitude=30", "amplitude=30@5", "1.current_phase=90"}) {
    EXPECT_NE(message_of<InputError>([&] { apply_setting(scenario, word); }).find("1, which drives no joint, expected"),
              std::string::npos)
        << word;
  }
  EXPECT_TRUE(scenario.changes.empty());
}

TEST(Plausibility, AnActuationForAnotherRobotIsNamed) {
  MemoryFiles files = caterpillar_files();
  files.replace("uniform.actuation.xml", "caterpillar.robot.xml", "snake.robot.xml");
  expect_warning(files, "uniform.actuation.xml:",
                 ": the actuation was made for robot 'snake.robot.xml', not for 'caterpillar.robot.xml'");
}

/// Hills of 3 cm in a field of 4 m x 10 m.
HeightField hills() {
  HeightField field{17, 41, 2.0, 5.0, {}};
  for (std::size_t row = 0; row < field.rows; ++row) {
    for (std::size_t column = 0; column < field.columns; ++column) {
      field.heights.push_back(0.015 * std::sin(0.7 * static_cast<double>(row)) *
                              std::cos(0.9 * static_cast<double>(column)));
    }
  }
  return field;
}

/// The warning on the heights; empty if there is none.
std::string height_warning(const HeightField& field) {
  const std::vector<std::string> warnings = check_heights(field, {"hills.xml", 7});
  EXPECT_LE(warnings.size(), 1U);
  return warnings.empty() ? "" : warnings[0];
}

TEST(Plausibility, HeightsInMillimetresAreNamed) {
  HeightField field = hills();
  EXPECT_EQ(height_warning(field), "");
  for (double& height : field.heights) {
    height *= 1000.0;
  }
  EXPECT_TRUE(height_warning(field).starts_with("hills.xml:7: heights whose neighbours differ by "))
      << height_warning(field);
}

TEST(Plausibility, AHeightFarFromAllOthersIsNamedWithItsPlace) {
  for (const double unknown : {-500.0, -9.999, 3.0}) {
    HeightField field = hills();
    field.heights[2 * 17 + 4] = unknown;
    field.heights.back() = unknown;
    EXPECT_TRUE(height_warning(field).starts_with("hills.xml:7: the height " + number_text(unknown) +
                                                  " m in row 3, column 5 (the first of 2) is far from the median, "))
        << height_warning(field);
  }
}

TEST(Plausibility, HillsPitsAndSlopesThatARobotCanMeetAreMeant) {
  HeightField field = hills();
  field.heights[100] = 0.5;  // a post
  field.heights[200] = -0.5;
  EXPECT_EQ(height_warning(field), "");
  std::ranges::fill(field.heights, 0.0);
  field.heights[100] = 2.0;  // a wall on a plane
  EXPECT_EQ(height_warning(field), "");
  for (std::size_t i = 0; i < field.heights.size(); ++i) {
    field.heights[i] = 0.25 * static_cast<double>(i / field.columns);  // 45 degrees
  }
  EXPECT_EQ(height_warning(field), "");
  for (std::size_t i = 0; i < field.heights.size(); ++i) {
    field.heights[i] = i % 2 == 0 ? 0.0 : 0.5;  // blocks
  }
  EXPECT_EQ(height_warning(field), "");
}

TEST(Plausibility, AStartInsideAWallIsNamedWithItsDepth) {
  MemoryFiles files = caterpillar_files();
  // The head ends at y = 310 mm.
  files.replace("flat.environment.xml", "</Environment>",
                "<KinBody name=\"wall\"><Body type=\"static\"><translation>0 1.292 0</translation><Geom type=\"box\">"
                "<extents>1 1 1</extents></Geom></Body></KinBody></Environment>");
  expect_warning(files, "flat.environment.xml: body 'Head' starts 18 mm inside 'wall'",
                 "usually the start position is wrong");
  files.replace("flat.environment.xml", "0 1.292 0", "0 1.308 0");
  EXPECT_EQ(files.scenario().warnings, std::vector<std::string>{}) << "2 mm";
}

/// A level square of 8 m x 8 m around the middle.
std::string sheet(const std::string& name, const std::string& height, bool faces_up) {
  return "<KinBody name=\"" + name + "\"><Body type=\"static\"><translation>0 0 " + height +
         "</translation><Geom type=\"trimesh\" open=\"1\"><vertices>-4 -4 0  4 -4 0  4 4 0  -4 4 "
         "0</vertices><triangles>" +
         (faces_up ? "0 1 2  0 2 3" : "0 2 1  0 3 2") + "</triangles></Geom></Body></KinBody>";
}

MemoryFiles caterpillar_among(const std::string& objects) {
  MemoryFiles files = caterpillar_files();
  files.replace("flat.environment.xml", "</Environment>", objects + "</Environment>");
  return files;
}

TEST(Plausibility, ASheetOfGroundThatFacesDownwardsIsNamed) {
  for (const char* height : {"0.001", "0.02", "0.5"}) {  // the robot is lifted onto the higher ones
    MemoryFiles files = caterpillar_among(sheet("ground", height, false));
    expect_warning(files, "flat.environment.xml: the triangles of 'ground' face downwards under body 'Head'",
                   "usually the mesh must be turned inside out");
  }
}

TEST(Plausibility, WhatFacesDownwardsElsewhereIsMeant) {
  for (const std::string& objects :
       {sheet("ground", "0.02", true), sheet("underside", "-0.2", false),
        sheet("ground", "0.02", true) + sheet("underside", "0.02", false),  // one sheet with two sides
        sheet("ground", "0.02", true) + sheet("underside", "0.01", false),
        std::string("<KinBody name=\"aside\"><translation>20 0 0</translation>") + sheet("far", "0.01", false) +
            "</KinBody>"}) {
    MemoryFiles files = caterpillar_among(objects);
    EXPECT_EQ(files.scenario().warnings, std::vector<std::string>{});
  }
}

TEST(Plausibility, ARobotBesideATurnedBoxIsNotInIt) {
  MemoryFiles files = caterpillar_files();
  // A corner of the box points at the robot; the bounds of the box along the axes of the world contain the robot.
  files.replace("flat.environment.xml", "</Environment>",
                "<KinBody name=\"box\"><Body type=\"static\"><translation>2 2 0</translation><rotationaxis>0 0 1 45"
                "</rotationaxis><Geom type=\"box\"><extents>2 0.5 1</extents></Geom></Body></KinBody></Environment>");
  EXPECT_EQ(files.scenario().warnings, std::vector<std::string>{});
}

}  // namespace
}  // namespace proleg::sim
