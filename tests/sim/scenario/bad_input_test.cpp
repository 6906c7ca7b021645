// Each case breaks the small scenario in one place and gives the message, which must be one line.

#include <gtest/gtest.h>

#include <ostream>

#include "memory_files.hpp"
#include "sim/scenario/actuation_reader.hpp"

namespace proleg::sim {
namespace {

struct BadInput {
  std::string name;
  std::string file;
  std::string old_text;
  std::string new_text;
  std::string message;  ///< FILE:LINE: found ..., expected ...; the message must start with it
};

void PrintTo(const BadInput& bad, std::ostream* stream) { *stream << bad.name; }

class BadScenario : public testing::TestWithParam<BadInput> {};

TEST_P(BadScenario, IsNamedWithFileLineFoundAndExpected) {
  const BadInput& bad = GetParam();
  MemoryFiles files = small_scenario();
  ASSERT_EQ(refusal(files), "nothing");
  files.replace(bad.file, bad.old_text, bad.new_text);
  const std::string message = refusal(files);
  EXPECT_EQ(message.substr(0, bad.message.size()), bad.message) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  EXPECT_NE(message.find(", expected "), std::string::npos);
  EXPECT_LT(message.size(), 700U);
}

const std::string j1_limits = "<limitsdeg>-45 90</limitsdeg>";
const std::string custom_inertia = "1e-4 0 0 0 2e-4 0 0 0 3e-4";
const std::string hundred_digits(100, '1');

const auto cases = testing::Values(
    // The top-level file.
    BadInput{
        "WrongRootTag", "top.xml", "<simulation>", "<simulations>",
        "top.xml:1: found <simulations> without an end tag before </simulation> in line 12, expected </simulations>"},
    BadInput{"SecondRootTag", "robot.xml", "<Robot name=\"small\">", "<!-- --><Robots/><Robot name=\"small\">",
             "robot.xml:1: found 'Robot' beside the outermost tag, expected one outermost tag"},
    BadInput{"NotClosed", "top.xml", "</simulation>", "",
             "top.xml:1: found <simulation> without an end tag, expected </simulation>"},
    BadInput{"NotClosedAtTheEnd", "robot.xml", "</Joint>\n  </KinBody>\n</Robot>", "",
             "robot.xml:35: found <Joint> without an end tag, expected </Joint>"},
    BadInput{"NotClosedInTheMiddle", "robot.xml", "<axis>0 0 1</axis>", "<axis>0 0 1<!-- </axis> --><a b='>'/>",
             "robot.xml:39: found <axis> without an end tag before </Joint> in line 44, expected </axis>"},
    BadInput{"Malformed", "top.xml", "<robot>", "<robot name=1>",
             "top.xml:2: found malformed XML (parsing attribute), expected well-formed XML"},
    BadInput{"CommentWithoutEnd", "robot.xml", "  <servo>", "  <!-- An ideal\n servo <servo>",
             "robot.xml:2: found a comment without an end, expected -->"},
    BadInput{"CommentThatSwallowsTheNextOne", "robot.xml", "  <servo>", "\n<!-- First <servo>\n<!-- Second -->",
             "robot.xml:3: found a comment without an end before the next one in line 4, expected -->"},
    BadInput{"TextAtTheTop", "top.xml", "</simulation>", "</simulation>\nrest<!-- -->",
             "top.xml:13: found 'rest' beside the outermost tag, expected one outermost tag"},
    BadInput{"DocumentType", "top.xml", "<simulation>", "<!DOCTYPE x><simulation>",
             "top.xml:1: found 'DOCTYPE x' beside the outermost tag, expected"},
    BadInput{
        "UnknownTag", "top.xml", "<robot>", "<colour>1</colour><robot>",
        "top.xml:2: found <colour> in <simulation>, expected <robot>, <actuation>, <environment>, <simulationProp"},
    BadInput{"UnknownAttribute", "top.xml", "<simulation>", "<simulation version=\"2\">",
             "top.xml:1: found attribute 'version' in <simulation>, expected no attributes"},
    BadInput{"NoRobot", "top.xml", "<robot>robot.xml</robot>", "",
             "top.xml:1: found no <robot> in <simulation>, expected one"},
    BadInput{"TwoRobots", "top.xml", "<actuation>", "<robot>robot.xml</robot><actuation>",
             "top.xml:3: found a second <robot> in <simulation>, expected one; the first is in line 2"},
    BadInput{"MissingFile", "top.xml", "robot.xml", "missing.xml",
             "top.xml:2: found no such file 'missing.xml', expected a readable file of at most 16 MiB"},
    BadInput{"EmptyPath", "top.xml", "robot.xml", " ", "top.xml:2: found an empty path, expected a path of 1 to 4096"},
    BadInput{"LongPath", "top.xml", "robot.xml", std::string(5000, 'a'),
             "top.xml:2: found a path of 5000 characters, expected a path of 1 to 4096 characters"},
    BadInput{"WrongKindOfFile", "top.xml", "<robot>robot.xml", "<robot>environment.xml",
             "environment.xml:1: found <Environment> as the outermost tag, expected <Robot>"},
    BadInput{"NullCharacter", "top.xml", "<duration>2", std::string("<duration>\0", 11),
             "top.xml:6: found a byte 0, expected XML text"},
    BadInput{"NullReference", "top.xml", "<duration>2", "<duration>2&#x00;",
             "top.xml:6: found a reference to the character 0, expected XML text"},
    BadInput{"NotUtf8", "top.xml", "<duration>2", "<duration>\xC3(",
             "top.xml:6: found bytes that are not UTF-8, expected XML text in UTF-8"},
    // Properties.
    BadInput{"DurationZero", "top.xml", "<duration>2", "<duration>0",
             "top.xml:6: found '0' in <duration>, expected a number from 0.01 to 86400 s"},
    BadInput{"DurationInfinite", "top.xml", "<duration>2", "<duration>inf",
             "top.xml:6: found 'inf' in <duration>, expected a number from"},
    BadInput{"DurationNotANumber", "top.xml", "<duration>2", "<duration>nan",
             "top.xml:6: found 'nan' in <duration>, expected a number from"},
    BadInput{"NumberWithRest", "top.xml", "<duration>2", "<duration>2s",
             "top.xml:6: found '2s' in <duration>, expected a number from"},
    BadInput{"NumberTooLarge", "top.xml", "<duration>2", "<duration>1e999",
             "top.xml:6: found '1e999' in <duration>, expected a number from"},
    BadInput{"HexadecimalNumber", "top.xml", "<duration>2", "<duration>0x2",
             "top.xml:6: found '0x2' in <duration>, expected a number from"},
    BadInput{"TickTooLong", "top.xml", "ms\">10", "ms\">101",
             "top.xml:7: found '101' in <tick>, expected a number from 1 to 100 ms"},
    BadInput{"TickUnit", "top.xml", "<tick unit=\"ms\">", "<tick unit=\"s\">",
             "top.xml:7: found unit 's' in <tick>, expected unit 'ms'"},
    BadInput{"TickOfPartsOfMicroseconds", "top.xml", "ms\">10", "ms\">10.0001",
             "top.xml:7: found '10.0001' in <tick>, expected a whole number of microseconds"},
    BadInput{"TickNotAWholeNumberOfSteps", "top.xml", "<stepWidth>0.001", "<stepWidth>0.003",
             "top.xml:7: found a tick of 10 ms with steps of 3 ms, expected a tick that is a whole number of steps"},
    BadInput{"StepLongerThanTick", "top.xml", "<stepWidth>0.001", "<stepWidth>0.02",
             "top.xml:7: found a tick of 10 ms with steps of 20 ms, expected"},
    BadInput{"StepTooLong", "top.xml", "<stepWidth>0.001", "<stepWidth>0.021",
             "top.xml:10: found '0.021' in <stepWidth>, expected a number from 1e-05 to 0.02 s"},
    BadInput{"NegativeSeed", "top.xml", "<seed>7", "<seed>-7",
             "top.xml:8: found '-7' in <seed>, expected a whole number from 0 to 18446744073709551615"},
    BadInput{"SeedTooLarge", "top.xml", "<seed>7", "<seed>18446744073709551616",
             "top.xml:8: found '18446744073709551616' in <seed>, expected a whole number from 0"},
    BadInput{"UnknownSolver", "top.xml", "<solver>direct", "<solver>fast",
             "top.xml:9: found 'fast' in <solver>, expected 'automatic', 'direct' or 'iterative'"},
    // Robot: tags, bodies, masses.
    BadInput{"TagDamagedInPrint", "robot.xml", j1_limits, "limitsdeg>-45 90",
             "robot.xml:33: found text 'limitsdeg>-45 90' in <Joint>, expected <body>, <offsetfrom>, <anchor>"},
    BadInput{"UnknownTagInBody", "robot.xml", "<translation>0 0.2 0</translation>", "<moved>1</moved>",
             "robot.xml:18: found <moved> in <Body>, expected <Geom>, <Mass>, <offsetfrom>, <translation>"},
    BadInput{"UnknownAttributeInKinBody", "robot.xml", "prefix=\"Tail\"", "suffix=\"Tail\"",
             "robot.xml:7: found attribute 'suffix' in <KinBody>, expected one of the attributes name, prefix, file"},
    BadInput{"AttributeTwice", "robot.xml", "<Body name=\"Head\">", "<Body name=\"Head\" NAME=\"Hat\">",
             "robot.xml:17: found attribute 'NAME' twice in <Body>, expected it once"},
    BadInput{"ElementInText", "robot.xml", "<translation>0 0.2 0", "<translation>0 <b/> 0.2 0",
             "robot.xml:18: found <b> in <translation>, expected text only"},
    BadInput{"BodyWithoutName", "robot.xml", "<Body name=\"Head\">", "<Body>",
             "robot.xml:17: found no attribute 'name' in <Body>, expected one"},
    BadInput{"EmptyName", "robot.xml", "<Body name=\"Head\">", "<Body name=\"\">",
             "robot.xml:17: found an empty name in <Body>, expected a name of 1 to 64 characters"},
    BadInput{"BodyTwice", "robot.xml", "<Body name=\"Head\">", "<Body name=\"Middle\">",
             "robot.xml:17: found a second body 'Middle', expected another name; the first is in robot.xml:8"},
    BadInput{"StaticBodyInARobot", "end.xml", "type=\"dynamic\"", "type=\"static\"",
             "end.xml:2: found type 'static' in <Body>, expected 'dynamic'"},
    BadInput{"NoMass", "robot.xml", "<Mass type=\"mimicgeom\">\n        <total>0.3</total>\n      </Mass>", "",
             "robot.xml:8: found no <Mass> in <Body>, expected one"},
    BadInput{"MassZero", "robot.xml", "<total>0.3", "<total>0",
             "robot.xml:14: found '0' in <total>, expected a number from 1e-06 to 10000 kg"},
    BadInput{"MassNegative", "end.xml", "<total>0.1", "<total>-0.1",
             "end.xml:9: found '-0.1' in <total>, expected a number from 1e-06 to 10000 kg"},
    BadInput{"MassWithoutTotal", "robot.xml", "<total>0.3</total>", "",
             "robot.xml:13: found neither <total> nor <density> in <Mass>, expected one of them"},
    BadInput{"MassOfHugeDensity", "robot.xml", "<density>1000", "<density>1e9",
             "robot.xml:23: found a density that makes 113097 kg, expected a mass from 1e-06 to 10000 kg"},
    BadInput{"UnknownMassType", "end.xml", "type=\"custom\"", "type=\"cone\"",
             "end.xml:8: found type 'cone' in <Mass>, expected 'custom', 'box', 'sphere', 'cylinder' or 'mimicgeom'"},
    BadInput{
        "MassOfAllBodies", "end.xml", "<Body name", "<Mass type=\"mimicgeom\"><total>1</total></Mass><Body name",
        "end.xml:2: found a <Mass> of a KinBody that is not type='mimicgeom' with a <density>, expected that, or a "
        "<Mass> in each <Body>"},
    BadInput{"AdjacentBodyUnknown", "robot.xml", "<KinBody name=\"body\">",
             "<KinBody name=\"body\"><adjacent>Head Hat</adjacent>",
             "robot.xml:6: found unknown body 'Hat' in <adjacent>, expected one of"},
    BadInput{"OneAdjacentBody", "robot.xml", "<KinBody name=\"body\">",
             "<KinBody name=\"body\"><adjacent>Head</adjacent>",
             "robot.xml:6: found 'Head' in <adjacent>, expected the names of two bodies"},
    BadInput{"InertiaOfSixNumbers", "end.xml", custom_inertia, "1 1 1 0 0 0",
             "end.xml:11: found '1 1 1 0 0 0' in <inertia>, expected 9 numbers"},
    BadInput{"InertiaNotPositive", "end.xml", custom_inertia, "1 0 0 0 -1 0 0 0 1",
             "end.xml:8: found an inertia that is not positive definite in <Mass>, expected a symmetric matrix"},
    BadInput{"InertiaWithLargeProducts", "end.xml", custom_inertia, "1 2 0 2 1 0 0 0 1",
             "end.xml:8: found an inertia that is not positive definite in <Mass>, expected"},
    BadInput{"InertiaNotSymmetric", "end.xml", custom_inertia, "1 0.1 0 0 1 0 0 0 1",
             "end.xml:8: found an inertia that is not positive definite in <Mass>, expected a symmetric"},
    BadInput{"InertiaZero", "end.xml", custom_inertia, "0 0 0 0 0 0 0 0 0",
             "end.xml:8: found an inertia that is not positive definite in <Mass>, expected"},
    BadInput{"MimicWithoutGeometry", "robot.xml",
             "<Geom type=\"sphere\">\n        <radius>0.03</radius>\n      </Geom>", "",
             "robot.xml:20: found <Mass> of a body without <Geom>, expected another type, or a <Geom>"},
    // Geometry.
    BadInput{"BoxSideZero", "robot.xml", "0.01 0.1 0.02", "0.01 0 0.02",
             "robot.xml:11: found '0' in <extents>, expected a number from 1e-06 to 10000 m"},
    BadInput{"BoxSideNegative", "environment.xml", "8 8 0.5", "8 8 -0.5",
             "environment.xml:12: found '-0.5' in <extents>, expected a number from 1e-06 to 10000 m"},
    BadInput{"TwoExtents", "robot.xml", "0.01 0.1 0.02", "0.01 0.1",
             "robot.xml:11: found '0.01 0.1' in <extents>, expected 3 numbers"},
    BadInput{"RadiusZero", "robot.xml", "<radius>0.03", "<radius>0",
             "robot.xml:20: found '0' in <radius>, expected a number from"},
    BadInput{"NoHeight", "end.xml", "<height>0.06</height>", "",
             "end.xml:3: found no <height> in <Geom>, expected one"},
    BadInput{"RadiusOfABox", "robot.xml", "<extents>0.01 0.1 0.02</extents>", "<radius>1</radius>",
             "robot.xml:11: found <radius> in <Geom>, expected <extents>, <translation>"},
    BadInput{"UnknownShape", "robot.xml", "type=\"sphere\"", "type=\"cone\"",
             "robot.xml:19: found type 'cone' in <Geom>, expected 'box', 'sphere', 'cylinder', 'trimesh' or"},
    BadInput{"NegativeFriction", "end.xml", "<friction>0.5", "<friction>-0.5",
             "end.xml:6: found '-0.5' in <friction>, expected a number from 0 to 1000"},
    BadInput{"FarAway", "robot.xml", "<translation>0 0.2 0", "<translation>0 2e4 0",
             "robot.xml:18: found '2e4' in <translation>, expected a number from -10000 to 10000 m"},
    BadInput{"RotationAboutNothing", "robot.xml", "<translation>0 0.2 0</translation>",
             "<rotationaxis>0 0 0 90</rotationaxis>",
             "robot.xml:18: found '0 0 0 90' in <rotationaxis>, expected an axis that is not 0"},
    BadInput{"RotationMatrixThatScales", "robot.xml", "<translation>0 0.2 0</translation>",
             "<rotationmat>2 0 0 0 2 0 0 0 2</rotationmat>",
             "robot.xml:18: found '2 0 0 0 2 0 0 0 2' in <rotationmat>, expected a rotation, row by row"},
    BadInput{"RotationMatrixThatMirrors", "robot.xml", "<translation>0 0.2 0</translation>",
             "<rotationmat>1 0 0 0 1 0 0 0 -1</rotationmat>",
             "robot.xml:18: found '1 0 0 0 1 0 0 0 -1' in <rotationmat>, expected a rotation, row by row"},
    BadInput{"QuaternionZero", "robot.xml", "<translation>0 0.2 0</translation>", "<quat>0 0 0 0</quat>",
             "robot.xml:18: found '0 0 0 0' in <quat>, expected a quaternion w x y z that is not 0"},
    // Joints and the chain.
    BadInput{"UnknownBodyInJoint", "robot.xml", "<body>TailEnd</body>", "<body>Tail</body>",
             "robot.xml:26: found unknown body 'Tail' in <body>, expected one of TailEnd, Middle, Head"},
    BadInput{"UnknownBodyInOffsetfrom", "robot.xml", "<offsetfrom>Head", "<offsetfrom>Hat",
             "robot.xml:35: found unknown body 'Hat' in <offsetfrom>, expected one of TailEnd, Middle, Head"},
    BadInput{"OneBody", "robot.xml", "<body>TailEnd</body>", "",
             "robot.xml:26: found 1 <body> in joint 'J1', expected two bodies"},
    BadInput{"SameBodyTwice", "robot.xml", "<body>TailEnd</body>", "<body>Middle</body>",
             "robot.xml:26: found body 'Middle' twice in joint 'J1', expected two bodies"},
    BadInput{"JointTwice", "robot.xml", "name=\"J2\"", "name=\"J1\"",
             "robot.xml:35: found a second joint 'J1', expected another name; the first is in line 26"},
    BadInput{"NameThatTurnsText", "robot.xml", "name=\"J2\"", "name=\"J\u202E2\"",
             "robot.xml:35: found a character that turns the direction of text in the name 'J<U+202E>2', expected a"},
    BadInput{"NameOfTwoLines", "robot.xml", "name=\"J2\"", "name=\"J&#10;2\"",
             "robot.xml:35: found control characters in the name 'J 2', expected a name of one line"},
    BadInput{"SliderJoint", "robot.xml", "name=\"J2\" type=\"hinge\"", "name=\"J2\" type=\"slider\"",
             "robot.xml:35: found type 'slider' in <Joint>, expected 'hinge'"},
    BadInput{"AxisZero", "robot.xml", "<axis>2 0 0", "<axis>0 0 0",
             "robot.xml:30: found '0 0 0' in <axis>, expected a direction that is not 0"},
    BadInput{
        "LimitsBelowTheStart", "robot.xml", j1_limits, "<limitsdeg>-80 -30</limitsdeg>",
        "robot.xml:33: found '-80 -30' in <limitsdeg> of joint 'J1', expected limits that include 0, because every "
        "joint starts at angle 0"},
    BadInput{"LimitsAboveTheStart", "robot.xml", "<limits>-0.5 0.75</limits>", "<limits>0.01 0.75</limits>",
             "robot.xml:43: found '0.01 0.75' in <limits> of joint 'J2', expected limits that include 0"},
    BadInput{"LowerStopOnly", "robot.xml", j1_limits, "<lostop>-45</lostop>",
             "robot.xml:26: found no <histop> in <Joint>"},
    BadInput{"UpperStopBesideLimits", "robot.xml", j1_limits, j1_limits + "<histop>9</histop>",
             "robot.xml:33: found both <limitsdeg> and <histop> in <Joint>, expected one of them"},
    BadInput{"StopsThatExclude0", "robot.xml", j1_limits, "<lostop>-45</lostop><histop>-9</histop>",
             "robot.xml:33: found '-45 -9' in <lostop> of joint 'J1', expected limits that include 0"},
    BadInput{"SpeedTwice", "robot.xml", "<maxvel>4.5</maxvel>", "<maxvel>4.5</maxvel><maxveldeg>4</maxveldeg>",
             "robot.xml:26: found both <maxvel> and <maxveldeg> in <Joint>, expected one of them"},
    BadInput{"NoLimits", "robot.xml", j1_limits, "",
             "robot.xml:26: found neither <limitsdeg> nor <limits> in <Joint>, expected one of them"},
    BadInput{"LimitsInWrongOrder", "robot.xml", "-45 90", "90 -45",
             "robot.xml:33: found '90 -45' in <limitsdeg>, expected the lower limit first"},
    BadInput{"LimitsBeyondATurn", "robot.xml", "-45 90", "-45 361",
             "robot.xml:33: found '361' in <limitsdeg>, expected a number from -360 to 360 degrees"},
    BadInput{"TorqueZero", "robot.xml", "<maxtorque>0.4", "<maxtorque>0",
             "robot.xml:31: found '0' in <maxtorque>, expected a number from"},
    BadInput{"NoSpeed", "robot.xml", "<maxvel>4.5</maxvel>", "",
             "robot.xml:26: found no <maxvel> in <Joint>, expected one"},
    BadInput{"GainZero", "robot.xml", "<gain>20", "<gain>0",
             "robot.xml:3: found '0' in <gain>, expected a number from 0.001 to 10000 1/s"},
    BadInput{"GainWithWhichTheServoOvershootsInEveryStep", "robot.xml", "<gain>20", "<gain>5000",
             "robot.xml:3: found a gain of 5000 1/s with steps of"},
    BadInput{"ServoPeriodZero", "robot.xml", "ms\">2<", "ms\">0<",
             "robot.xml:4: found '0' in <period>, expected a number from 0.1 to 100 ms"},
    BadInput{"LatencyTooLong", "robot.xml", "</period>", "</period><latency>101</latency>",
             "robot.xml:4: found '101' in <latency>, expected a number from 0 to 100 ms"},
    BadInput{"LatencyOfNanoseconds", "robot.xml", "</period>", "</period><latency>0.0005</latency>",
             "robot.xml:4: found '0.0005' in <latency>, expected a whole number of microseconds"},
    BadInput{"ContactNoiseAboveOne", "top.xml", "<seed>", "<contactNoise>1.1</contactNoise><seed>",
             "top.xml:8: found '1.1' in <contactNoise>, expected a number from 0 to 1"},
    BadInput{"ContactNoiseNegative", "top.xml", "<seed>", "<contactNoise>-0.1</contactNoise><seed>",
             "top.xml:8: found '-0.1' in <contactNoise>, expected a number from 0 to 1"},
    BadInput{"ContactNoiseNoNumber", "top.xml", "<seed>", "<contactNoise>nan</contactNoise><seed>",
             "top.xml:8: found 'nan' in <contactNoise>, expected a number from 0 to 1"},
    // Modules. J1 and J2 of the small robot are kernel joints 1 and 0.
    BadInput{"JointWithoutModule", "robot.xml", "</Robot>", "<module joint=\"J1\" node=\"5\"/></Robot>",
             "robot.xml:1: found no <module> for joint 'J2' in <Robot>, expected a module for each joint, or none"},
    BadInput{"ModuleOfUnknownJoint", "robot.xml", "</Robot>", "\n<module joint=\"J3\" node=\"5\"/></Robot>",
             "robot.xml:47: found unknown joint 'J3', expected one of J1, J2"},
    BadInput{"TwoModulesForOneJoint", "robot.xml", "</Robot>",
             "<module joint=\"J1\" node=\"5\"/>\n<module joint=\"J1\" node=\"6\"/></Robot>",
             "robot.xml:47: found a second module for joint 'J1', expected one; the first is in line 46"},
    BadInput{"TwoModulesWithOneNode", "robot.xml", "</Robot>",
             "<module joint=\"J1\" node=\"5\"/>\n<module joint=\"J2\" node=\"0x5\"/></Robot>",
             "robot.xml:47: found a second module with node 5, expected another node; the first is in line 46"},
    BadInput{"TwoModulesWithOneSerial", "robot.xml", "</Robot>",
             "<module joint=\"J1\" node=\"5\" serial=\"16\"/>\n"
             "<module joint=\"J2\" node=\"6\" serial=\"0x10\"/></Robot>",
             "robot.xml:47: found a second module with serial '0x10', expected another serial; the first is in line"},
    BadInput{"ModuleWithTheNodeOfTheHost", "robot.xml", "</Robot>", "<module joint=\"J1\" node=\"127\"/></Robot>",
             "robot.xml:46: found node '127' in <module>, expected a whole number from 1 to 126 (127 is the host)"},
    BadInput{"ModuleWithNodeZero", "robot.xml", "</Robot>", "<module joint=\"J1\" node=\"0\"/></Robot>",
             "robot.xml:46: found node '0' in <module>, expected a whole number from 1 to 126"},
    BadInput{"ModuleWithANodeThatIsNoNumber", "robot.xml", "</Robot>", "<module joint=\"J1\" node=\"5a\"/></Robot>",
             "robot.xml:46: found node '5a' in <module>, expected a whole number from 1 to 126"},
    BadInput{"ModuleWithANegativeNode", "robot.xml", "</Robot>", "<module joint=\"J1\" node=\"-1\"/></Robot>",
             "robot.xml:46: found node '-1' in <module>, expected a whole number from 1 to 126"},
    BadInput{"ModuleWithoutNode", "robot.xml", "</Robot>", "<module joint=\"J1\"/></Robot>",
             "robot.xml:46: found no attribute 'node' in <module>, expected one"},
    BadInput{"ModuleWithoutJoint", "robot.xml", "</Robot>", "<module node=\"5\"/></Robot>",
             "robot.xml:46: found no attribute 'joint' in <module>, expected one"},
    BadInput{"SerialTooLarge", "robot.xml", "</Robot>",
             "<module joint=\"J1\" node=\"5\" serial=\"0x100000000\"/></Robot>",
             "robot.xml:46: found serial '0x100000000' in <module>, expected a whole number from 1 to 4294967295"},
    BadInput{"SerialZero", "robot.xml", "</Robot>", "<module joint=\"J1\" node=\"5\" serial=\"0x0\"/></Robot>",
             "robot.xml:46: found serial '0x0' in <module>, expected a whole number from 1"},
    BadInput{"SerialEmpty", "robot.xml", "</Robot>", "<module joint=\"J1\" node=\"5\" serial=\"0x\"/></Robot>",
             "robot.xml:46: found serial '0x' in <module>, expected a whole number from 1"},
    BadInput{"ModuleInsideABody", "robot.xml", "<KinBody name=\"body\">",
             "<KinBody name=\"body\"><module joint=\"J1\" node=\"5\"/>",
             "robot.xml:6: found <module> in <KinBody>, expected <Body>, <KinBody>, <Joint>"},
    BadInput{"BodyWithoutJoint", "robot.xml", "<Body name=\"Head\">",
             "<Body name=\"Lost\"><Mass type=\"box\"><total>1</total><extents>1 1 1</extents></Mass></Body>\n"
             "<Body name=\"Head\">",
             "robot.xml:17: found body 'Lost', which no joint connects to the head 'Head', expected one connected"},
    BadInput{"Ring", "robot.xml", "<body>TailEnd</body>", "<body>Head</body>",
             "robot.xml:35: found joint 'J2' in a ring of bodies, expected a chain with two ends"},
    BadInput{"Branch", "robot.xml", "<KinBody name=\"body\">",
             "<KinBody name=\"body\"><KinBody file=\"end.xml\" prefix=\"Arm\"/><Joint name=\"J0\" type=\"hinge\">"
             "<body>Middle</body><body>ArmEnd</body><axis>1 0 0</axis><maxtorque>1</maxtorque><maxvel>1</maxvel>"
             "<limits>0 1</limits></Joint>",
             "robot.xml:35: found joint 'J2' as the third joint of body 'Middle', expected an unbranched chain"},
    BadInput{"TwoHeads", "end.xml", "name=\"End\"", "name=\"Ahead\"",
             "robot.xml:26: found unknown body 'TailEnd' in <body>, expected one of TailAhead, Middle, Head"},
    BadInput{"FileIncludesItself", "end.xml", "<Body name", "<KinBody file=\"end.xml\"/><Body name",
             "end.xml:2: found a cycle: 'end.xml' includes itself, expected files that do not include themselves"},
    BadInput{"FileIncludesItsIncluder", "end.xml", "<Body name", "<KinBody file=\"x/../robot.xml\"/><Body name",
             "end.xml:2: found a cycle: 'x/../robot.xml' includes itself, expected"},
    BadInput{"BodyBesideFile", "robot.xml", "prefix=\"Tail\"/>", "prefix=\"Tail\"><Body name=\"x\"/></KinBody>",
             "robot.xml:7: found <Body> in <KinBody>, expected <translation>, <rotationaxis>, <quat>"},
    // Actuation.
    BadInput{"UnknownAlgorithm", "actuation.xml", "DirectJointAccess", "Local Adaptive Touch",
             "actuation.xml:8: found unknown algorithm 'Local Adaptive Touch', expected one of DirectJointAccess, "
             "PatternGenerator_sinusoidal, "},
    BadInput{"MaskTooLong", "actuation.xml", "joints=\"11\"", "joints=\"111\"",
             "actuation.xml:4: found joints '111', expected 2 characters 0 or 1"},
    BadInput{"MaskTooShort", "actuation.xml", "joints=\"11\"", "joints=\"\"",
             "actuation.xml:4: found joints '', expected 2 characters 0 or 1"},
    BadInput{"MaskOfOtherCharacters", "actuation.xml", "joints=\"11\"", "joints=\"1x\"",
             "actuation.xml:4: found joints '1x', expected 2 characters 0 or 1"},
    BadInput{"NoMask", "actuation.xml", "<jointConfiguration joints=\"11\"/>", "",
             "actuation.xml:3: found no <jointConfiguration> in <actuationModule>, expected one"},
    BadInput{"UnknownParameter", "actuation.xml", "name=\"angle\"", "name=\"amplitude\"",
             "actuation.xml:10: found unknown parameter 'amplitude' of DirectJointAccess, expected one of angle"},
    BadInput{"ParameterOutOfRange", "actuation.xml", "value=\"30\"", "value=\"95\"",
             "actuation.xml:5: found '95' for parameter 'amplitude', expected a number from 0 to 90 deg"},
    BadInput{"ParameterNotANumber", "actuation.xml", "value=\"30\"", "value=\"inf\"",
             "actuation.xml:5: found 'inf' for parameter 'amplitude', expected a number from 0 to 90 deg"},
    BadInput{"ParameterOfManyDigits", "actuation.xml", "value=\"30\"", "value=\"" + hundred_digits + "\"",
             "actuation.xml:5: found '" + hundred_digits.substr(0, 60) + "...' for parameter 'amplitude', expected"},
    BadInput{"ParameterInAnotherUnit", "actuation.xml", "value=\"30\" unit=\"deg\"", "value=\"0.5\" unit=\"rad\"",
             "actuation.xml:5: found unit 'rad' for parameter 'amplitude', expected unit 'deg'"},
    BadInput{"ParameterTwice", "actuation.xml", " joint=\"J1\"", "",
             "actuation.xml:6: found parameter 'amplitude' twice for the same joints, expected it once"},
    BadInput{"ParameterOfUnknownJoint", "actuation.xml", "joint=\"J1\"", "joint=\"J9\"",
             "actuation.xml:6: found unknown joint 'J9', expected one of J1, J2"},
    BadInput{"ParameterOfAnUndrivenJoint", "actuation.xml", "value=\"5\"", "value=\"5\" joint=\"J1\"",
             "actuation.xml:10: found a joint that this module does not drive, 'J1', expected one of J2"},
    BadInput{"NoModule", "actuation.xml", "<actuation>", "<actuation/><!--",
             "actuation.xml:1: found a comment without an end, expected -->"},
    BadInput{"FifthModule", "actuation.xml", "</actuation>",
             "<actuationModule name=\"DirectJointAccess\"><jointConfiguration joints=\"11\"/></actuationModule>"
             "<actuationModule name=\"DirectJointAccess\"><jointConfiguration joints=\"11\"/></actuationModule>\n"
             "<actuationModule name=\"DirectJointAccess\"><jointConfiguration joints=\"11\"/></actuationModule>"
             "</actuation>",
             "actuation.xml:13: found a fifth <actuationModule>, expected at most 4"},
    BadInput{"TooManyBroadcasts", "actuation.xml", "<validRobot robotName=\"robot.xml\"/>",
             "<actuationModule name=\"PatternGenerator_coupled_oscillator\"><jointConfiguration joints=\"11\"/>"
             "</actuationModule><actuationModule name=\"PatternGenerator_coupled_oscillator\">"
             "<jointConfiguration joints=\"11\"/></actuationModule>\n"
             "<actuationModule name=\"PatternGenerator_coupled_oscillator\"><jointConfiguration joints=\"10\"/>"
             "</actuationModule>",
             "actuation.xml:3: found a configuration that the control kernel rejects with <actuationModule>: more than "
             "two broadcasting algorithms on one joint, expected a configuration that it accepts"},
    // Environment.
    BadInput{"DynamicBodyWithoutMass", "environment.xml", "type=\"static\"", "type=\"dynamic\"",
             "environment.xml:9: found no <Mass> in <Body>, expected one"},
    BadInput{"BodyTypeLeftOutInEnvironment", "environment.xml", " type=\"static\"", "",
             "environment.xml:9: found no type in <Body>, expected 'static' for an object that stays"},
    BadInput{"JointInEnvironment", "environment.xml", "<KinBody name=\"floor\">", "<KinBody name=\"floor\"><Joint/>",
             "environment.xml:8: found <Joint> in <KinBody>, expected <Body>, <KinBody>, <Mass>, <translation>"},
    BadInput{"RobotInEnvironment", "environment.xml", "</Environment>", "<Robot/></Environment>",
             "environment.xml:17: found <Robot> in <Environment>, expected <physicsengine>, <KinBody>"},
    BadInput{"OtherPhysicsEngine", "environment.xml", "type=\"ode\"", "type=\"bullet\"",
             "environment.xml:2: found type 'bullet' in <physicsengine>, expected 'ode', 'reduced' or 'mujoco'"},
    BadInput{"PropertiesOfBothEngines", "environment.xml", "</odeproperties>", "</odeproperties><reducedproperties/>",
             "environment.xml:6: found <reducedproperties> beside <odeproperties>, expected one of them"},
    BadInput{"Gravity", "environment.xml", "0 0 -9.81", "0 0 -9.81e9",
             "environment.xml:4: found '-9.81e9' in <gravity>, expected a number from -1000 to 1000 m/s^2"},
    BadInput{"SelfCollision", "environment.xml", "<selfcollision>1", "<selfcollision>yes",
             "environment.xml:5: found 'yes' in <selfcollision>, expected 0 or 1"},
    BadInput{"PoseOfFiveNumbers", "environment.xml", "0 0 0.1,0 0 0,", "0 0 0.1,0 0,",
             "environment.xml:18: found the comment 'Pose: ,0 0 0.1,0 0,', expected one 'Pose: ,X Y Z,A B C,'"},
    BadInput{"PoseNotFinite", "environment.xml", "0 0 0.1,0 0 0,", "0 0 nan,0 0 0,",
             "environment.xml:18: found the comment 'Pose: ,0 0 nan,0 0 0,', expected one"},
    BadInput{"TwoPoses", "environment.xml", "</Environment>", "</Environment><!-- Pose: ,0 0 1,0 0 0, -->",
             "environment.xml:18: found a second comment 'Pose: ,0 0 0.1,0 0 0,', expected one"});

INSTANTIATE_TEST_SUITE_P(Small, BadScenario, cases, [](const auto& bad) { return bad.param.name; });

TEST(BadScenarioFiles, TwoEndsWithTheNameHeadAreRefused) {
  MemoryFiles files = small_scenario();
  files.replace("end.xml", "name=\"End\"", "name=\"Ahead\"").replace("robot.xml", "TailEnd", "TailAhead");
  EXPECT_EQ(
      refusal(files),
      "robot.xml:17: found two heads, 'TailAhead' and 'Head', expected one end of the robot with a name that ends "
      "with 'Head'");
}

TEST(BadScenarioFiles, AllAlgorithmsThatAreMissingAreNamed) {
  MemoryFiles files = small_scenario();
  files.replace("actuation.xml", "\"DirectJointAccess\"", "\"my_wave\"");
  files.replace("actuation.xml", "</actuation>",
                "<actuationModule name=\"my_reflex\"/><actuationModule name=\"my_wave\"/></actuation>");
  try {
    static_cast<void>(files.scenario());
    ADD_FAILURE() << "accepted";
  } catch (const UnknownAlgorithms& error) {
    EXPECT_EQ(error.names(), (std::vector<std::string>{"my_wave", "my_reflex"}));
    EXPECT_EQ(std::string(error.what()).substr(0, 50), "actuation.xml:8: found unknown algorithm 'my_wave'");
  }
}

TEST(BadScenarioFiles, ARobotWithoutJointsIsRefused) {
  MemoryFiles files = small_scenario();
  files.texts["robot.xml"] = "\n<Robot><KinBody file=\"end.xml\"/></Robot>";
  EXPECT_EQ(refusal(files), "robot.xml:2: found a robot without joints, expected 1 to 64 joints");
}

TEST(BadScenarioFiles, ARobotOfTooManyBodiesIsRefused) {
  MemoryFiles files = small_scenario();
  std::string bodies;
  for (int i = 0; i < 66; ++i) {
    bodies += "<KinBody file=\"end.xml\" prefix=\"b" + std::to_string(i) + "\"/>";
  }
  files.texts["robot.xml"] = "<Robot>" + bodies + "</Robot>";
  EXPECT_EQ(refusal(files), "end.xml:2: found more than 65 bodies, expected at most 65");
}

TEST(BadScenarioFiles, ARobotOfTooManyJointsIsRefused) {
  MemoryFiles files = small_scenario();
  std::string joints;
  for (int i = 0; i < 65; ++i) {
    joints += "<Joint name=\"J" + std::to_string(i) +
              "\" type=\"hinge\"><body>a</body><body>b</body><axis>1 0 0</axis>" +
              "<maxtorque>1</maxtorque><maxvel>1</maxvel><limits>0 1</limits></Joint>\n";
  }
  files.texts["robot.xml"] = "<Robot>" + joints + "</Robot>";
  EXPECT_EQ(refusal(files), "robot.xml:65: found more than 64 joints, expected 1 to 64");
}

TEST(BadScenarioFiles, ACycleOverTwoFilesIsRefused) {
  MemoryFiles files = small_scenario();
  files.texts["a.xml"] = "<KinBody file=\"b.xml\"/>";
  files.texts["b.xml"] = "<KinBody>\n<KinBody file=\"a.xml\"/></KinBody>";
  files.replace("robot.xml", "end.xml", "a.xml");
  EXPECT_EQ(refusal(files),
            "b.xml:2: found a cycle: 'a.xml' includes itself, expected files that do not include themselves");
}

TEST(BadScenarioFiles, FilesNestedTooDeepAreRefused) {
  MemoryFiles files = small_scenario();
  for (int i = 0; i < 100; ++i) {
    files.texts["n" + std::to_string(i)] = "<KinBody file=\"n" + std::to_string(i + 1) + "\"/>";
  }
  files.replace("robot.xml", "end.xml", "n0");
  EXPECT_NE(refusal(files).find("nested deeper than 32"), std::string::npos) << refusal(files);
}

TEST(BadScenarioFiles, FilesThatDoubleAtEveryLevelAreRefused) {
  MemoryFiles files = small_scenario();
  for (int i = 0; i < 25; ++i) {
    const std::string next = "<KinBody file=\"n" + std::to_string(i + 1) + "\"/>";
    files.texts["n" + std::to_string(i)] = "<KinBody>" + next + next + "</KinBody>";
  }
  files.texts["n25"] = "<KinBody/>";
  // In the environment, where KinBodies may be empty.
  files.replace("environment.xml", "</Environment>", "<KinBody file=\"n10\"/></Environment>");
  EXPECT_NE(refusal(files).find("found more than 1000 included files"), std::string::npos) << refusal(files);
}

TEST(BadScenarioFiles, TagsNestedTooDeepAreRefused) {
  for (const int depth : {40, 90, 200, 100'000}) {
    MemoryFiles files = small_scenario();
    std::string nested;
    for (int i = 0; i < depth; ++i) {
      nested += "<KinBody>";
    }
    for (int i = 0; i < depth; ++i) {
      nested += "</KinBody>";
    }
    files.texts["end.xml"] = nested;
    EXPECT_EQ(refusal(files).substr(0, 15), "end.xml:1: foun") << refusal(files);
  }
}

TEST(BadScenarioFiles, EveryTruncationOfEveryFileIsRefusedOrReadWithoutACrash) {
  const MemoryFiles whole = small_scenario();
  for (const auto& [name, text] : whole.texts) {
    const std::size_t end_of_root = text.rfind("</") + 2;
    for (std::size_t size = 0; size < end_of_root; size += 7) {
      MemoryFiles files = small_scenario();
      files.texts[name].resize(size);
      EXPECT_NE(refusal(files), "nothing") << name << " cut to " << size << " bytes";
    }
  }
}

}  // namespace
}  // namespace proleg::sim
