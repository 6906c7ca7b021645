#include "sim/mujoco/mujoco_world.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim::mujoco {
namespace {

/// Hardness of a constraint (dmin, dmax, width): 1 would be rigid, and MuJoCo cuts at 0.9999.
constexpr std::string_view hard_contact = "0.9999 0.9999 0.001";
/// A motor that leaves a hundredth of the difference in speed to the next step moves the robot as far as a harder one
/// (within 1 %), and Newton's solver needs a third less time.
constexpr std::string_view hard_motor = "0.99 0.99 0.001";

class Writer {
 public:
  Writer() { text_.precision(std::numeric_limits<double>::max_digits10); }

  void write(const RobotModel& robot, const EnvironmentModel& environment, double step_s, Integrator integrator) {
    text_ << "<mujoco>\n"
          << "<compiler angle='radian' inertiafromgeom='false'/>\n"
          << "<option solver='Newton' cone='elliptic' collision='predefined' integrator='"
          << (integrator == Integrator::implicit ? "implicit" : "Euler") << "' timestep='" << step_s << "'"
          << vector("gravity", environment.gravity) << "><flag energy='enable' multiccd='enable'/></option>\n";
    write_sizes(robot, environment);
    text_ << "<default>\n"
          << "<joint limited='true' solimpfriction='" << hard_motor << "' solimplimit='" << hard_contact
          << "' solreflimit='" << reference(step_s) << "'/>\n"
          << "<pair condim='3' solimp='" << hard_contact << "' solref='" << reference(step_s) << "'/>\n"
          << "</default>\n"
          << "<asset>\n";
    write_assets(robot, environment);
    text_ << "</asset>\n<worldbody>\n";
    for (const StaticObject& object : environment.objects) {
      for (const Geometry& geometry : object.geometries) {
        write_geometry(geometry, object.pose * geometry.pose, environment_owner);
      }
    }
    write_links(robot, environment.robot_pose);
    for (std::size_t i = 0; i < environment.moving_objects.size(); ++i) {
      write_object(environment.moving_objects[i], first_object_owner - static_cast<std::ptrdiff_t>(i));
    }
    text_ << "</worldbody>\n<contact>\n";
    write_pairs(environment);
    text_ << "</contact>\n</mujoco>\n";
  }

  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  static constexpr std::ptrdiff_t environment_owner = -2;   ///< the environment is no neighbour of a link
  static constexpr std::ptrdiff_t first_object_owner = -3;  ///< the objects that move have this number and smaller ones

  /// A geometry that was written; its name is its place in the list.
  struct Written {
    std::ptrdiff_t owner;  ///< number of a link, or one of the owners below 0
    std::optional<double> friction;
  };

  /// Reference of a contact as in the Open Dynamics Engine: the next step removes the speed, and a fifth of the depth.
  static std::string reference(double step_s) {
    constexpr double error_reduction = 0.2;
    std::ostringstream text;
    text.precision(std::numeric_limits<double>::max_digits10);
    text << -error_reduction / (step_s * step_s) << ' '
         << -1.0 / step_s;  // negative numbers mean stiffness and damping
    return text.str();
  }

  static std::string vector(std::string_view name, const Eigen::Vector3d& value) {
    std::ostringstream text;
    text.precision(std::numeric_limits<double>::max_digits10);
    text << ' ' << name << "='" << value.x() << ' ' << value.y() << ' ' << value.z() << "'";
    return text.str();
  }

  static std::string place(const Pose& pose) {
    const Eigen::Quaterniond& q = pose.orientation;
    std::ostringstream text;
    text.precision(std::numeric_limits<double>::max_digits10);
    text << vector("pos", pose.position) << " quat='" << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << "'";
    return text.str();
  }

  void write_assets(const RobotModel& robot, const EnvironmentModel& environment) {
    for (const Link& link : robot.links) {
      write_meshes(link.geometries);
    }
    for (const MovingObject& object : environment.moving_objects) {
      write_meshes(object.geometries);
    }
    for (const StaticObject& object : environment.objects) {
      write_meshes(object.geometries);
      for (const Geometry& geometry : object.geometries) {
        if (geometry.heights) {
          write_height_field(*geometry.heights);
        }
      }
    }
  }

  static double lowest_of(const HeightField& field) { return *std::ranges::min_element(field.heights); }

  /// Writes a height field with the model's rows and columns; fill_height_fields() fills in the heights.
  void write_height_field(const HeightField& field) {
    constexpr double least_range = 1e-6;  // m
    constexpr double base = 0.1;          // m, of solid ground below the lowest point
    if (height_fields_.try_emplace(&field, "h" + std::to_string(height_fields_.size())).second) {
      const double range = std::max(*std::ranges::max_element(field.heights) - lowest_of(field), least_range);
      text_ << "<hfield name='" << height_fields_.at(&field) << "' nrow='" << field.rows << "' ncol='" << field.columns
            << "' size='" << field.half_x << ' ' << field.half_y << ' ' << range << ' ' << base << "'/>\n";
    }
  }

  /// Writes the corners of meshes; MuJoCo makes their convex hull.
  void write_meshes(const std::vector<Geometry>& geometries) {
    for (const Geometry& geometry : geometries) {
      if (geometry.shape == Shape::hull && meshes_.try_emplace(geometry.mesh.get(), meshes_.size()).second) {
        text_ << "<mesh name='" << meshes_.at(geometry.mesh.get()) << "' vertex='";
        for (const Eigen::Vector3d& vertex : geometry.mesh->vertices) {
          text_ << vertex.x() << ' ' << vertex.y() << ' ' << vertex.z() << ' ';
        }
        text_ << "'/>\n";
      }
    }
  }

  void write_geometry(const Geometry& geometry, Pose pose, std::ptrdiff_t owner) {
    text_ << "<geom name='" << written_.size() << "' contype='0' conaffinity='0'";
    const Eigen::Vector3d& extents = geometry.extents;
    switch (geometry.shape) {
      case Shape::box:
        text_ << " type='box'" << vector("size", extents);
        break;
      case Shape::sphere:
        text_ << " type='sphere' size='" << extents.x() << "'";
        break;
      case Shape::cylinder:  // MuJoCo's cylinders lie along z, those of the model along y
        text_ << " type='cylinder' size='" << extents.x() << ' ' << extents.y() << "'";
        pose.orientation =
            pose.orientation * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
        break;
      case Shape::hull:
        text_ << " type='mesh' mesh='" << meshes_.at(geometry.mesh.get()) << "'";
        break;
      case Shape::height_field:
        text_ << " type='hfield' hfield='" << height_fields_.at(geometry.heights.get()) << "'";
        pose = pose * Pose{{0.0, 0.0, lowest_of(*geometry.heights)}, Eigen::Quaterniond::Identity()};
        break;
      case Shape::surface:
        break;  // mujoco_world.cpp refuses it
    }
    text_ << place(pose) << "/>\n";
    written_.push_back({owner, geometry.friction});
  }

  /// Writes the sizes of the memory for contacts and constraints. A world that needs more ends with a PhysicsError.
  void write_sizes(const RobotModel& robot, const EnvironmentModel& environment) {
    constexpr std::size_t points = 8;  // contact points of two boxes
    std::size_t contacts = 100;
    for (const Link& link : robot.links) {
      contacts += points * link.geometries.size();
    }
    for (const MovingObject& object : environment.moving_objects) {
      contacts += points * object.geometries.size();
    }
    constexpr std::size_t rows_of_contact = 3;
    constexpr std::size_t rows_of_joint = 2;  // motor and stop
    text_ << "<size nconmax='" << contacts << "' njmax='"
          << rows_of_contact * contacts + rows_of_joint * robot.joints.size() << "'/>\n";
  }

  void write_links(const RobotModel& robot, const Pose& robot_pose) {
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      const Link& link = robot.links[i];
      const Pose pose = i == 0 ? robot_pose * link.pose : robot.links[i - 1].pose.inverse() * link.pose;
      text_ << "<body" << place(pose) << ">\n";
      if (i == 0) {
        text_ << "<freejoint/>\n";
      } else {
        write_hinge(robot.joints[i - 1], link);
      }
      write_mass(link.mass);
      for (const Geometry& geometry : link.geometries) {
        write_geometry(geometry, geometry.pose, static_cast<std::ptrdiff_t>(i));
      }
    }
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      text_ << "</body>\n";
    }
  }

  void write_mass(const MassProperties& mass) {
    const Eigen::Matrix3d& inertia = mass.inertia;
    text_ << "<inertial mass='" << mass.mass << "'" << vector("pos", mass.center) << " fullinertia='" << inertia(0, 0)
          << ' ' << inertia(1, 1) << ' ' << inertia(2, 2) << ' ' << inertia(0, 1) << ' ' << inertia(0, 2) << ' '
          << inertia(1, 2) << "'/>\n";
  }

  void write_object(const MovingObject& object, std::ptrdiff_t owner) {
    text_ << "<body" << place(object.pose) << ">\n<freejoint/>\n";
    write_mass(object.mass);
    for (const Geometry& geometry : object.geometries) {
      write_geometry(geometry, geometry.pose, owner);
    }
    text_ << "</body>\n";
  }

  void write_hinge(const Joint& joint, const Link& link) {
    const Pose to_link = link.pose.inverse();
    // MuJoCo turns the child against its parent; our angle is that of the link towards the head, here the parent.
    const Eigen::Vector3d axis = to_link.orientation * -joint.axis;
    constexpr double min_range = 1e-6;  // rad; MuJoCo refuses joints that cannot turn
    text_ << "<joint type='hinge'" << vector("pos", to_link * joint.anchor) << vector("axis", axis) << " range='"
          << joint.lower_limit << ' ' << std::max(joint.upper_limit, joint.lower_limit + min_range)
          << "' frictionloss='" << joint.max_torque << "'/>\n";
  }

  void write_pairs(const EnvironmentModel& environment) {
    for (std::size_t a = 0; a < written_.size(); ++a) {
      for (std::size_t b = a + 1; b < written_.size(); ++b) {
        const std::ptrdiff_t owner = written_[a].owner;
        const std::ptrdiff_t other = written_[b].owner;
        const bool are_links = owner >= 0 && other >= 0;
        const bool touches = are_links ? environment.self_collision && std::abs(owner - other) > 1 : owner != other;
        if (touches) {
          const double mu = friction_of(written_[a].friction, written_[b].friction, environment.unspecified_friction);
          text_ << "<pair geom1='" << a << "' geom2='" << b << "' friction='" << mu << ' ' << mu << " 0 0 0'/>\n";
        }
      }
    }
  }

  std::ostringstream text_;
  std::vector<Written> written_;
  std::map<const TriangleMesh*, std::size_t> meshes_;        ///< names of the meshes
  std::map<const HeightField*, std::string> height_fields_;  ///< names of the height fields
};

}  // namespace

std::string write_mjcf(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                       Integrator integrator) {
  Writer writer;
  writer.write(robot, environment, step_s, integrator);
  return writer.text();
}

}  // namespace proleg::sim::mujoco
