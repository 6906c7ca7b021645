// <AttachedSensor> in the file of a robot.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>

#include "memory_files.hpp"
#include "shared/gait/registry.hpp"
#include "sim/scenario/module_sensors.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

constexpr double radians = std::numbers::pi / 180.0;

/// The small scenario with these tags at the end of the robot's file, from line 45 on.
MemoryFiles with(const std::string& tags) {
  MemoryFiles files = small_scenario();
  return files.replace("robot.xml", "</KinBody>\n</Robot>", "</KinBody>" + tags + "</Robot>");
}

std::string message_for(const std::string& tags) {
  MemoryFiles files = with(tags);
  try {
    static_cast<void>(files.scenario());
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string sensor(const std::string& name, const std::string& part, const std::string& properties) {
  return "<AttachedSensor name=\"" + name + "\">" + part + properties + "</AttachedSensor>";
}

const std::string head = "<link>Head</link>";
const std::string tactile = "<sensor type=\"TactileSensor\"/>";

TEST(AttachedSensors, AreNoneWithoutTags) { EXPECT_TRUE(small_scenario().scenario().robot.sensors.empty()); }

// Listing B.3 of the thesis, in a file of its own.
TEST(AttachedSensors, ATactileSensorIsDescribedInItsOwnFile) {
  MemoryFiles files = with(sensor("bumper", head, "<sensor file=\"tactile.sensor.xml\"/>"));
  files.texts["tactile.sensor.xml"] = "<sensor type=\"TactileSensor\">\n<power>1</power>\n</sensor>\n";
  const Scenario scenario = files.scenario();
  ASSERT_EQ(scenario.robot.sensors.size(), 1U);
  const AttachedSensor& read = scenario.robot.sensors[0];
  EXPECT_EQ(read.name, "bumper");
  EXPECT_EQ(read.kind, SensorKind::touch);
  EXPECT_EQ(read.part, 0U) << "links count from the head";
  EXPECT_FALSE(read.extents);
  EXPECT_FALSE(read.input);
  EXPECT_EQ(std::ranges::count(scenario.sources, "tactile.sensor.xml", &SourceFile::path), 1)
      << "recordings keep the file";
}

// Listing B.4 of the thesis. In OpenRAVE, angles are in degrees, and the last one belongs to the scan.
TEST(AttachedSensors, ALaserHasTheRaysOfListingB4) {
  const Scenario scenario =
      with(sensor("eye", "<link>TailEnd</link><translation>0 0.01 0.02</translation>",
                  "<sensor type=\"BaseLaser2D\"><minangle>-1</minangle><maxangle>1</maxangle><resolution>1</resolution>"
                  "<maxrange>1</maxrange><scantime>1</scantime><render>1</render><power>1</power></sensor>"))
          .scenario();
  const AttachedSensor& read = scenario.robot.sensors.at(0);
  EXPECT_EQ(read.kind, SensorKind::laser);
  EXPECT_EQ(read.part, 2U);
  EXPECT_EQ(read.pose.position, Eigen::Vector3d(0, 0.01, 0.02));
  EXPECT_DOUBLE_EQ(read.scan.first_angle, -1 * radians);
  EXPECT_DOUBLE_EQ(read.scan.angle_step, 1 * radians);
  EXPECT_EQ(read.scan.rays, 3U);
  EXPECT_EQ(read.scan.range, 1.0);
  EXPECT_EQ(read.scan.period_us, 1'000'000U);
}

TEST(AttachedSensors, ALaserHasAsManyRaysAsTheResolutionFits) {
  const auto rays = [](const std::string& from, const std::string& to, const std::string& resolution) {
    return with(sensor("eye", head,
                       "<sensor type=\"BaseLaser2D\"><minangle>" + from + "</minangle><maxangle>" + to +
                           "</maxangle><resolution>" + resolution + "</resolution><maxrange>5</maxrange></sensor>"))
        .scenario()
        .robot.sensors.at(0)
        .scan.rays;
  };
  EXPECT_EQ(rays("-135", "135", "0.25"), 1081U);
  EXPECT_EQ(rays("0", "1", "0.1"), 11U) << "0.1 is no binary fraction";
  EXPECT_EQ(rays("0", "10", "3"), 4U);
  EXPECT_EQ(rays("30", "30", "1"), 1U);
}

TEST(AttachedSensors, ATouchSensorMayHaveABoxAndAnInput) {
  const AttachedSensor read =
      with(sensor("nose", head,
                  "<sensor type=\"tactilesensor\"><extents>0.01 0.002 0.02</extents><input>Front</input></sensor>"))
          .scenario()
          .robot.sensors.at(0);
  EXPECT_EQ(read.extents, Eigen::Vector3d(0.01, 0.002, 0.02));
  EXPECT_EQ(read.input, TouchInput::front);
}

TEST(AttachedSensors, CurrentIsOfAJointTheOthersOfLinks) {
  const Scenario scenario = with(sensor("a", "<joint>J1</joint>", "<sensor type=\"ServoCurrent\"/>") +
                                 sensor("b", head, "<sensor type=\"Inclinometer\"/>") +
                                 sensor("c", "<link>Middle</link>", "<sensor type=\"Accelerometer\"/>"))
                                .scenario();
  ASSERT_EQ(scenario.robot.sensors.size(), 3U);
  EXPECT_EQ(scenario.robot.sensors[0].kind, SensorKind::servo_current);
  EXPECT_EQ(scenario.robot.sensors[0].part, 1U) << "joints count from the head";
  EXPECT_EQ(scenario.robot.sensors[1].kind, SensorKind::inclinometer);
  EXPECT_EQ(scenario.robot.sensors[2].kind, SensorKind::accelerometer);
  EXPECT_EQ(scenario.robot.sensors[2].part, 1U);
}

TEST(AttachedSensors, WithoutPowerAreLeftOut) {
  const Scenario scenario =
      with(sensor("a", head, "<sensor type=\"TactileSensor\"><power>0</power></sensor>")).scenario();
  EXPECT_TRUE(scenario.robot.sensors.empty());
  EXPECT_TRUE(std::ranges::find(scenario.remarks, "robot.xml:45: sensor 'a' is switched off") !=
              scenario.remarks.end());
}

TEST(BadAttachedSensors, AreNamedWithFileLineFoundAndExpected) {
  const auto laser = [](const std::string& tags) {
    return sensor("eye", head, "<sensor type=\"BaseLaser2D\">" + tags + "</sensor>");
  };
  const std::string rest = "<resolution>1</resolution><maxrange>1</maxrange>";
  const std::pair<std::string, std::string> cases[] = {
      {sensor("a", "<link>Nose</link>", tactile),
       "robot.xml:45: found unknown link 'Nose', expected one of Head, Middle, TailEnd"},
      {sensor("a", "<joint>J9</joint>", "<sensor type=\"ServoCurrent\"/>"),
       "robot.xml:45: found unknown joint 'J9', expected one of J1, J2"},
      {sensor("a", "<joint>J1</joint>", tactile),
       "robot.xml:45: found <joint> of a sensor of type TactileSensor, expected <link>"},
      {sensor("a", head, "<sensor type=\"ServoCurrent\"/>"),
       "robot.xml:45: found <link> of a sensor of type ServoCurrent, expected <joint>"},
      {sensor("a", "", tactile), "robot.xml:45: found no <link> in <AttachedSensor>"},
      {sensor("a", head, ""), "robot.xml:45: found no <sensor> in <AttachedSensor>"},
      {sensor("a", head, "<sensor type=\"Camera\"/>"),
       "robot.xml:45: found type 'Camera' in <sensor>, expected one of TactileSensor, BaseLaser2D, ServoCurrent, "
       "Inclinometer, Accelerometer"},
      {sensor("a", head, "<sensor file=\"no.sensor.xml\"/>"), "robot.xml:45: found"},
      {sensor("a", head, tactile) + "\n" + sensor("a", head, tactile),
       "robot.xml:46: found a second sensor 'a', expected another name; the first is in line 45"},
      {sensor("a", head, "<sensor type=\"TactileSensor\"><input>front</input></sensor>") + "\n" +
           sensor("b", head, "<sensor type=\"TactileSensor\"><input>front</input></sensor>"),
       "robot.xml:46: found a second sensor at the input 'front' of this link, expected one; the first is in line 45"},
      {sensor("a", head, "<sensor type=\"TactileSensor\"><extents>0 1 1</extents></sensor>"),
       "robot.xml:45: found '0'"},
      {sensor("a", head, "<sensor type=\"TactileSensor\"><input>left</input></sensor>"), "robot.xml:45: found 'left'"},
      {sensor("a", head, "<sensor type=\"Inclinometer\"><maxrange>1</maxrange></sensor>"),
       "robot.xml:45: found <maxrange>"},
      {laser("<minangle>1</minangle><maxangle>-1</maxangle>" + rest),
       "robot.xml:45: found <maxangle> -1, expected at least <minangle>, 1"},
      {laser("<minangle>-300</minangle><maxangle>300</maxangle>" + rest),
       "robot.xml:45: found 600 degrees from <minangle> to <maxangle>, expected at most 360"},
      {laser("<minangle>0</minangle><maxangle>180</maxangle><resolution>0.1</resolution><maxrange>1</maxrange>"),
       "robot.xml:45: found 1801 rays, expected at most 1081"},
      {laser("<minangle>0</minangle><maxangle>1</maxangle><resolution>0</resolution><maxrange>1</maxrange>"),
       "robot.xml:45: found '0' in <resolution>"},
      {laser("<minangle>0</minangle><maxangle>1</maxangle><resolution>1</resolution><maxrange>-1</maxrange>"),
       "robot.xml:45: found '-1' in <maxrange>"},
      {laser("<minangle>0</minangle><maxangle>1</maxangle>" + rest + "<scantime>0</scantime>"),
       "robot.xml:45: found '0' in <scantime>"},
      {laser("<maxangle>1</maxangle>" + rest), "robot.xml:45: found no <minangle> in <sensor>"},
  };
  for (const auto& [tags, expected] : cases) {
    const std::string message = message_for(tags);
    EXPECT_EQ(message.substr(0, expected.size()), expected) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

constexpr Declaration about_probe{126, "SlopeProbe", "test", {}, {}, {}};

/// Reads readings of its module.
class SlopeProbe final : public ActuationModule {
 public:
  explicit constexpr SlopeProbe(std::uint8_t sensors) : sensors_(sensors) {}
  [[nodiscard]] const Declaration& declaration() const override { return about_probe; }
  [[nodiscard]] std::uint8_t senses_readings() const override { return sensors_; }
  void advance(const Surroundings& /*surroundings*/, const Tuning& /*tuning*/, const std::int32_t* /*state*/,
               std::int32_t* /*next*/) const override {}
  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* /*state*/) const override {
    return 0;
  }

 private:
  std::uint8_t sensors_;
};

constexpr SlopeProbe current_probe(JointReadings::servo_current);
constexpr SlopeProbe inclination_probe(JointReadings::servo_current | JointReadings::inclination);
constexpr SlopeProbe acceleration_probe(JointReadings::acceleration);

TEST(SensorsOfModules, AnAlgorithmThatNeedsOthersIsRefusedByName) {
  Scenario scenario = small_scenario().scenario();
  const auto require = [&scenario] { require_sensors(scenario, sensors_of_modules, "a module"); };
  EXPECT_NO_THROW(require());
  scenario.kernel.slots[2] = {&current_probe, JointMask::first(2)};
  EXPECT_NO_THROW(require()) << "every module measures the current of its servo";
  for (const auto& [probe, name] : {std::pair<const SlopeProbe*, std::string>{&inclination_probe, "inclination"},
                                    std::pair<const SlopeProbe*, std::string>{&acceleration_probe, "acceleration"}}) {
    scenario.kernel.slots[2].algorithm = probe;
    try {
      require();
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()),
                "actuation.xml: found SlopeProbe (3), which reads the " + name +
                    " of its link, expected an algorithm that reads what a module measures: touch and the current of "
                    "its servo (proleg simulate has all sensors)");
    }
  }
}

TEST(SensorsOfModules, AnAlgorithmWithRulesNeedsTheSensorsOfItsParametersAtAnyTime) {
  Scenario scenario = small_scenario().scenario();
  scenario.kernel.slots[2] = {find_algorithm("SensingModule_gait_selector"), JointMask::first(2)};
  const auto is_refused = [](const Scenario& tried) {
    try {
      require_sensors(tried, sensors_of_modules, "a module");
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(is_refused(scenario), "") << "without rules it needs no sensor";
  apply_setting(scenario, "3.feature_2=7");
  EXPECT_EQ(is_refused(scenario), "") << "the current";
  Scenario with_change = scenario;
  apply_setting(with_change, "3.feature_4=-8@50");
  EXPECT_NE(is_refused(with_change).find("which reads the angle of its joint"), std::string::npos)
      << is_refused(with_change);
  apply_setting(scenario, "3.second_feature_2=3");
  EXPECT_NE(is_refused(scenario).find("which reads the inclination of its link"), std::string::npos)
      << is_refused(scenario);
}

TEST(SensorsOfModules, ARobotWithoutModulesHasTouchOnly) {
  Scenario scenario = small_scenario().scenario();
  EXPECT_NO_THROW(require_sensors(scenario, 0, "a robot without modules"));
  scenario.kernel.slots[2] = {&current_probe, JointMask::first(2)};
  EXPECT_THROW(require_sensors(scenario, 0, "a robot without modules"), InputError);
}

}  // namespace
}  // namespace proleg::sim
