#include "sim/record/tsv.hpp"

#include <algorithm>
#include <numbers>
#include <set>
#include <string>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::sim {
namespace {

/// A column's name has no slash and no circumflex.
std::string sensor_unit_suffix(const std::string& unit) {
  return unit.empty() ? "" : '_' + (unit == "m/s^2" ? std::string("m_per_s2") : unit);
}

/// Column names, with each used once.
class Header {
 public:
  /// distinction: appended if the name is taken.
  void add(std::string name, const std::string& distinction) {
    for (char& c : name) {
      if (static_cast<unsigned char>(c) < ' ') {
        c = ' ';
      }
    }
    while (!used_.insert(name).second) {
      name += distinction;
    }
    line_.add(name);
  }
  [[nodiscard]] std::string finish() { return line_.finish(); }

 private:
  std::set<std::string> used_;
  TableLine line_;
};

void write_header(const Recording& recording, const std::function<void(std::string_view)>& write) {
  Header header;
  header.add("tick", "");
  header.add("time_s", "");
  for (std::size_t joint = 0; joint < recording.joints().size(); ++joint) {
    const std::string name = "." + recording.joints()[joint].name;
    const std::string position = ".joint" + std::to_string(joint);
    for (const char* quantity : {"setpoint_deg", "servo_us", "angle_deg", "torque_Nm", "current_mA"}) {
      header.add(quantity + name, position);
    }
    for (const RecordedInternalValue& value : recording.internal_values()) {
      if (value.joint == joint) {
        header.add(value.name + unit_suffix(value.unit) + name, ".slot" + std::to_string(value.slot));
      }
    }
  }
  for (std::size_t link = 0; link < recording.links().size(); ++link) {
    const std::string name = "." + recording.links()[link];
    for (const char* quantity :
         {"x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "contact_rear", "contact_front", "contact_N"}) {
      header.add(quantity + name, ".link" + std::to_string(link));
    }
  }
  for (std::size_t i = 0; i < recording.sensors().size(); ++i) {
    const RecordedSensor& sensor = recording.sensors()[i];
    for (const RecordedSensor::Channel& channel : sensor.channels) {
      header.add(channel.name + sensor_unit_suffix(channel.unit) + '.' + sensor.name, ".sensor" + std::to_string(i));
    }
  }
  write(header.finish());
}

}  // namespace

std::string unit_suffix(Unit unit) {
  switch (unit) {
    case Unit::degree:
    case Unit::phase_degree:
      return "_deg";
    case Unit::hertz:
      return "_Hz";
    case Unit::per_second:
      return "_per_s";
    case Unit::ratio:
    case Unit::count:
      break;
  }
  return "";
}

void write_tsv(const Recording& recording, const std::function<void(std::string_view)>& write) {
  write_header(recording, write);

  // Positions of the internal values of each joint in RecordedTick::internal_values.
  std::vector<std::vector<std::size_t>> values_of(recording.joints().size());
  for (std::size_t i = 0; i < recording.internal_values().size(); ++i) {
    values_of[recording.internal_values()[i].joint].push_back(i);
  }

  TableLine line;
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const RecordedTick& tick) {
    line.add(tick.tick);
    line.add(recording.time_s(tick.tick));
    for (std::size_t joint = 0; joint < recording.joints().size(); ++joint) {
      line.add(format_decimal(tick.setpoints[joint], Unit::degree).view());
      line.add(static_cast<double>(tick.servo_commands[joint]) / servo_counts_per_us);
      line.add(tick.joint_angles[joint] * 180.0 / std::numbers::pi);
      line.add(tick.motor_torques[joint]);
      line.add(tick.servo_currents[joint]);
      for (const std::size_t i : values_of[joint]) {
        line.add(format_decimal(tick.internal_values[i], recording.internal_values()[i].unit).view());
      }
    }
    for (std::size_t link = 0; link < recording.links().size(); ++link) {
      const Eigen::Vector3d& position = tick.link_poses[link].position;
      line.add(position.x());
      line.add(position.y());
      line.add(position.z());
      const Eigen::Quaterniond& orientation = tick.link_poses[link].orientation;
      for (const double part : {orientation.w(), orientation.x(), orientation.y(), orientation.z()}) {
        line.add(part);
      }
      line.add((tick.latched_contacts[link] & 1U) != 0 ? "1" : "0");
      line.add((tick.latched_contacts[link] & 2U) != 0 ? "1" : "0");
      line.add(tick.contact_forces[link]);
    }
    for (const double value : tick.sensor_values) {
      line.add(value);
    }
    write(line.finish());
  });
}

}  // namespace proleg::sim
