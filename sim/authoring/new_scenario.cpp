#include "sim/authoring/new_scenario.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/authoring/shipped_modules.hpp"

namespace proleg::sim {
namespace {

constexpr char pitch = 'p';
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
  std::string_view amplitude;
  std::string_view frequency;
  std::string_view phase_difference;
  std::string_view phase;  ///< empty: the default, 0
};

std::string parameter_text(std::string_view name, std::string_view value, std::string_view unit) {
  std::string text("    <parameter name=\"");
  text.append(name).append("\" value=\"").append(value).append("\" unit=\"").append(unit).append("\"/>\n");
  return text;
}

/// A sinusoidal wave on all joints of one axis.
std::string wave_text(const std::string& axes, char axis, const Wave& wave) {
  std::string group;
  for (const char joint : axes) {
    group += joint == axis ? '1' : '0';
  }
  std::string text = "  <actuationModule name=\"PatternGenerator_sinusoidal\">\n";
  text += "    <!-- One character for each joint, J1 at the tail first. -->\n";
  text += "    <jointConfiguration joints=\"" + group + "\"/>\n";
  text += parameter_text("amplitude", wave.amplitude, "deg");
  text += parameter_text("frequency", wave.frequency, "Hz");
  text += parameter_text("phase_difference", wave.phase_difference, "deg");
  if (!wave.phase.empty()) {
    text += parameter_text("phase", wave.phase, "deg");
  }
  return text + "  </actuationModule>\n";
}

// At 1 Hz a joint with an amplitude of 40 degrees stays just below its 4.5 rad/s.
constexpr Wave travelling_wave{"40", "1", "55", ""};
constexpr Wave pitch_of_two{"20", "1", "45", ""};
constexpr Wave yaw_of_two{"40", "1", "45", "90"};

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

std::string comment_on_gait(const std::string& axes) {
  if (axes.find(yaw) == std::string::npos) {
    return R"(<!-- A travelling wave: every joint does what the joint in front of it did a moment before. The gait is that of the
     shipped travelling_wave. -->
)";
  }
  if (axes.find(pitch) == std::string::npos) {
    return R"(<!-- A wave to the left and to the right. Without pitch joints all links stay on the ground. They slide equally well
     in all directions, so this robot moves slowly. -->
)";
  }
  const bool alternate = std::ranges::adjacent_find(axes) == axes.end();
  std::string text(two_waves_text);
  text.append(alternate ? alternating_text : not_alternating_text).append(phases_text);
  return text;
}

std::string actuation_text(const std::string& axes) {
  const bool has_pitch = axes.find(pitch) != std::string::npos;
  const bool has_yaw = axes.find(yaw) != std::string::npos;
  std::string text = comment_on_gait(axes);
  text += "<actuation>\n  <validRobot robotName=\"robot.robot.xml\"/>\n";
  if (has_pitch) {
    text += wave_text(axes, pitch, has_yaw ? pitch_of_two : travelling_wave);
  }
  if (has_yaw) {
    text += wave_text(axes, yaw, yaw_of_two);
  }
  return text + "</actuation>\n";
}

}  // namespace

std::vector<SourceFile> new_scenario_files(const RobotKind& kind, const std::string& axes) {
  std::vector<SourceFile> files{{"robot.simulation.xml", std::string(simulation_text)},
                                {"robot.robot.xml", robot_text(kind, axes)},
                                {"robot.actuation.xml", actuation_text(axes)},
                                {"flat.environment.xml", std::string(floor_text())}};
  for (SourceFile& file : module_files(kind)) {
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace proleg::sim
