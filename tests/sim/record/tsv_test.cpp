#include "sim/record/tsv.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <numbers>
#include <sstream>

#include "shared/fixed/decimal.hpp"
#include "small_run.hpp"

namespace proleg::sim {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) {
    parts.push_back(part);
  }
  return parts;
}

/// The table of a run of the scenario, by lines.
std::vector<std::string> table_of(const Scenario& scenario, std::uint32_t ticks) {
  const TemporaryFolder folder;
  record_small(folder / "run.sqlite", scenario, ticks);
  std::string text;
  write_tsv(Recording(folder / "run.sqlite"), [&](std::string_view part) { text += part; });
  EXPECT_EQ(text.back(), '\n');
  return split(text, '\n');
}

TEST(Tsv, NamesItsColumns) {
  const std::vector<std::string> lines = table_of(small_scenario(), 3);
  EXPECT_EQ(lines[0],
            "tick\ttime_s\t"
            "setpoint_deg.J3\tservo_us.J3\tangle_deg.J3\ttorque_Nm.J3\tcurrent_mA.J3\tcurrent_phase_deg.J3\tmeasured_"
            "frequency_Hz.J3\tmeasured_"
            "phase_difference_deg.J3\t"
            "setpoint_deg.J2\tservo_us.J2\tangle_deg.J2\ttorque_Nm.J2\tcurrent_mA.J2\tcurrent_phase_deg.J2\tmeasured_"
            "frequency_Hz.J2\tmeasured_"
            "phase_difference_deg.J2\t"
            "setpoint_deg.J1\tservo_us.J1\tangle_deg.J1\ttorque_Nm.J1\tcurrent_mA.J1\tcurrent_phase_deg.J1\tmeasured_"
            "frequency_Hz.J1\tmeasured_"
            "phase_difference_deg.J1\t"
            "x_m.Head\ty_m.Head\tz_m.Head\tqw.Head\tqx.Head\tqy.Head\tqz.Head\tcontact_rear.Head\tcontact_front."
            "Head\tcontact_N.Head\t"
            "x_m.Link2\ty_m.Link2\tz_m.Link2\tqw.Link2\tqx.Link2\tqy.Link2\tqz.Link2\tcontact_rear.Link2\tcontact_"
            "front.Link2\tcontact_N.Link2\t"
            "x_m.Link1\ty_m.Link1\tz_m.Link1\tqw.Link1\tqx.Link1\tqy.Link1\tqz.Link1\tcontact_rear.Link1\tcontact_"
            "front.Link1\tcontact_N.Link1\t"
            "x_m.Tail\ty_m.Tail\tz_m.Tail\tqw.Tail\tqx.Tail\tqy.Tail\tqz.Tail\tcontact_rear.Tail\tcontact_front."
            "Tail\tcontact_N.Tail");
}

TEST(Tsv, ContainsEveryValueExactly) {
  const Scenario scenario = small_scenario();
  constexpr std::uint32_t ticks = 40;
  const std::vector<std::string> lines = table_of(scenario, ticks);
  ASSERT_EQ(lines.size(), ticks + 1);
  const std::vector<std::string> names = split(lines[0], '\t');

  run_small(scenario, ticks, [&](const TickSample& sample, const Change* /*change*/) {
    const std::vector<std::string> fields = split(lines[sample.tick + 1], '\t');
    ASSERT_EQ(fields.size(), names.size());
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < names.size(); ++i) {
      row[names[i]] = fields[i];
    }
    const auto number = [&row](const std::string& name) { return std::strtod(row[name].c_str(), nullptr); };
    EXPECT_EQ(row["tick"], std::to_string(sample.tick));
    EXPECT_EQ(number("time_s"), (sample.tick + 1) / 100.0);
    for (unsigned joint = 0; joint < 3; ++joint) {
      const std::string name = "." + scenario.robot.joints[joint].name;
      EXPECT_EQ(parse_decimal(row["setpoint_deg" + name], Unit::degree).raw, sample.setpoints[joint]);
      EXPECT_EQ(parse_decimal(row["current_phase_deg" + name], Unit::phase_degree).raw,
                sample.internal_values[3 * joint]);
      EXPECT_EQ(parse_decimal(row["measured_frequency_Hz" + name], Unit::hertz).raw,
                sample.internal_values[3 * joint + 1]);
      EXPECT_EQ(parse_decimal(row["measured_phase_difference_deg" + name], Unit::phase_degree).raw,
                sample.internal_values[3 * joint + 2]);
      EXPECT_EQ(number("servo_us" + name), made_up_command(sample.tick, joint) / 12.0);
      EXPECT_EQ(number("angle_deg" + name), made_up_angle(sample.tick, joint) * 180.0 / std::numbers::pi);
      EXPECT_EQ(number("torque_Nm" + name), made_up_torque(sample.tick, joint));
      EXPECT_EQ(number("current_mA" + name), made_up_current(sample.tick, joint));
    }
    for (std::size_t link = 0; link < 4; ++link) {
      const std::string name = "." + scenario.robot.links[link].name;
      const Pose pose = made_up_pose(sample.tick, link);
      EXPECT_EQ(number("x_m" + name), pose.position.x());
      EXPECT_EQ(number("y_m" + name), pose.position.y());
      EXPECT_EQ(number("z_m" + name), pose.position.z());
      EXPECT_EQ(number("qw" + name), pose.orientation.w());
      EXPECT_EQ(number("qx" + name), pose.orientation.x());
      EXPECT_EQ(number("qy" + name), pose.orientation.y());
      EXPECT_EQ(number("qz" + name), pose.orientation.z());
      EXPECT_EQ(row["contact_rear" + name], (made_up_contacts(sample.tick, link) & 1U) != 0 ? "1" : "0");
      EXPECT_EQ(row["contact_front" + name], (made_up_contacts(sample.tick, link) & 2U) != 0 ? "1" : "0");
      EXPECT_EQ(number("contact_N" + name), made_up_contact_force(sample.tick, link));
    }
  });
}

TEST(Tsv, NamesTheSlotWhereTwoSlotsHaveTheSameValue) {
  Scenario scenario = small_scenario();
  scenario.kernel.slots[2] = {scenario.kernel.slots[0].algorithm, JointMask(4)};
  scenario.changes.clear();
  const std::vector<std::string> names = split(table_of(scenario, 2)[0], '\t');
  EXPECT_EQ(std::count(names.begin(), names.end(), "current_phase_deg.J1"), 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), "current_phase_deg.J1.slot2"), 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), "current_phase_deg.J2.slot2"), 0);
}

TEST(Tsv, KeepsItsShapeForAnyNames) {
  Scenario scenario = small_scenario();
  scenario.robot.joints[0].name = "one\ttwo\nthree";
  scenario.robot.joints[1].name = "same";
  scenario.robot.joints[2].name = "same";
  const std::vector<std::string> lines = table_of(scenario, 2);
  ASSERT_EQ(lines.size(), 3U);
  const std::vector<std::string> names = split(lines[0], '\t');
  EXPECT_EQ(names.size(), split(lines[1], '\t').size());
  EXPECT_EQ(names[2], "setpoint_deg.one two three");
  EXPECT_EQ(std::count(names.begin(), names.end(), "angle_deg.same"), 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), "angle_deg.same.joint2"), 1);
}

}  // namespace
}  // namespace proleg::sim
