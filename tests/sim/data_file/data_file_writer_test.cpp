// A recording as a data file, read back.

#include "sim/data_file/data_file_writer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "shared/fixed/decimal.hpp"
#include "shared/gait/registry.hpp"
#include "sim/record/tsv.hpp"
#include "small_run.hpp"
#include "table_of.hpp"

namespace proleg::sim {
namespace {

constexpr double deg = 180.0 / std::numbers::pi;
constexpr double digits = 1e-8;  // nine significant digits

std::uint8_t parameter(std::string_view name) {
  return static_cast<std::uint8_t>(find_parameter(find_algorithm("PatternGenerator_sinusoidal")->declaration(), name));
}

std::string written(const Scenario& scenario, std::uint32_t ticks, const std::optional<Scenario>& masses = {}) {
  const TemporaryFolder folder;
  record_small(folder / "run.proleg", scenario, ticks);
  std::string text;
  write_data_file(Recording(folder / "run.proleg"), masses, [&](std::string_view part) { text += part; });
  return text;
}

/// Five joints, which the file lists from the tail, with the gait of the print: A = 30 degrees, T = 1 s, -88.73 degrees
/// from joint to joint of the file, every 31 ms.
Scenario scenario_of_the_print() {
  Scenario scenario = small_scenario();
  scenario.robot.links.assign(6, Link{});
  scenario.robot.joints.assign(5, Joint{});
  for (std::size_t i = 0; i < 5; ++i) {
    scenario.robot.joints[i].name = "J" + std::to_string(5 - i);
    scenario.robot.joints[i].file_index = 4 - i;
    scenario.robot.links[i].name = "L" + std::to_string(6 - i);
  }
  scenario.robot.links[5].name = "L1";
  scenario.joint_limits.assign(5, {-quarter_turn, quarter_turn});
  scenario.kernel.joint_count = 5;
  scenario.kernel.tick_period_us = 31'000;
  scenario.kernel.slots[0].group = JointMask::first(5);
  scenario.kernel.slots[2] = {};
  scenario.settings.clear();
  scenario.changes.clear();
  for (std::uint8_t joint = 0; joint < 5; ++joint) {
    const auto set = [&](std::string_view name, std::string_view value, Unit unit) {
      scenario.settings.push_back({0, joint, parameter(name), false, parse_decimal(value, unit).raw});
    };
    set("amplitude", "30", Unit::degree);
    set("frequency", "1", Unit::hertz);
    set("phase_difference", "88.73", Unit::phase_degree);
    set("phase", "-354.92", Unit::phase_degree);
  }
  return scenario;
}

TEST(DataFileWriter, TheGaitOfTheThesisGivesTheTenAnglesThatTheThesisPrints) {
  const ReadTable table = table_of_text(written(scenario_of_the_print(), 2));
  const double angles[2][5] = {{5.80648, -29.297, -7.10298, 28.9827, 8.38557},
                               {11.3934, -27.4934, -12.6101, 26.9354, 13.802}};
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t joint = 0; joint < 5; ++joint) {
      const std::string part = ".J" + std::to_string(joint + 1);
      EXPECT_NEAR(table.number(row, "Angle" + part), angles[row][joint], 0.005);
      EXPECT_EQ(table.number(row, "Time" + part), row == 0 ? 0.031 : 0.062);
    }
  }
}

TEST(DataFileWriter, TheHeaderIsThatOfTheThesis) {
  const std::string text = written(scenario_of_the_print(), 2);
  EXPECT_EQ(
      text.find(
          "<dataroot>\n  <header>\n    <PatternGenerator_sinusoidal parts=\"5\" types=\"7\" names=\"J1 J2 J3 J4 "
          "J5\">\n      <typenames>Angle Time Phase_Difference Frequency realtime simtime stepcount</typenames>\n"),
      0U)
      << text.substr(0, 400);
  EXPECT_NE(text.find("    <tactile parts=\"12\" types=\"6\" names=\"L1.rear L1.front "), std::string::npos);
  EXPECT_NE(text.find("    <robot_data parts=\"6\" types=\"16\" names=\"L1 L2 L3 L4 L5 L6\" jointnames=\"J1 "),
            std::string::npos);
  EXPECT_NE(
      text.find("  <round number=\"0\">\n    <PatternGenerator_sinusoidal>\n      <frame index=\"0\" realtime=\"31\" "
                "simtime=\"31\">\n        <Angle>"),
      std::string::npos);
}

TEST(DataFileWriter, AttachedTouchSensorsHaveTheNormalsThatTheyMeasured) {
  Scenario scenario = small_scenario();
  AttachedSensor level;
  level.name = "level";
  level.kind = SensorKind::inclinometer;
  AttachedSensor bumper;
  bumper.name = "bumper";
  bumper.kind = SensorKind::touch;
  scenario.robot.sensors = {level, bumper};

  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "run.proleg";
  Recorder recorder(path, scenario, "test", "build-7");
  run_small(scenario, 3, [&](TickSample sample, const Change* /*change*/) {
    const double x = 0.125 * sample.tick;
    const std::array values{10.0, 20.0, 1.0, x, 0.25, -0.5};  // pitch and roll; pressed and the normal
    const std::array<std::uint8_t, 2> measured{1, 1};
    sample.sensor_values = values;
    sample.measured_sensors = measured;
    recorder.record_tick(sample);
  });
  recorder.finish({});
  std::string text;
  write_data_file(Recording(path), {}, [&](std::string_view part) { text += part; });

  EXPECT_NE(text.find("<tactile parts=\"9\" "), std::string::npos) << "two of each link, and the bumper";
  const ReadTable table = table_of_text(text);
  ASSERT_EQ(table.rows.size(), 3U);
  for (std::size_t row = 0; row < 3; ++row) {
    EXPECT_EQ(table.number(row, "x-normals.bumper"), 0.125 * static_cast<double>(row));
    EXPECT_EQ(table.number(row, "y-normals.bumper"), 0.25);
    EXPECT_EQ(table.number(row, "z-normals.bumper"), -0.5);
  }
}

TEST(DataFileWriter, WhatIsReadBackIsWhatWasRecorded) {
  const Scenario scenario = small_scenario();
  constexpr std::uint32_t ticks = 230;  // three rounds, the last one with 30 frames
  const std::string text = written(scenario, ticks);
  EXPECT_NE(text.find("<round number=\"2\">"), std::string::npos);
  EXPECT_EQ(text.find("<round number=\"3\">"), std::string::npos);
  const ReadTable table = table_of_text(text);
  ASSERT_EQ(table.rows.size(), ticks);
  EXPECT_EQ(table.remark, "");
  double last_angle = 0.0;
  run_small(scenario, ticks, [&](const TickSample& sample, const Change* /*change*/) {
    const std::size_t row = sample.tick;
    const auto expect = [&](const std::string& column, double value) {
      EXPECT_NEAR(table.number(row, column), value, digits * std::abs(value) + 1e-300) << column << " " << row;
    };
    const auto in_degrees = [](std::int32_t raw) { return raw * 45.0 / 536'870'912.0; };
    expect("tick", sample.tick);
    expect("time_s", (sample.tick + 1) / 100.0);
    for (std::size_t joint = 0; joint < 3; ++joint) {
      const std::string part = "." + scenario.robot.joints[joint].name;
      expect("Phase_Difference" + part, in_degrees(sample.internal_values[3 * joint + 2]));
      expect("Frequency" + part, sample.internal_values[3 * joint + 1] / 16'777'216.0);
      expect("desired_joint_positions" + part, in_degrees(sample.setpoints[joint]));
      expect("real_joint_positions" + part, made_up_angle(sample.tick, joint) * deg);
      expect("servo_currents" + part, made_up_current(sample.tick, joint));
    }
    const double angle = made_up_angle(sample.tick, 0) * deg;
    EXPECT_NEAR(table.number(row, "servo_speeds.J3"), row == 0 ? 0.0 : (angle - last_angle) * 100.0, 1e-6);
    last_angle = angle;
    for (std::size_t link = 0; link < 4; ++link) {
      const std::string part = "." + scenario.robot.links[link].name;
      expect("x_pos" + part, made_up_pose(sample.tick, link).position.x());
      expect("z_pos" + part, made_up_pose(sample.tick, link).position.z());
      EXPECT_NEAR(std::remainder(table.number(row, "gamma" + part) - 0.01 * sample.tick * deg, 360.0), 0.0, 1e-6);
      expect("alpha" + part, 0.0);
      const std::uint8_t pressed = made_up_contacts(sample.tick, link);
      expect("z-normals" + part + ".rear", (pressed & 1U) != 0 ? 1.0 : 0.0);
      expect("z-normals" + part + ".front", (pressed & 2U) != 0 ? 1.0 : 0.0);
      expect("x-normals" + part + ".front", 0.0);
      EXPECT_EQ(table.rows[row].at("potential_energy" + part), "") << "without a scenario no mass is known";
    }
  });
}

TEST(DataFileWriter, AngleIsWhatTheModuleAddsAlsoAfterAChangeInFlight) {
  Scenario scenario = small_scenario();
  scenario.changes[0].settings = {{0, 0, parameter("amplitude"), false, raw(Unit::degree, 5)}};
  const ReadTable table = table_of_text(written(scenario, 20));
  const std::int32_t default_amplitude =
      find_algorithm("PatternGenerator_sinusoidal")->declaration().parameters[parameter("amplitude")].default_value;
  run_small(scenario, 20, [&](const TickSample& sample, const Change* /*change*/) {
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const double amplitude = joint == 1 ? 12.3 : sample.tick >= 5 ? 5.0 : default_amplitude * 45.0 / 536'870'912.0;
      const double phase = sample.internal_values[3 * joint] * 2.0 * std::numbers::pi / 4'294'967'296.0;
      EXPECT_NEAR(table.number(sample.tick, "Angle." + scenario.robot.joints[joint].name), amplitude * std::sin(phase),
                  1e-4)
          << "joint " << joint << ", tick " << sample.tick;
    }
  });
}

TEST(DataFileWriter, EnergyAndSpeedsAreThoseOfTheCentresOfMass) {
  Scenario scenario = small_scenario();
  for (std::size_t link = 0; link < 4; ++link) {
    scenario.robot.links[link].mass.mass = 0.5 + static_cast<double>(link);
    scenario.robot.links[link].mass.center = {0.0, 0.0, 0.25};
  }
  const ReadTable table = table_of_text(written(scenario, 12, scenario));
  EXPECT_NEAR(table.number(3, "potential_energy.Head"), 0.5 * 9.81 * (1.0 / 3.0 + 0.25), 1e-6);
  EXPECT_NEAR(table.number(3, "potential_energy.Tail"), 3.5 * 9.81 * (1.0 / 3.0 + 0.25), 1e-6);
  EXPECT_EQ(table.number(0, "speed.Head"), 0.0);
  const auto y = [](std::uint32_t tick) { return 0.01 * std::sin(0.05 * tick); };
  EXPECT_NEAR(table.number(8, "speed.Link1"), std::hypot(0.001, y(8) - y(7)) * 100.0, 1e-6);
  EXPECT_NEAR(table.number(11, "average_com_speed.Tail"), std::hypot(0.011, y(11) - y(0)) / 0.11, 1e-6);
}

TEST(DataFileWriter, ASecondSlotWithAnAlgorithmIsAModuleOfItsOwn) {
  Scenario scenario = small_scenario();
  scenario.kernel.slots[2] = {scenario.kernel.slots[0].algorithm, JointMask(4)};
  scenario.changes.clear();
  const ReadTable table = table_of_text(written(scenario, 4));
  EXPECT_EQ(std::count(table.columns.begin(), table.columns.end(), "Angle.J1.PatternGenerator_sinusoidal.3"), 1);
  EXPECT_EQ(std::count(table.columns.begin(), table.columns.end(), "Angle.J2.PatternGenerator_sinusoidal.3"), 0);
}

TEST(DataFileWriter, TheReflexHasTheNameOfTheThesis) {
  EXPECT_EQ(thesis_module_name("SensingModule_global_adaptive_touch"), "Global_Adaptive_Touch");
  EXPECT_EQ(thesis_module_name("PatternGenerator_sinusoidal"), "PatternGenerator_sinusoidal");
}

TEST(DataFileWriter, NamesThatXmlCannotHoldAreReplaced) {
  Scenario scenario = small_scenario();
  scenario.robot.joints[0].name = "the <first> \"one\"";
  scenario.robot.links[0].name = "a&b";
  const ReadTable table = table_of_text(written(scenario, 4));
  EXPECT_EQ(std::count(table.columns.begin(), table.columns.end(), "Angle.the__first___one_"), 1);
  EXPECT_EQ(std::count(table.columns.begin(), table.columns.end(), "x_pos.a_b"), 1);
}

}  // namespace
}  // namespace proleg::sim
