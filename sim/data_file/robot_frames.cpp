#include "sim/data_file/robot_frames.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/unit.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {
namespace {

void append_number(std::string& text, double value) {
  constexpr int digits = 9;
  std::array<char, 32> characters{};
  const auto end =
      std::to_chars(characters.data(), characters.data() + characters.size(), value, std::chars_format::general, digits)
          .ptr;
  text.append(characters.data(), end);
}

std::string joined_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : " ") + list_name(name);
  }
  return text;
}

constexpr double deg_per_rad = 180.0 / std::numbers::pi;

std::vector<std::string> sensor_names(const Recording& recording, const FileOrder& order) {
  std::vector<std::string> names;
  for (const std::uint32_t link : order.links) {
    names.push_back(recording.links()[link] + ".rear");
    names.push_back(recording.links()[link] + ".front");
  }
  for (const RecordedSensor& sensor : recording.sensors()) {
    if (sensor.kind == SensorKind::touch) {
      names.push_back(sensor.name);
    }
  }
  return names;
}

std::vector<std::string> link_names(const Recording& recording, const FileOrder& order) {
  std::vector<std::string> names;
  for (const std::uint32_t link : order.links) {
    names.push_back(recording.links()[link]);
  }
  return names;
}

std::vector<std::string> joint_names_of(const Recording& recording, const FileOrder& order) {
  std::vector<std::string> names;
  for (const std::uint32_t joint : order.joints) {
    names.push_back(recording.joints()[joint].name);
  }
  return names;
}

/// Angles about x, then y, then z of the world, in degrees; an environment file's Pose has the same angles.
Eigen::Vector3d angles_of(const Eigen::Quaterniond& orientation) {
  const Eigen::Matrix3d turn = orientation.normalized().toRotationMatrix();
  return deg_per_rad * Eigen::Vector3d(std::atan2(turn(2, 1), turn(2, 2)),
                                       std::asin(std::clamp(-turn(2, 0), -1.0, 1.0)),
                                       std::atan2(turn(1, 0), turn(0, 0)));
}

}  // namespace

std::string list_name(std::string_view text) {
  std::string name;
  for (const char c : one_line(text)) {
    name += std::string_view(" <>&\"'").find(c) == std::string_view::npos ? c : '_';
  }
  return name.empty() ? "_" : name;
}

std::string tag_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool may_follow = (c >= '0' && c <= '9') || c == '-' || c == '.';
    name += is_letter || (may_follow && !name.empty()) ? c : '_';
  }
  return name.empty() ? "_" : name;
}

DataModuleText::DataModuleText(const std::string& name, std::vector<std::string> types,
                               const std::vector<std::string>& names, const std::vector<std::string>& joint_names)
    : name_(tag_name(name)),
      types_(std::move(types)),
      names_(joined_names(names)),
      joint_names_(joined_names(joint_names)),
      parts_(names.size()) {
  for (std::string& type : types_) {
    type = tag_name(type);
  }
}

std::string DataModuleText::header() const {
  std::string text = "    <" + name_ + " parts=\"" + std::to_string(parts_) + "\" types=\"" +
                     std::to_string(types_.size() + 3) + "\" names=\"" + names_ + "\"";
  if (!joint_names_.empty()) {
    text += " jointnames=\"" + joint_names_ + "\"";
  }
  text += ">\n      <typenames>";
  for (const std::string& type : types_) {
    text += type + " ";
  }
  return text + "realtime simtime stepcount</typenames>\n    </" + name_ + ">\n";
}

void DataModuleText::begin_frame(std::uint32_t index, double realtime_ms, double simtime_ms) {
  constexpr int microseconds = 3;  // number of decimals
  frames_ += "      <frame index=\"" + std::to_string(index) + "\" realtime=\"" +
             plain_number(realtime_ms, microseconds) + "\" simtime=\"" + plain_number(simtime_ms, microseconds) +
             "\">\n";
  next_type_ = 0;
}

void DataModuleText::add(std::span<const double> numbers) {
  const std::string& type = types_[next_type_++];
  frames_ += "        <" + type + ">";
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    frames_ += i == 0 ? "" : " ";
    append_number(frames_, numbers[i]);
  }
  frames_ += "</" + type + ">\n";
}

std::string DataModuleText::finish_round() {
  return "    <" + name_ + ">\n" + std::exchange(frames_, {}) + "    </" + name_ + ">\n";
}

FileOrder::FileOrder(const Recording& recording) : joints(recording.joints().size()), links(recording.links().size()) {
  std::iota(joints.begin(), joints.end(), 0U);
  std::ranges::stable_sort(joints, {}, [&](std::uint32_t joint) { return recording.joints()[joint].file_index; });
  std::iota(links.begin(), links.end(), 0U);
  if (recording.joints().back().file_index < recording.joints().front().file_index) {
    std::ranges::reverse(links);
  }
}

TactileFrames::TactileFrames(const Recording& recording, const FileOrder& order)
    : order_(order), text_("tactile", {"x-normals", "y-normals", "z-normals"}, sensor_names(recording, order)) {
  for (const RecordedSensor& sensor : recording.sensors()) {
    if (sensor.kind == SensorKind::touch) {
      attached_.push_back(sensor.first_value);
    }
  }
}

void TactileFrames::add(const RecordedTick& tick) {
  std::array<std::vector<double>, 3> normals;
  for (const std::uint32_t link : order_.links) {
    // Recordings have no normals of these sensors: the ground pushes along the upward axis of a link.
    const Eigen::Vector3d up = tick.link_poses[link].orientation * Eigen::Vector3d::UnitZ();
    for (const unsigned sensor : {1U, 2U}) {
      const bool is_pressed = (tick.latched_contacts[link] & sensor) != 0;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        normals[static_cast<std::size_t>(axis)].push_back(is_pressed ? up[axis] : 0.0);
      }
    }
  }
  for (const std::size_t first : attached_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      normals[axis].push_back(tick.sensor_values[first + 1 + axis]);  // the normal is behind `pressed`
    }
  }
  for (const std::vector<double>& of_axis : normals) {
    text_.add(of_axis);
  }
}

RobotFrames::RobotFrames(const Recording& recording, const FileOrder& order, const std::optional<Scenario>& scenario)
    : order_(order),
      scenario_(scenario),
      tick_s_(recording.tick_period_us() * 1e-6),
      text_("robot_data",
            {"speed", "x_pos", "y_pos", "z_pos", "alpha", "beta", "gamma", "potential_energy", "average_com_speed",
             "desired_joint_positions", "real_joint_positions", "servo_currents", "servo_speeds"},
            link_names(recording, order), joint_names_of(recording, order)) {}

void RobotFrames::add(const RecordedTick& tick) {
  std::vector<Eigen::Vector3d> centers;
  for (std::size_t link = 0; link < tick.link_poses.size(); ++link) {
    const Pose& pose = tick.link_poses[link];
    centers.push_back(scenario_ ? pose * scenario_->robot.links[link].mass.center : pose.position);
  }
  add_links(tick, centers);
  add_joints(tick);
  centers_ = std::move(centers);
  angles_ = tick.joint_angles;
}

void RobotFrames::add_links(const RecordedTick& tick, const std::vector<Eigen::Vector3d>& centers) {
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::size_t link = 0; link < centers.size(); ++link) {
    const double of_link = scenario_ ? scenario_->robot.links[link].mass.mass : 1.0;
    mass += of_link;
    moment += of_link * centers[link];
  }
  if (centers_.empty()) {
    first_center_ = moment / mass;
    first_tick_ = tick.tick;
  }
  const double since = tick_s_ * (tick.tick - first_tick_);
  const double average_speed = since > 0.0 ? (moment / mass - first_center_).norm() / since : 0.0;

  std::array<std::vector<double>, 9> types;
  for (const std::uint32_t link : order_.links) {
    const Pose& pose = tick.link_poses[link];
    const Eigen::Vector3d angles = angles_of(pose.orientation);
    const double energy =
        scenario_ ? -scenario_->robot.links[link].mass.mass * scenario_->environment.gravity.dot(centers[link])
                  : std::numeric_limits<double>::quiet_NaN();
    const std::array<double, 9> values{
        centers_.empty() ? 0.0 : (centers[link] - centers_[link]).norm() / tick_s_,
        pose.position.x(),
        pose.position.y(),
        pose.position.z(),
        angles.x(),
        angles.y(),
        angles.z(),
        energy,
        average_speed,
    };
    for (std::size_t type = 0; type < values.size(); ++type) {
      types[type].push_back(values[type]);
    }
  }
  for (const std::vector<double>& numbers : types) {
    text_.add(numbers);
  }
}

void RobotFrames::add_joints(const RecordedTick& tick) {
  const UnitScale degrees = scale_of(Unit::degree);
  std::array<std::vector<double>, 4> types;
  for (const std::uint32_t joint : order_.joints) {
    const double angle = tick.joint_angles[joint];
    types[0].push_back(static_cast<double>(tick.setpoints[joint]) * degrees.denominator / degrees.numerator);
    types[1].push_back(angle * deg_per_rad);
    types[2].push_back(tick.servo_currents[joint]);
    types[3].push_back(angles_.empty() ? 0.0 : (angle - angles_[joint]) * deg_per_rad / tick_s_);
  }
  for (const std::vector<double>& numbers : types) {
    text_.add(numbers);
  }
}

}  // namespace proleg::sim
