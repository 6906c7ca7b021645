// Reads arbitrary input as a scenario in memory. An input is several files; each starts with a line "=== NAME". The
// file "set" has words of `--set`, one a line. For every input the reader must return a scenario that can run, or throw
// an InputError of one line.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"

namespace {

using namespace proleg;
using namespace proleg::sim;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

void require(bool holds, const char* what) {
  if (!holds) {
    fail(what);
  }
}

class InputFiles final : public FileSource {
 public:
  explicit InputFiles(std::string_view input) {
    constexpr std::string_view separator = "=== ";
    std::string* file = nullptr;
    while (!input.empty()) {
      const std::string_view line = input.substr(0, input.find('\n'));
      if (line.starts_with(separator)) {
        const std::string name(line.substr(separator.size()));
        first = first.empty() ? name : first;
        file = &texts[std::filesystem::path(name).lexically_normal().string()];
      } else if (file != nullptr) {
        file->append(line).append("\n");
      }
      input.remove_prefix(std::min(line.size() + 1, input.size()));
    }
  }

  [[nodiscard]] std::optional<SharedText> read(const std::filesystem::path& path) override {
    const auto file = texts.find(path.lexically_normal().string());
    return file == texts.end() ? std::nullopt : std::optional(file->second);
  }

  std::string first;
  std::map<std::string, std::string> texts;
};

void check_message(const InputError& error) {
  const std::string_view message = error.what();
  require(std::ranges::none_of(message, [](char c) { return static_cast<unsigned char>(c) < 0x20; }),
          "a message is one line");
  require(message.find(": found ") != std::string_view::npos, "a message says what was found");
  require(message.find(", expected ") != std::string_view::npos, "a message says what was expected");
}

void check_mesh(const TriangleMesh& mesh) {
  require(!mesh.triangles.empty(), "a mesh has a triangle");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      require(corner < mesh.vertices.size() && mesh.vertices[corner].allFinite(), "triangles have finite corners");
    }
  }
}

void check_mass(const MassProperties& mass) {
  require(mass.mass > 0.0 && std::isfinite(mass.mass) && mass.center.allFinite(), "masses are above 0");
  const Eigen::Matrix3d& inertia = mass.inertia;
  require(inertia.allFinite() && inertia == inertia.transpose(), "inertias are symmetric");
  require(inertia(0, 0) > 0.0 && inertia.topLeftCorner<2, 2>().determinant() > 0.0 && inertia.determinant() > 0.0,
          "inertias are positive definite");
}

void check_geometries(const std::vector<Geometry>& geometries) {
  for (const Geometry& geometry : geometries) {
    require(geometry.pose.position.allFinite(), "geometries are finite");
    require(std::abs(geometry.pose.orientation.norm() - 1.0) < 1e-9, "orientations are unit quaternions");
    const bool has_mesh =
        geometry.shape == Shape::hull || geometry.shape == Shape::surface || geometry.shape == Shape::height_field;
    require(has_mesh == (geometry.mesh != nullptr), "meshes have triangles, other shapes none");
    if (has_mesh) {
      check_mesh(*geometry.mesh);
    }
    const Eigen::Vector3d& size = geometry.extents;
    const bool positive = geometry.shape == Shape::box      ? size.minCoeff() > 0.0
                          : geometry.shape == Shape::sphere ? size.x() > 0.0
                                                            : size.x() > 0.0 && size.y() > 0.0;
    require(size.allFinite() && positive, "sizes are above 0");
    require(!geometry.friction || *geometry.friction >= 0.0, "friction is not negative");
  }
}

void check_robot(const Scenario& scenario) {
  const RobotModel& robot = scenario.robot;
  require(!robot.joints.empty() && robot.joints.size() <= max_joints, "1 to 64 joints");
  require(robot.links.size() == robot.joints.size() + 1, "one more link than joints");
  require(scenario.joint_limits.size() == robot.joints.size(), "limits for each joint");
  for (const Link& link : robot.links) {
    require(link.pose.position.allFinite() && link.mass.center.allFinite(), "links are finite");
    require(std::abs(link.pose.orientation.norm() - 1.0) < 1e-9, "orientations are unit quaternions");
    check_mass(link.mass);
    check_geometries(link.geometries);
  }
  require(scenario.modules.size() == robot.joints.size(), "a module for each joint");
  std::vector<bool> nodes(127, false);
  for (const ModulePlace& module : scenario.modules) {
    require(module.node >= 1 && module.node <= 126 && !nodes[module.node], "each node id once, 1 to 126");
    nodes[module.node] = true;
    require(module.serial != 0U, "a serial number is not 0");
  }
  std::vector<bool> file_indices(robot.joints.size(), false);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    require(joint.anchor.allFinite() && std::abs(joint.axis.norm() - 1.0) < 1e-9, "axes are unit vectors");
    require(joint.lower_limit <= joint.upper_limit && joint.max_torque > 0.0 && joint.max_speed > 0.0,
            "limits are in order");
    require(scenario.joint_limits[j].lower <= scenario.joint_limits[j].upper, "kernel limits are in order");
    require(joint.file_index < file_indices.size() && !file_indices[joint.file_index], "each file index once");
    file_indices[joint.file_index] = true;
  }
}

void check_sensors(const RobotModel& robot) {
  require(robot.sensors.size() <= max_attached_sensors, "not too many sensors");
  for (const AttachedSensor& sensor : robot.sensors) {
    const bool is_of_joint = sensor.kind == SensorKind::servo_current;
    require(sensor.part < (is_of_joint ? robot.joints.size() : robot.links.size()),
            "sensors are on parts of the robot");
    require(sensor.pose.position.allFinite() && std::abs(sensor.pose.orientation.norm() - 1.0) < 1e-9,
            "poses of sensors are finite");
    require(!sensor.extents || sensor.extents->minCoeff() > 0.0, "boxes of touch sensors are above 0");
    require(sensor.kind != SensorKind::laser || (sensor.scan.rays >= 1 && sensor.scan.rays <= max_laser_rays &&
                                                 sensor.scan.range > 0.0 && std::isfinite(sensor.scan.angle_step)),
            "scans are bounded");
  }
}

void check_with_kernel(const Scenario& scenario) {
  std::vector<JointMemory> memory(scenario.kernel.joint_count);
  Kernel kernel(memory);
  require(kernel.configure(scenario.kernel, 0) == Status::ok, "the kernel takes the configuration");
  for (unsigned j = 0; j < scenario.kernel.joint_count; ++j) {
    require(kernel.set_limits(j, scenario.joint_limits[j].lower, scenario.joint_limits[j].upper) == Status::ok,
            "the kernel takes the limits");
  }
  for (const Setting& setting : scenario.settings) {
    require(!setting.internal && kernel.set_parameter(setting) == Status::ok, "the kernel takes the start values");
  }
  kernel.reset();
  const Change* before = nullptr;
  std::uint16_t transaction = 0;
  for (const Change& change : scenario.changes) {
    require(before == nullptr || before->tick < change.tick, "changes are in order of ticks");
    require(!change.settings.empty(), "a change changes something");
    before = &change;
    kernel.reset();
    ++transaction;
    for (const Setting& setting : change.settings) {
      require(kernel.stage(transaction, setting) == Status::ok, "the kernel takes the changes");
    }
  }
  kernel.advance();
}

void check(const Scenario& scenario) {
  check_robot(scenario);
  check_sensors(scenario.robot);
  for (const StaticObject& object : scenario.environment.objects) {
    check_geometries(object.geometries);
  }
  for (const MovingObject& object : scenario.environment.moving_objects) {
    check_mass(object.mass);
    check_geometries(object.geometries);
  }
  for (const Ruler& ruler : scenario.environment.rulers) {
    require(ruler.division > 0.0 && (ruler.to - ruler.from).norm() / ruler.division <= 1001.0, "rulers have an end");
  }
  require(scenario.environment.robot_pose.position.allFinite(), "the start pose is finite");
  require(scenario.duration_s > 0.0 && scenario.step_s > 0.0, "times are above 0");
  check_with_kernel(scenario);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  InputFiles files(std::string_view(reinterpret_cast<const char*>(data), size));
  try {
    Scenario scenario = read_scenario(files.first, files);
    check(scenario);
    std::string_view words = files.texts["set"];
    while (!words.empty()) {
      const std::string_view word = words.substr(0, words.find('\n'));
      try {
        apply_setting(scenario, std::string(word));
      } catch (const InputError& error) {
        check_message(error);
      }
      words.remove_prefix(std::min(word.size() + 1, words.size()));
    }
    check(scenario);
  } catch (const InputError& error) {
    check_message(error);
  }
  return 0;
}
