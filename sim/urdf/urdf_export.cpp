#include "sim/urdf/urdf_export.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <optional>

#include "shared/computer/text/text.hpp"
#include "sim/authoring/xml_text.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::sim {
namespace {

std::string numbers_text(const Eigen::Vector3d& value) {
  std::string text;
  for (const double part : value) {
    text += (text.empty() ? "" : " ") + exact_text(part == 0.0 ? 0.0 : part);
  }
  return text;
}

/// Roll, pitch and yaw: the rotation is Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Vector3d roll_pitch_yaw(const Eigen::Quaterniond& orientation) {
  const Eigen::Matrix3d m = orientation.normalized().toRotationMatrix();
  const double level = std::hypot(m(0, 0), m(1, 0));
  const double pitch = std::atan2(-m(2, 0), level);
  constexpr double upright = 1e-9;
  if (level < upright) {
    return {std::atan2(-m(1, 2), m(1, 1)), pitch, 0.0};
  }
  return {std::atan2(m(2, 1), m(2, 2)), pitch, std::atan2(m(1, 0), m(0, 0))};
}

std::string origin_text(const Pose& pose) {
  return "<origin xyz=\"" + numbers_text(pose.position) + "\" rpy=\"" + numbers_text(roll_pitch_yaw(pose.orientation)) +
         "\"/>";
}

/// A mesh as a binary STL file (3D Systems, "StereoLithography Interface Specification", 1988).
std::string stl_bytes(const TriangleMesh& mesh) {
  constexpr std::size_t header = 80;
  std::string bytes(export_mark);
  bytes.resize(header, ' ');
  const auto add_word = [&](std::uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes += static_cast<char>(word >> shift & 0xFFU);
    }
  };
  const auto add_vector = [&](const Eigen::Vector3d& value) {
    for (const double part : value) {
      add_word(std::bit_cast<std::uint32_t>(static_cast<float>(part)));
    }
  };
  add_word(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
    const Eigen::Vector3d& b = mesh.vertices[triangle[1]];
    const Eigen::Vector3d& c = mesh.vertices[triangle[2]];
    add_vector((b - a).cross(c - a).normalized());
    add_vector(a);
    add_vector(b);
    add_vector(c);
    bytes.append(2, '\0');
  }
  return bytes;
}

class UrdfWriter {
 public:
  UrdfWriter(const RobotModel& robot, const std::string& mesh_folder) : robot_(&robot), mesh_folder_(&mesh_folder) {}

  UrdfExport write() {
    text() += "<!-- Written by 'proleg export'. Metres, kilograms, radians; x is forward, z up. -->\n";
    text() += "<robot name=\"" + escaped_xml(one_line(robot_->name)) + "\">\n";
    text() += "  <link name=\"" + base_ + "\"/>\n";
    for (std::size_t i = robot_->links.size(); i-- > 0;) {
      write_link(i);
      if (i == robot_->joints.size()) {
        write_base(i);
      } else {
        write_joint(i);
      }
    }
    for (const Link& link : robot_->links) {
      write_friction(link);
    }
    text() += "</robot>\n";
    note_losses();
    return std::move(result_);
  }

 private:
  std::string& text() { return result_.text; }
  void lose(const std::string& what) { result_.lost.push_back(what); }

  /// The frame that a link has in the file, in the robot's frame.
  [[nodiscard]] Pose frame_of(std::size_t link) const {
    const Pose& pose = robot_->links[link].pose;
    return link < robot_->joints.size() ? Pose{robot_->joints[link].anchor, pose.orientation} : pose;
  }

  /// The name of a link or joint is free if no other has it: "base_link" is one that Proleg's robots may have, too.
  static std::string free_name(std::string name, const RobotModel& robot) {
    const auto is_taken = [&] {
      return std::ranges::any_of(robot.links, [&](const Link& link) { return link.name == name; }) ||
             std::ranges::any_of(robot.joints, [&](const Joint& joint) { return joint.name == name; });
    };
    while (is_taken()) {
      name += '_';
    }
    return name;
  }

  void write_base(std::size_t tail) {
    // ROS robots point along x, robots of Proleg along y.
    constexpr double half = std::numbers::sqrt2 / 2.0;
    const Pose base{Eigen::Vector3d::Zero(), Eigen::Quaterniond(half, 0.0, 0.0, half)};
    text() += "  <joint name=\"" + free_name("base", *robot_) + "\" type=\"fixed\">\n    <parent link=\"" + base_ +
              "\"/>\n    <child link=\"" + escaped_xml(robot_->links[tail].name) + "\"/>\n    " +
              origin_text(base.inverse() * frame_of(tail)) + "\n  </joint>\n";
  }

  void write_joint(std::size_t number) {
    const Joint& joint = robot_->joints[number];
    const Pose child = frame_of(number);
    text() += "  <joint name=\"" + escaped_xml(joint.name) + "\" type=\"revolute\">\n    <parent link=\"" +
              escaped_xml(robot_->links[number + 1].name) + "\"/>\n    <child link=\"" +
              escaped_xml(robot_->links[number].name) + "\"/>\n    " +
              origin_text(frame_of(number + 1).inverse() * child) + "\n    <axis xyz=\"" +
              numbers_text(child.orientation.conjugate() * joint.axis) + "\"/>\n    <limit lower=\"" +
              exact_text(joint.lower_limit) + "\" upper=\"" + exact_text(joint.upper_limit) + "\" effort=\"" +
              exact_text(joint.max_torque) + "\" velocity=\"" + exact_text(joint.max_speed) + "\"/>\n  </joint>\n";
  }

  void write_link(std::size_t number) {
    const Link& link = robot_->links[number];
    const Pose to_frame = frame_of(number).inverse() * link.pose;
    text() += "  <link name=\"" + escaped_xml(link.name) + "\">\n";
    write_mass(link.mass, to_frame);
    for (const Geometry& geometry : link.geometries) {
      write_geometry(geometry, to_frame * geometry.pose, link.name);
    }
    for (const Look& look : link.looks) {
      write_shape("visual", to_frame * look.pose, mesh_text(look.mesh, link.name));
    }
    text() += "  </link>\n";
  }

  void write_mass(const MassProperties& mass, const Pose& to_frame) {
    const Eigen::Matrix3d& inertia = mass.inertia;
    text() += "    <inertial>\n      " + origin_text({to_frame * mass.center, to_frame.orientation}) +
              "\n      <mass value=\"" + exact_text(mass.mass) + "\"/>\n      <inertia";
    constexpr std::array<const char*, 3> axes{"x", "y", "z"};
    for (std::size_t row = 0; row < axes.size(); ++row) {
      for (std::size_t column = row; column < axes.size(); ++column) {
        const double moment = inertia(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
        text() +=
            std::string(" i") + axes[row] + axes[column] + "=\"" + exact_text(moment == 0.0 ? 0.0 : moment) + "\"";
      }
    }
    text() += "/>\n    </inertial>\n";
  }

  void write_geometry(const Geometry& geometry, Pose pose, const std::string& link) {
    const Eigen::Vector3d& size = geometry.extents;
    std::string solid;
    switch (geometry.shape) {
      case Shape::box:
        solid = "<box size=\"" + numbers_text(2.0 * size) + "\"/>";
        break;
      case Shape::sphere:
        solid = "<sphere radius=\"" + exact_text(size.x()) + "\"/>";
        break;
      case Shape::cylinder:  // along z in URDF, along y in the model
        solid = "<cylinder radius=\"" + exact_text(size.x()) + "\" length=\"" + exact_text(2.0 * size.y()) + "\"/>";
        pose.orientation =
            pose.orientation * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
        break;
      case Shape::hull:
        solid = mesh_text(geometry.mesh, link + "_hull");
        break;
      case Shape::surface:
      case Shape::height_field:
        return;  // of the environment only
    }
    write_shape("collision", pose, solid);
    if (geometry.is_shown) {
      write_shape("visual", pose, solid);
    }
  }

  void write_shape(const std::string& tag, const Pose& pose, const std::string& solid) {
    text() += "    <" + tag + ">\n      " + origin_text(pose) + "\n      <geometry>" + solid + "</geometry>\n    </" +
              tag + ">\n";
  }

  /// Each mesh becomes one file, with the name of the first link that has it.
  std::string mesh_text(const std::shared_ptr<const TriangleMesh>& mesh, const std::string& name) {
    const auto [known, is_new] = mesh_files_.try_emplace(mesh.get());
    if (is_new) {
      std::string file;
      for (const char letter : name) {
        const bool is_plain = (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') ||
                              (letter >= 'A' && letter <= 'Z') || letter == '_' || letter == '-';
        file += is_plain ? letter : '_';
      }
      known->second = *mesh_folder_ + '/' + file + '_' + std::to_string(mesh_files_.size()) + ".stl";
      result_.meshes.push_back({known->second, source_text(stl_bytes(*mesh))});
    }
    return "<mesh filename=\"" + escaped_xml(known->second) + "\"/>";
  }

  /// Gazebo has one friction for a link.
  void write_friction(const Link& link) {
    if (link.geometries.empty()) {
      return;
    }
    const std::optional<double> along = link.geometries.front().friction;
    const std::optional<double> across = link.geometries.front().friction_across;
    const bool is_one = std::ranges::all_of(link.geometries, [&](const Geometry& geometry) {
      return geometry.friction == along && geometry.friction_across == across;
    });
    if (!is_one) {
      lose("the friction of link " + in_quotes(link.name) + ", whose geometries have different ones");
    } else if (along) {
      text() += "  <gazebo reference=\"" + escaped_xml(link.name) + "\">\n    <mu1>" + exact_text(*along) +
                "</mu1>\n    <mu2>" + exact_text(across.value_or(*along)) + "</mu2>\n" +
                (across ? "    <fdir1>0 1 0</fdir1>\n" : "") + "  </gazebo>\n";
    }
  }

  void note_losses() {
    lose("the servos (gain " + number_text(robot_->servo.gain) + " 1/s): URDF has only their torque and speed");
    lose("the world, the gait, the touch sensors");
    for (const AttachedSensor& sensor : robot_->sensors) {
      lose("the sensor " + in_quotes(sensor.name));
    }
    const bool has_colours = std::ranges::any_of(robot_->links, [](const Link& link) {
      return std::ranges::any_of(link.looks, [](const Look& look) { return !look.mesh->colours.empty(); });
    });
    if (has_colours) {
      lose("the colours of meshes");
    }
  }

  const RobotModel* robot_;
  const std::string* mesh_folder_;
  std::string base_ = free_name("base_link", *robot_);
  std::map<const TriangleMesh*, std::string> mesh_files_;
  UrdfExport result_;
};

}  // namespace

UrdfExport export_urdf(const RobotModel& robot, const std::string& mesh_folder) {
  return UrdfWriter(robot, mesh_folder).write();
}

}  // namespace proleg::sim
