#include "sim/authoring/new_scenario.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/authoring/shipped_modules.hpp"
#include "sim/authoring/xml_text.hpp"

namespace proleg::sim {
namespace {

constexpr char yaw = 'y';

constexpr std::string_view simulation_text = R"(<!-- The top-level file: what is simulated, and for how long. -->
<simulation>
  <robot>robot.robot.xml</robot>
  <actuation>robot.actuation.xml</actuation>
  <environment>flat.environment.xml</environment>
  <simulationProperties>
    <!-- The step of the physics in seconds; the control tick is a whole number of steps. -->
    <stepWidth>0.001</stepWidth>
    <tick unit="ms">10</tick>
    <!-- Simulated seconds; the option seconds of 'proleg simulate' overrides it. -->
    <duration>30</duration>
    <seed>1</seed>
  </simulationProperties>
</simulation>
)";

/// The distance of a link's origin from that of the first segment, as metres.
std::string position_text(std::size_t links, std::size_t module_mm) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "%zu.%03zu", links * module_mm / 1000, links * module_mm % 1000);
  return text.data();
}

/// Name of a link; link 0 is the tail.
std::string link_name(std::size_t link, std::size_t joints) {
  return link == 0 ? "Tail" : link == joints ? "Head" : std::to_string(link) + "Seg";
}

std::string link_text(const RobotKind& kind, std::size_t link, std::size_t joints) {
  std::string text = "    <KinBody ";
  if (link == 0) {
    return text + "file=\"modules/tail.kinbody.xml\"/>\n";
  }
  text += link == joints ? "file=\"modules/head.kinbody.xml\""
                         : "prefix=\"" + std::to_string(link) + "\" file=\"modules/segment.kinbody.xml\"";
  return text + "><translation>0 " + position_text(link - 1, kind.module_mm) + " 0</translation></KinBody>\n";
}

std::string joint_text(const RobotKind& kind, std::size_t joint, char axis, std::size_t joints) {
  const std::string front = link_name(joint + 1, joints);
  std::string text = "    <Joint name=\"J" + std::to_string(joint + 1) + "\" type=\"hinge\">\n";
  text += "      <body>" + link_name(joint, joints) + "</body>\n      <body>" + front + "</body>\n";
  text += "      <offsetfrom>" + front + "</offsetfrom>\n";
  text += std::string("      <axis>") + (axis == yaw ? "0 0 1" : "1 0 0") + "</axis>\n";
  text.append("      <maxtorque>").append(kind.torque).append("</maxtorque>\n      <maxvel>").append(kind.speed);
  text += "</maxvel>\n      <limitsdeg>-90 90</limitsdeg>\n";
  return text + "    </Joint>\n";
}

std::string robot_text(const RobotKind& kind, const std::string& axes) {
  std::string text =
      "<!-- A chain of " + std::to_string(axes.size()) + " joints, from the tail: " + axes + " (p: pitch, y: yaw).";
  text += " It lies along y, its head at the positive end.\n\n";
  text += kind.comment;
  text += R"(     Change one of the files in modules/ to change all links of that kind. -->
<Robot name="robot">
  <!-- An almost ideal servo: gain in 1/s, a new pulse every millisecond. -->
  <servo>
    <gain>50</gain>
    <period unit="ms">1</period>
  </servo>
  <KinBody name="body">
)";
  for (std::size_t link = 0; link <= axes.size(); ++link) {
    text += link_text(kind, link, axes.size());
  }
  text +=
      R"(    <!-- The angle of a joint is the rotation of its second body relative to the first. The first body is the one
         towards the tail: a positive angle raises the front (pitch, axis 1 0 0) or turns it to the left (yaw, axis
         0 0 1). The joint is at the origin of the body in offsetfrom. The underside of every link, with its two touch
         sensors, faces the ground, also at a yaw joint. -->
)";
  for (std::size_t joint = 0; joint < axes.size(); ++joint) {
    text += joint_text(kind, joint, axes[joint], axes.size());
  }
  return text + "  </KinBody>\n</Robot>\n";
}

struct Wave {
  unsigned amplitude;  ///< degrees
  std::string_view phase_difference;
  unsigned phase;  ///< degrees; 0: the default
};

std::string parameter_text(std::string_view name, const std::string& value, std::string_view unit,
                           const std::string& joint = "") {
  std::string text("    <parameter name=\"");
  text.append(name).append("\" value=\"").append(value).append("\" unit=\"").append(unit).append("\"");
  return text + (joint.empty() ? "" : " joint=\"" + escaped_xml(joint) + "\"") + "/>\n";
}

constexpr double right_angle = 90.0;  // set-points stay within it
constexpr double margin = 0.9;        // share of the way to a limit

/// How a joint swings whose limits may be narrow: with less amplitude, or about the middle of its limits.
struct Swing {
  double amplitude;  ///< degrees
  double offset;     ///< degrees
};

Swing swing_of(const GaitJoint& joint, const Wave& wave) {
  const double lower = std::max(joint.lower_deg, -right_angle);
  const double upper = std::min(joint.upper_deg, right_angle);
  const double about_zero = std::min(-lower, upper);
  const auto wanted = static_cast<double>(wave.amplitude);
  if (about_zero >= wanted) {
    return {wanted, 0.0};
  }
  const double half = (upper - lower) / 2.0;
  const auto within = [&](double reach) { return std::min(wanted, std::floor(margin * reach * 10.0) / 10.0); };
  constexpr double much = 2.0;
  return half > much * about_zero ? Swing{within(half), std::round(lower + half)} : Swing{within(about_zero), 0.0};
}

/// 1 Hz, or less so that no joint exceeds its speed.
double frequency_of(std::span<const GaitJoint> joints, const std::vector<Swing>& swings) {
  constexpr double share = 0.98;
  double frequency = 1.0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (swings[j].amplitude > 0.0) {
      const double amplitude = swings[j].amplitude * (std::numbers::pi / 180.0);
      frequency = std::min(frequency, share * joints[j].max_speed / amplitude / (2.0 * std::numbers::pi));
    }
  }
  constexpr double least = 0.001;  // Hz
  return std::max(std::floor(frequency * 1000.0) / 1000.0, least);
}

// At 1 Hz a joint with an amplitude of 40 degrees stays just below its 4.5 rad/s.
constexpr Wave travelling_wave{40, "55", 0};
constexpr Wave pitch_of_two{20, "45", 0};
constexpr Wave yaw_of_two{40, "45", 90};

/// A sinusoidal wave on all joints of one axis.
std::string wave_text(std::span<const GaitJoint> joints, bool yaw_joints, const Wave& wave,
                      const std::vector<Swing>& swings, double frequency) {
  std::string group;
  std::string own;  // values of single joints
  std::size_t first = joints.size();
  std::ptrdiff_t same_way = 0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    group += joints[j].is_yaw == yaw_joints ? '1' : '0';
    if (joints[j].is_yaw == yaw_joints) {
      first = std::min(first, j);
      same_way += joints[j].axis.dot(joints[first].axis) < 0.0 ? -1 : 1;
    }
  }
  for (std::size_t j = first; j < joints.size(); ++j) {
    if (joints[j].is_yaw != yaw_joints) {
      continue;
    }
    if (swings[j].amplitude != static_cast<double>(wave.amplitude)) {
      own += parameter_text("amplitude", number_text(swings[j].amplitude), "deg", joints[j].name);
    }
    if (swings[j].offset != 0.0) {
      own += parameter_text("offset", number_text(swings[j].offset), "deg", joints[j].name);
    }
    if ((joints[j].axis.dot(joints[first].axis) < 0.0) != (same_way < 0)) {
      constexpr unsigned half_turn = 180;
      own += parameter_text("phase", std::to_string(wave.phase + half_turn), "deg", joints[j].name);
    }
  }
  std::string text = "  <actuationModule name=\"PatternGenerator_sinusoidal\">\n";
  text += "    <!-- One character for each joint, " + comment_text(joints.front().name) + " at the tail first. -->\n";
  text += "    <jointConfiguration joints=\"" + group + "\"/>\n";
  text += parameter_text("amplitude", std::to_string(wave.amplitude), "deg");
  text += parameter_text("frequency", number_text(frequency), "Hz");
  text += parameter_text("phase_difference", std::string(wave.phase_difference), "deg");
  if (wave.phase != 0) {
    text += parameter_text("phase", std::to_string(wave.phase), "deg");
  }
  return text + own + "  </actuationModule>\n";
}

constexpr std::string_view two_waves_text =
    R"(<!-- Two waves: one of the yaw joints to the left and to the right, and one of the pitch joints that lifts a part of the
     body while the yaw wave carries it on. The phase of the yaw joints is the quarter turn between the two waves; with
     -90 the robot moves to the other side.
)";

constexpr std::string_view alternating_text =
    R"(     The joints of this robot alternate between pitch and yaw. Most robots of this kind move sideways with the two waves
     (sidewinding), and a few at another angle: 'proleg simulate' prints it as heading, with 90 to the left.
)";

constexpr std::string_view not_alternating_text =
    R"(     The two waves are made for joints that alternate between pitch and yaw (sidewinding). Those of this robot do not
     alternate, so it may move in any direction: 'proleg simulate' prints it as heading, with 90 to the left.
)";

constexpr std::string_view phases_text =
    R"(     The phases count by the position of a joint in the whole chain. Both waves therefore have the same
     phase_difference, the one from each joint to the next joint of the chain, whatever the axis of that joint is. -->
)";

std::string comment_on_gait(std::span<const GaitJoint> joints) {
  if (std::ranges::none_of(joints, &GaitJoint::is_yaw)) {
    return R"(<!-- A travelling wave: every joint does what the joint in front of it did a moment before. The gait is that of the
     shipped travelling_wave. -->
)";
  }
  if (std::ranges::all_of(joints, &GaitJoint::is_yaw)) {
    return R"(<!-- A wave to the left and to the right. Without pitch joints all links stay on the ground. They slide equally well
     in all directions, so this robot moves slowly. -->
)";
  }
  const bool alternate = std::ranges::adjacent_find(joints, {}, &GaitJoint::is_yaw) == joints.end();
  std::string text(two_waves_text);
  text.append(alternate ? alternating_text : not_alternating_text).append(phases_text);
  return text;
}

}  // namespace

std::string first_gait_text(std::span<const GaitJoint> joints) {
  const bool has_pitch = !std::ranges::all_of(joints, &GaitJoint::is_yaw);
  const bool has_yaw = !std::ranges::none_of(joints, &GaitJoint::is_yaw);
  const Wave& pitch_wave = has_yaw ? pitch_of_two : travelling_wave;
  std::vector<Swing> swings;
  for (const GaitJoint& joint : joints) {
    swings.push_back(swing_of(joint, joint.is_yaw ? yaw_of_two : pitch_wave));
  }
  const double frequency = frequency_of(joints, swings);
  std::string text = comment_on_gait(joints);
  text += "<actuation>\n  <validRobot robotName=\"robot.robot.xml\"/>\n";
  if (has_pitch) {
    text += wave_text(joints, false, pitch_wave, swings, frequency);
  }
  if (has_yaw) {
    text += wave_text(joints, true, yaw_of_two, swings, frequency);
  }
  return text + "</actuation>\n";
}

std::vector<SourceFile> files_around_robot(std::string robot, std::string gait, double height) {
  constexpr std::string_view shipped_place = ",0 0 0.026,";
  std::string floor(floor_text());
  floor.replace(floor.find(shipped_place), shipped_place.size(), ",0 0 " + exact_text(height) + ",");
  return {{"robot.simulation.xml", std::string(simulation_text)},
          {"robot.robot.xml", std::move(robot)},
          {"robot.actuation.xml", std::move(gait)},
          {"flat.environment.xml", std::move(floor)}};
}

std::vector<SourceFile> new_scenario_files(const RobotKind& kind, const std::string& axes) {
  std::vector<GaitJoint> joints(axes.size());
  for (std::size_t j = 0; j < axes.size(); ++j) {
    joints[j].name = "J" + std::to_string(j + 1);
    joints[j].is_yaw = axes[j] == yaw;
    joints[j].axis = joints[j].is_yaw ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  }
  constexpr double shipped_height = 0.026;
  std::vector<SourceFile> files = files_around_robot(robot_text(kind, axes), first_gait_text(joints), shipped_height);
  for (SourceFile& file : module_files(kind)) {
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace proleg::sim
