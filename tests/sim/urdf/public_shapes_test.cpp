// Robots in the shapes that public URDF files have: each becomes a scenario, or is refused in one line that says where.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "imported.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/from_environment.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

struct PublicShape {
  std::string file;
  std::size_t joints;             ///< 0: it is refused
  std::vector<std::string> says;  ///< in the message, or in notes, losses and warnings
};

const std::vector<PublicShape>& shapes() {
  static const std::vector<PublicShape> all{
      {"snake", 8, {}},
      {"any_order", 2, {}},
      {"root_in_the_middle", 2, {}},
      {"wheels",
       2,
       {"'wheel_left_joint' is continuous: its limits are -180 and 180 degrees", "velocity is missing or 0"}},
      {"arm",
       6,
       {"the link 'world', to which the robot is fixed", "<transmission> (line", "<selfCollide> in <gazebo>"}},
      {"panda",
       7,
       {"joint 'panda_joint4': its limits exclude 0; angle 0 is now -1.5708 rad", "<safety_controller> of a joint"}},
      {"visual_only", 1, {"no link has a <collision>", "link 'head' has no mass", "colours of boxes"}},
      {"namespaces", 1, {"<controller:joint_state_publisher> (line"}},
      {"zero_mass", 1, {"link 'b' has no mass: that of its geometry at 1000 kg/m^3"}},
      {"triangle_inequality", 1, {"warning: robot.urdf:4: body 'b' has an inertia that no solid has"}},
      {"inertia_in_mm", 1, {"warning: robot.urdf:3: ", "has the inertia of a solid box of"}},
      {"lengths_in_mm", 1, {"links are 72 m apart"}},
      {"no_effort", 1, {"effort is missing or 0", "velocity is missing or 0: 4.5 rad/s for j"}},
      {"oblique_axis", 1, {}},
      {"missing_visual_mesh",
       1,
       {"the look 'package://nowhere_description/meshes/b.dae' of link 'b': found no such file"}},
      {"gazebo_friction", 1, {"<material> in <gazebo>"}},
      {"four_legs", 0, {":3: found link 'chassis' with 4 branches that move: 'leg_a', 'leg_b', 'leg_c', 'leg_d'"}},
      {"mimic_gripper", 0, {":16: found joint 'finger_b_joint' that follows another joint, <mimic>"}},
      {"prismatic_gripper", 0, {":5: found joint 'finger_joint' of type 'prismatic', expected 'revolute'"}},
      {"floating_base", 0, {"joint 'floating_base' of type 'floating'"}},
      {"planar_base", 0, {"joint 'planar_base' of type 'planar'"}},
      {"xacro_macro", 0, {":3: found <xacro:property>, expected plain URDF: run 'xacro FILE >ROBOT.urdf' first"}},
      {"xacro_expression", 0, {":4: found the expression '${width} 0.1 0.1' in <box>, expected plain URDF"}},
      {"bad_product_of_inertia", 0, {":4: found link 'b' with an inertia that is not positive definite", "mesh in mm"}},
      {"negative_mass", 0, {":4: found a mass of -0.1 kg in link 'b'"}},
      {"dummy_between_joints", 0, {":4: found link 'universal' between joints, without <inertial> and <collision>"}},
      {"not_a_number", 0, {":4: found value='NaN' in <mass>, expected a number"}},
      {"infinite_limit", 0, {":9: found lower='-inf' in <limit>"}},
      {"huge_number", 0, {":7: found xyz='1e300 0 0' in <origin>, expected 3 numbers from -10000 to 10000 m"}},
      {"decimal_comma", 0, {":7: found xyz='0,072 0 0' in <origin>"}},
      {"no_limit", 0, {":5: found no <limit> in <joint>"}},
      {"zero_axis", 0, {":8: found the axis '0 0 0' of joint 'j', expected a direction that is not 0"}},
      {"missing_collision_mesh",
       0,
       {":4: found no file for the mesh 'package://nowhere_description/meshes/b.stl'",
        "--package nowhere_description=FOLDER"}},
      {"ring", 0, {":4: found link 'b' in a ring of links, or below one, expected a tree"}},
      {"two_roots", 0, {":5: found link 'c' that no joint connects to 'a'"}},
      {"two_parents", 0, {":12: found link 'c' as the child of a second joint, expected one; the first is in line 6"}},
      {"unknown_link", 0, {":5: found the unknown link 'b' in joint 'j1', expected one of a"}},
      {"same_names", 0, {":4: found a second link 'a', expected another name; the first is in line 3"}},
      {"unclosed", 0, {":3: found <link>", "expected </link>"}},
      {"sdf", 0, {":2: found <sdf> as the outermost tag, expected <robot>"}},
      {"empty", 0, {":1: found"}},
      {"no_joints", 0, {":3: found no revolute or continuous joint, expected 1 to 64 of them"}},
      {"too_many_joints", 0, {"found 65 joints that move, expected 1 to 64"}},
      {"undefined_material", 1, {"the look of link 'b': a box, sphere or cylinder is shown where it touches"}},
  };
  return all;
}

/// All that an import says; of a refused robot the message.
std::string said_of(const std::string& text, std::size_t& joints) {
  try {
    const UrdfImport import = import_text(text);
    joints = scenario_of(import).robot.joints.size();
    std::string said = joined(import.notes) + joined(import.lost);
    for (const std::string& warning : import.warnings) {
      said += "warning: " + warning + '\n';
    }
    return said;
  } catch (const InputError& error) {
    joints = 0;
    return error.what();
  }
}

TEST(PublicShapes, AreReadOrRefusedWithTheirLine) {
  for (const PublicShape& shape : shapes()) {
    std::size_t joints = 0;
    const std::string said = said_of(robot_text(shape.file), joints);
    EXPECT_EQ(joints, shape.joints) << shape.file << ": " << said;
    for (const std::string& part : shape.says) {
      EXPECT_NE(said.find(part), std::string::npos) << shape.file << ": '" << part << "' is missing in: " << said;
    }
    if (joints == 0) {
      EXPECT_TRUE(said.starts_with("robot.urdf:")) << shape.file << ": " << said;
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    }
  }
}

TEST(PublicShapes, TheTableHasEveryFile) {
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("/tests/sim/urdf/robots"))) {
    files.insert(entry.path().stem().string());
  }
  std::set<std::string> named;
  for (const PublicShape& shape : shapes()) {
    named.insert(shape.file);
  }
  EXPECT_EQ(files, named);
}

TEST(PublicShapes, LineEndsAndMarksOfOtherSystemsChangeNothing) {
  const std::string text = robot_text("snake");
  const std::string plain = scenario_of(import_text(text)).sources[1].text;
  std::string dos;
  for (const char letter : text) {
    dos += letter == '\n' ? "\r\n" : std::string(1, letter);
  }
  EXPECT_EQ(scenario_of(import_text(dos)).sources[1].text.str(), plain);
  EXPECT_EQ(scenario_of(import_text("\xEF\xBB\xBF" + text)).sources[1].text.str(), plain);
  EXPECT_EQ(scenario_of(import_text("\xEF\xBB\xBF" + dos)).sources[1].text.str(), plain);
}

TEST(PublicShapes, OtherEncodingsThanUtf8AreRefused) {
  std::string wide("\xFF\xFE", 2);
  for (const char letter : robot_text("snake")) {
    wide += letter;
    wide += '\0';
  }
  const auto refused = [](const std::string& text) {
    return message_of<InputError>([&] { static_cast<void>(import_text(text)); });
  };
  EXPECT_EQ(refused(wide), "robot.urdf:1: found text in UTF-16, expected a URDF file in UTF-8");
  EXPECT_EQ(refused(wide.substr(2)), "robot.urdf:1: found text in UTF-16, expected a URDF file in UTF-8");
  std::string latin = robot_text("snake");
  latin.insert(latin.find("link_0"), "\xE4");
  EXPECT_EQ(refused(latin), "robot.urdf:3: found bytes that are not UTF-8, expected XML text in UTF-8");
}

using Random = std::mt19937;

std::size_t below(std::size_t bound, Random& random) {
  return std::uniform_int_distribution<std::size_t>(0, bound == 0 ? 0 : bound - 1)(random);
}

/// The texts between double quotes: position and length.
std::vector<std::pair<std::size_t, std::size_t>> values_of(const std::string& text) {
  std::vector<std::pair<std::size_t, std::size_t>> values;
  for (std::size_t begin = text.find('"'); begin != std::string::npos; begin = text.find('"', begin)) {
    const std::size_t end = text.find('"', begin + 1);
    if (end == std::string::npos) {
      break;
    }
    values.emplace_back(begin + 1, end - begin - 1);
    begin = end + 1;
  }
  return values;
}

/// A text in which values of attributes are exchanged: it stays XML.
std::string with_other_values(std::string text, Random& random) {
  static const std::vector<std::string> numbers{"0", "-1", "1e-7", "9999", "0 0 0", "1e-3 2 -3", "fixed", "continuous"};
  for (std::size_t change = 0; change <= below(3, random); ++change) {
    const auto values = values_of(text);
    const auto [at, size] = values[below(values.size(), random)];
    const auto [from, count] = values[below(values.size(), random)];
    text.replace(at, size, below(2, random) == 0 ? text.substr(from, count) : numbers[below(numbers.size(), random)]);
  }
  return text;
}

/// A text with some bytes removed, repeated, exchanged with those of another, or replaced by words of URDF.
std::string damaged(std::string text, const std::string& other, Random& random) {
  static const std::vector<std::string> words{
      "\"",    "<",          "/>",     "nan",      "-1e308",    "0",
      "fixed", "continuous", "&#0;",   "]]>",      "<!--",      "<link name=\"a\"/>",
      "\xFF",  "${x}",       "1e-320", "</robot>", " name=\"\""};
  for (std::size_t change = 0; change <= below(4, random); ++change) {
    const std::size_t at = below(text.size(), random);
    switch (below(5, random)) {
      case 0:
        text.erase(at, below(60, random));
        break;
      case 1:
        text.insert(at, text.substr(below(text.size(), random), below(400, random)));
        break;
      case 2:
        text.insert(at, other.substr(below(other.size(), random), below(400, random)));
        break;
      case 3:
        text.replace(at, std::min(below(12, random), text.size() - at), words[below(words.size(), random)]);
        break;
      default:
        if (at < text.size()) {
          text[at] = static_cast<char>(below(256, random));
        }
    }
  }
  return text;
}

TEST(PublicShapes, DamagedFilesAreReadOrRefusedInOneLine) {
  const std::uint32_t seed = from_environment("PROLEG_URDF_SEED", 1);
  Random random(seed);
  std::size_t read = 0;
  std::size_t refused = 0;
  for (int round = 0; round < 40; ++round) {
    for (const PublicShape& shape : shapes()) {
      const std::string original = robot_text(shape.file);
      const std::string& other = shapes()[below(shapes().size(), random)].file;
      const bool stays_xml = round % 2 == 0 && !values_of(original).empty();
      const std::string text =
          stays_xml ? with_other_values(original, random) : damaged(original, robot_text(other), random);
      std::size_t joints = 0;
      const std::string said = said_of(text, joints);  // another exception, or a signal, fails the test
      ++(joints == 0 ? refused : read);
      if (joints == 0) {
        EXPECT_EQ(said.find('\n'), std::string::npos) << "PROLEG_URDF_SEED=" << seed << ": " << said;
      }
    }
  }
  EXPECT_GT(read, 20U) << "PROLEG_URDF_SEED=" << seed;
  EXPECT_GT(refused, 800U) << "PROLEG_URDF_SEED=" << seed;
}

}  // namespace
}  // namespace proleg::sim
