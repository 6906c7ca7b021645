#include "sim/urdf/urdf_import.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/urdf/robot_text.hpp"
#include "sim/urdf/urdf_chain.hpp"

namespace proleg::sim {
namespace {

using std::numbers::pi;

constexpr double gravity = 9.81;  // m/s^2
constexpr std::string_view robot_file = "robot.robot.xml";

class Importer {
 public:
  Importer(const std::filesystem::path& path, FileSource& files, const UrdfImportOptions& options)
      : path_(path), files_(&files), options_(&options), meshes_(path, options.packages, files) {}

  UrdfImport run() {
    const std::optional<SharedText> text = files_->read(path_);
    if (!text) {
      throw InputError(path_.string(), 0, files_->found_instead(path_).value_or("no file that can be read"),
                       "a robot in URDF of at most " + std::to_string(max_file_bytes >> 20U) + " MiB");
    }
    robot_ = read_urdf(path_, *text);
    chain_ = make_urdf_chain(robot_);
    result_.lost = std::move(robot_.lost);
    result_.notes = std::move(robot_.notes);
    result_.warnings = std::move(robot_.warnings);
    std::ranges::move(chain_.notes, std::back_inserter(result_.notes));
    note_fixed_base();
    use_visuals_if_nothing_touches();
    finish_scenario(write_scenario());
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(int line, const std::string& found, const std::string& expected) const {
    throw InputError(robot_.file, line, found, expected);
  }

  void lose(const std::string& text) {
    if (std::ranges::find(result_.lost, text) == result_.lost.end()) {
      result_.lost.push_back(text);
    }
  }
  void note(const std::string& text) { result_.notes.push_back(text); }

  static std::string at_line(int line) { return " (line " + std::to_string(line) + ")"; }

  void note_fixed_base() {
    const UrdfLink& root = robot_.links[robot_.root];
    if (lower_case(root.name) == "world") {
      lose("the link " + in_quotes(root.name) + ", to which the robot is fixed: it lies free on the ground" +
           at_line(root.line));
    }
  }

  void use_visuals_if_nothing_touches() {
    const bool touches =
        std::ranges::any_of(chain_.bodies, [](const UrdfBody& body) { return !body.collisions.empty(); });
    if (touches) {
      return;
    }
    bool has_any = false;
    for (UrdfBody& body : chain_.bodies) {
      for (const UrdfShape& visual : body.visuals) {
        body.collisions.push_back({visual, std::nullopt});
        has_any = true;
      }
    }
    if (!has_any) {
      refuse(robot_.links[robot_.root].line, "a robot without <collision> and <visual>",
             "links with a <geometry>: without one nothing touches the ground");
    }
    note("no link has a <collision>: the <visual>s touch the ground");
  }

  /// Writes the robot's file and reads the scenario with it. A joint without a torque gets one from the masses of the
  /// bodies, of which some are known only then.
  Scenario write_scenario() {
    const std::string source = path_.filename().string();
    RobotTextOptions options{options_->density, 1.0};
    RobotText written = write_robot_text(robot_, chain_, source, options, meshes_);
    text_ = written.text;
    Scenario scenario = read(files(0.0));
    if (std::ranges::any_of(chain_.joints, [](const UrdfHinge& joint) { return joint.effort <= 0.0; })) {
      options.torque = lifting_torque(scenario.robot);
      written = write_robot_text(robot_, chain_, source, options, meshes_);
      text_ = written.text;
      scenario = read(files(0.0));
    }
    std::ranges::move(written.notes, std::back_inserter(result_.notes));
    std::ranges::copy(meshes_.notes(), std::back_inserter(result_.notes));
    if (!meshes_.outside().empty()) {
      result_.warnings.push_back(robot_.file + ": meshes outside of the robot's folder are copied into the scenario: " +
                                 listed(meshes_.outside()));
    }
    std::ranges::move(written.lost, std::back_inserter(result_.lost));
    return scenario;
  }

  /// Torque that is twice what a joint in the middle needs to lift half of the stretched robot; two digits.
  static double lifting_torque(const RobotModel& robot) {
    double mass = 0.0;
    double length = 0.0;
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      mass += robot.links[i].mass.mass;
      const LinkEnds ends = link_ends(robot, i);
      length += (ends.front - ends.rear).norm();
    }
    constexpr double least = 1e-6;
    constexpr double most = 1e5;
    const double torque = std::clamp(2.0 * (mass / 2.0) * gravity * (length / 4.0), least, most);
    const double step = std::pow(10.0, std::floor(std::log10(torque)) - 1.0);
    return std::ceil(torque / step) * step;
  }

  [[nodiscard]] std::string gait() const {
    std::vector<GaitJoint> joints;
    for (const UrdfHinge& hinge : chain_.joints) {
      Joint in_robot;
      in_robot.axis = chain_.bodies[hinge.child].pose.orientation * hinge.axis;
      GaitJoint joint;
      joint.name = hinge.name;
      joint.is_yaw = direction_of(in_robot) == JointDirection::yaw;
      joint.lower_deg = hinge.lower * 180.0 / pi;
      joint.upper_deg = hinge.upper * 180.0 / pi;
      joint.max_speed = hinge.velocity > 0.0 ? hinge.velocity : default_joint_speed;
      joint.axis = hinge.child > hinge.parent ? in_robot.axis : -in_robot.axis;
      joints.push_back(joint);
    }
    return first_gait_text(joints);
  }

  [[nodiscard]] std::vector<SourceFile> files(double height) const {
    std::vector<SourceFile> result = files_around_robot(text_.text(), gait(), height);
    result.insert(result.end(), meshes_.files().begin(), meshes_.files().end());
    return result;
  }

  /// Puts the robot onto the floor, and reads the scenario as a user's program will.
  void finish_scenario(const Scenario& above) {
    std::optional<Bounds> bounds;
    for (const Link& link : above.robot.links) {
      if (const std::optional<Bounds> of_link = bounds_of(link.geometries, link.pose)) {
        bounds = bounds ? joined(*bounds, *of_link) : *of_link;
      }
    }
    const double lowest = bounds ? bounds->lowest.z() : 0.0;
    constexpr double per_metre = 1e6;
    result_.files = files(std::ceil(-lowest * per_metre) / per_metre);
    const Scenario scenario = read(result_.files);
    for (const std::string& warning : scenario.warnings) {
      result_.warnings.push_back(with_urdf_line(warning));
    }
    warn_of_size(scenario.robot);
  }

  /// A message on the robot's file, in words of URDF and with the causes that it has there.
  static std::string in_words_of_urdf(std::string message) {
    if (message.find("<offsetfrom>") != std::string::npos || message.find("<translation>") != std::string::npos) {
      message = message.substr(0, message.find("; usually")) + "; usually an <origin> is wrong";
    }
    for (const auto& [ours, theirs] : {std::pair<std::string_view, std::string_view>{"<total>", "<mass>"},
                                       {"<extents> or another length of <Mass> or <Geom>", "a length"},
                                       {"<maxtorque>", "effort"},
                                       {"<maxvel>", "velocity"},
                                       {"<limitsdeg>", "<limit>"},
                                       {"<anchor>", "<origin>"},
                                       {"<com>", "<origin> of <inertial>"}}) {
      if (const std::size_t at = message.find(ours); at != std::string::npos) {
        message.replace(at, ours.size(), theirs);
      }
    }
    return message;
  }

  Scenario read(const std::vector<SourceFile>& files) {
    ImportedTexts texts(files, meshes_.known_meshes());
    try {
      return read_scenario(files.front().path, texts);
    } catch (const InputError& error) {
      throw InputError(with_urdf_line(error.what()));
    }
  }

  /// A message with the place in the robot's file, as one with the place in the URDF file.
  [[nodiscard]] std::string with_urdf_line(const std::string& message) const {
    const std::string prefix = std::string(robot_file) + ':';
    const std::size_t end = message.find_first_not_of("0123456789", prefix.size());
    if (!message.starts_with(prefix) || end == std::string::npos || message[end] != ':') {
      return robot_.file + ": " + message;
    }
    const auto line = parse_whole<int>(std::string_view(message).substr(prefix.size(), end - prefix.size()));
    const int origin = text_.origin_of(line.value_or(0));
    return robot_.file + (origin > 0 ? ':' + std::to_string(origin) : "") + in_words_of_urdf(message.substr(end));
  }

  void warn_of_size(const RobotModel& robot) {
    constexpr double most = 20.0;  // m
    const auto center = [](const Link& link) { return Eigen::Vector3d(link.pose * link.mass.center); };
    double reach = 0.0;
    for (const Link& link : robot.links) {
      reach = std::max(reach, (center(link) - center(robot.links.front())).norm());
    }
    if (reach > most) {
      result_.warnings.push_back(robot_.file + ": links are " + number_text(reach) +
                                 " m apart; usually lengths are in millimetres, and URDF has metres");
    }
  }

  std::filesystem::path path_;
  FileSource* files_;
  const UrdfImportOptions* options_;
  UrdfRobot robot_;
  UrdfChain chain_;
  TracedText text_;
  UrdfImport result_;
  ImportedMeshes meshes_;
};

}  // namespace

UrdfImport import_urdf(const std::filesystem::path& path, FileSource& files, const UrdfImportOptions& options) {
  return Importer(path, files, options).run();
}

}  // namespace proleg::sim
