#include "sim/mjcf/mjcf.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include <Eigen/Eigenvalues>

#include "shared/computer/text/text.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim::mujoco {
namespace {

/// Hardness of a constraint (dmin, dmax, width): 1 would be rigid, and MuJoCo cuts at 0.9999.
constexpr std::string_view hard_contact = "0.9999 0.9999 0.001";
/// A motor that leaves a hundredth of the difference in speed to the next step moves the robot as far as a harder one
/// (within 1 %), and Newton's solver needs a third less time.
constexpr std::string_view hard_motor = "0.99 0.99 0.001";

/// The principal moments of a body, ascending.
Eigen::Vector3d moments_of(const MassProperties& mass) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(mass.inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

/// MuJoCo refuses a moment that is larger than the sum of the two others, by a last bit, too. Solids are at most
/// rounding above it.
constexpr double rounding = 1e-6;
bool is_of_solid(const Eigen::Vector3d& moments) { return moments[2] <= (moments[0] + moments[1]) * (1.0 + rounding); }

/// MuJoCo 2.2.2 and 3 refuse smaller moments.
constexpr double least_moment = 2e-14;  // kg m^2

/// The inertia with what rounding and tiny bodies lack for MuJoCo: the same is added to all moments.
Eigen::Matrix3d compilable_inertia(const MassProperties& mass) {
  const Eigen::Vector3d moments = moments_of(mass);
  constexpr double last_bits = 1e-9;
  const double lacking = moments[2] * (1.0 + last_bits) - moments[0] - moments[1];
  const double more = std::max(is_of_solid(moments) ? lacking : 0.0, least_moment - moments[0]);
  return more > 0.0 ? Eigen::Matrix3d(mass.inertia + more * Eigen::Matrix3d::Identity()) : mass.inertia;
}

/// MuJoCo's own body has the name "world".
std::string body_name(const Link& link, const RobotModel& robot) {
  std::string name = link.name;
  while (name == "world" ||
         (name != link.name && std::ranges::find(robot.links, name, &Link::name) != robot.links.end())) {
    name += '_';
  }
  return name;
}

/// Who reads the text.
enum class Reader : std::uint8_t {
  engine,  ///< sim/mujoco: it fills in the heights of height fields, and sets the speeds of the motors
  user,    ///< any program with MuJoCo
};

class Writer {
 public:
  explicit Writer(Reader reader) : for_user_(reader == Reader::user) {
    text_.precision(std::numeric_limits<double>::max_digits10);
  }

  void write(const RobotModel& robot, const EnvironmentModel& environment, double step_s, std::string_view integrator) {
    const auto is_balanced = [](const auto& body) { return is_of_solid(moments_of(body.mass)); };
    const bool needs_balance = for_user_ && !(std::ranges::all_of(robot.links, is_balanced) &&
                                              std::ranges::all_of(environment.moving_objects, is_balanced));
    text_ << "<mujoco" << (for_user_ ? " model='" + quoted(robot.name) + "'" : "") << ">\n"
          << "<compiler angle='radian' inertiafromgeom='false'" << (needs_balance ? " balanceinertia='true'" : "")
          << "/>\n"
          << "<option solver='Newton' cone='elliptic'" << (for_user_ ? "" : " collision='predefined'")
          << " integrator='" << integrator << "' timestep='" << step_s << "'" << vector("gravity", environment.gravity)
          << "><flag energy='enable' multiccd='enable'/></option>\n";
    if (!for_user_) {
      write_sizes(robot, environment);
    }
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
        write_geometry(geometry, object.pose * geometry.pose, environment_owner, object.name);
      }
    }
    write_links(robot, environment.robot_pose);
    for (std::size_t i = 0; i < environment.moving_objects.size(); ++i) {
      write_object(environment.moving_objects[i], first_object_owner - static_cast<std::ptrdiff_t>(i));
    }
    text_ << "</worldbody>\n<contact>\n";
    write_pairs(environment);
    text_ << "</contact>\n";
    if (for_user_) {
      write_actuators(robot);
      write_start(robot, environment);
    }
    text_ << "</mujoco>\n";
  }

  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  static constexpr std::ptrdiff_t environment_owner = -2;   ///< the environment is no neighbour of a link
  static constexpr std::ptrdiff_t first_object_owner = -3;  ///< the objects that move have this number and smaller ones

  /// A geometry that was written.
  struct Written {
    std::ptrdiff_t owner;  ///< number of a link, or one of the owners below 0
    std::optional<double> friction;
    std::string name;
  };

  /// The text as a value between single quotes.
  static std::string quoted(std::string_view value) {
    std::string text = escaped_xml(one_line(value));
    for (std::size_t at = text.find('\''); at != std::string::npos; at = text.find('\'', at)) {
      text.replace(at, 1, "&apos;");
    }
    return text;
  }

  /// The name of a part of the model; the engine needs none.
  [[nodiscard]] std::string name_attribute(std::string_view name) const {
    return for_user_ ? " name='" + quoted(name) + "'" : "";
  }

  /// For the engine the place in the list; for users a name that no other geometry has.
  [[nodiscard]] std::string geometry_name(const std::string& owner) {
    std::string name = std::to_string(written_.size());
    if (for_user_) {
      name = owner;
      for (std::size_t number = 2; !geometry_names_.insert(name).second; ++number) {
        name = owner + '_' + std::to_string(number);
      }
    }
    return quoted(name);
  }

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
            << "' size='" << field.half_x << ' ' << field.half_y << ' ' << range << ' ' << base << "'";
      if (for_user_) {
        write_elevation(field);
      }
      text_ << "/>\n";
    }
  }

  /// MuJoCo scales heights so that they reach from 0 to the range, and reads the last row of the grid first.
  void write_elevation(const HeightField& field) {
    const double lowest = lowest_of(field);
    std::vector<double> values;
    for (std::size_t row = field.rows; row-- > 0;) {
      for (std::size_t column = 0; column < field.columns; ++column) {
        values.push_back(field.heights[row * field.columns + column] - lowest);
      }
    }
    write_list("elevation", values);
  }

  /// MuJoCo 2.2.2 counts a blank at the end as one number more.
  void write_list(std::string_view attribute, const std::vector<double>& values) {
    text_ << ' ' << attribute << "='";
    for (std::size_t i = 0; i < values.size(); ++i) {
      text_ << (i > 0 ? " " : "") << values[i];
    }
    text_ << "'";
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

  /// owner_name: of the link or object.
  void write_geometry(const Geometry& geometry, Pose pose, std::ptrdiff_t owner, const std::string& owner_name) {
    if (for_user_ && geometry.shape == Shape::surface) {
      return;
    }
    const std::string name = geometry_name(owner_name);
    text_ << "<geom name='" << name << "' contype='0' conaffinity='0'";
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
        break;  // sim/mujoco refuses it
    }
    text_ << place(pose) << "/>\n";
    written_.push_back({owner, geometry.friction, name});
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
      text_ << "<body" << name_attribute(body_name(link, robot)) << place(pose) << ">\n";
      if (i == 0) {
        text_ << "<freejoint/>\n";
      } else {
        write_hinge(robot.joints[i - 1], link);
      }
      write_mass(link.mass);
      for (const Geometry& geometry : link.geometries) {
        write_geometry(geometry, geometry.pose, static_cast<std::ptrdiff_t>(i), link.name);
      }
    }
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      text_ << "</body>\n";
    }
  }

  void write_mass(const MassProperties& mass) {
    const Eigen::Matrix3d inertia = compilable_inertia(mass);
    text_ << "<inertial mass='" << mass.mass << "'" << vector("pos", mass.center) << " fullinertia='" << inertia(0, 0)
          << ' ' << inertia(1, 1) << ' ' << inertia(2, 2) << ' ' << inertia(0, 1) << ' ' << inertia(0, 2) << ' '
          << inertia(1, 2) << "'/>\n";
  }

  void write_object(const MovingObject& object, std::ptrdiff_t owner) {
    text_ << "<body" << place(object.pose) << ">\n<freejoint/>\n";
    write_mass(object.mass);
    for (const Geometry& geometry : object.geometries) {
      write_geometry(geometry, geometry.pose, owner, object.name);
    }
    text_ << "</body>\n";
  }

  void write_hinge(const Joint& joint, const Link& link) {
    const Pose to_link = link.pose.inverse();
    // MuJoCo turns the child against its parent; our angle is that of the link towards the head, here the parent.
    const Eigen::Vector3d axis = to_link.orientation * -joint.axis;
    text_ << "<joint" << name_attribute(joint.name) << " type='hinge'" << vector("pos", to_link * joint.anchor)
          << vector("axis", axis) << range_text("range", joint.lower_limit, joint.upper_limit);
    if (!for_user_) {
      text_ << " frictionloss='" << joint.max_torque << "'";
    }
    text_ << "/>\n";
  }

  /// MuJoCo refuses ranges in which nothing can move.
  static std::string range_text(std::string_view attribute, double lower, double upper) {
    constexpr double min_range = 1e-6;  // rad
    std::ostringstream text;
    text.precision(std::numeric_limits<double>::max_digits10);
    text << ' ' << attribute << "='" << lower << ' ' << std::max(upper, lower + min_range) << "'";
    return text.str();
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
          text_ << "<pair geom1='" << written_[a].name << "' geom2='" << written_[b].name << "' friction='" << mu << ' '
                << mu << " 0 0 0'/>\n";
        }
      }
    }
  }

  /// The servo of Proleg commands a speed, its gain times the error of the angle, and the motor reaches it if its
  /// torque suffices: torque = kv (gain (control - angle) - speed), cut to the torque of the motor.
  void write_actuators(const RobotModel& robot) {
    // Share of its greatest speed by which a motor at its greatest torque is too slow. Of 0.02, 0.1, 0.2, 0.4, 1 and 2
    // the third and the fourth moved the shipped robots most nearly as far as the other engines (MuJoCo 3.14).
    constexpr double slip = 0.2;
    constexpr double right_angle = std::numbers::pi / 2.0;
    text_ << "<actuator>\n";
    for (const Joint& joint : robot.joints) {
      const double kv = joint.max_torque / (slip * joint.max_speed);
      const double kp = kv * robot.servo.gain;
      text_ << "<general" << name_attribute(joint.name) << " joint='" << quoted(joint.name) << "' ctrllimited='true'"
            << range_text("ctrlrange", std::max(joint.lower_limit, -right_angle),
                          std::min(joint.upper_limit, right_angle))
            << " forcelimited='true' forcerange='" << -joint.max_torque << ' ' << joint.max_torque << "' gainprm='"
            << kp << "' biastype='affine' biasprm='0 " << -kp << ' ' << -kv << "'/>\n";
    }
    text_ << "</actuator>\n";
  }

  void write_start(const RobotModel& robot, const EnvironmentModel& environment) {
    std::vector<double> positions;
    const auto add_pose = [&](const Pose& pose) {
      const Eigen::Vector3d& p = pose.position;
      const Eigen::Quaterniond& q = pose.orientation;
      positions.insert(positions.end(), {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
    };
    add_pose(environment.robot_pose * robot.links.front().pose);
    positions.resize(positions.size() + robot.joints.size(), 0.0);
    for (const MovingObject& object : environment.moving_objects) {
      add_pose(object.pose);
    }
    text_ << "<keyframe>\n<key name='start'";
    write_list("qpos", positions);
    text_ << "/>\n</keyframe>\n";
  }

  bool for_user_;
  std::ostringstream text_;
  std::set<std::string> geometry_names_;
  std::vector<Written> written_;
  std::map<const TriangleMesh*, std::size_t> meshes_;        ///< names of the meshes
  std::map<const HeightField*, std::string> height_fields_;  ///< names of the height fields
};

}  // namespace

std::string write_mjcf(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                       Integrator integrator) {
  Writer writer(Reader::engine);
  writer.write(robot, environment, step_s, integrator == Integrator::implicit ? "implicit" : "Euler");
  return writer.text();
}

MjcfExport export_mjcf(const RobotModel& robot, const EnvironmentModel& environment, double step_s) {
  Writer writer(Reader::user);
  // With "implicit" a motor at its greatest torque can make MuJoCo 3.14 throw the robot away.
  writer.write(robot, environment, step_s, "implicitfast");
  MjcfExport result{
      "<!-- Written by 'proleg export'. Only the pairs below touch each other: add one for what you add. -->\n" +
          writer.text(),
      {}};
  const auto lose = [&](const std::string& what) { result.lost.push_back(what); };
  lose("the servos' greatest speed, pulses and latency: an actuator follows its control at once");
  const auto lose_inertia = [&](const std::string& owner, const MassProperties& mass) {
    const Eigen::Vector3d moments = moments_of(mass);
    if (!is_of_solid(moments)) {
      lose("the inertia of " + owner +
           ", which no solid has: balanceinertia replaces its principal moments by their mean");
    } else if (moments[0] < least_moment) {
      lose("the inertia of " + owner + ", which is too small for MuJoCo: it has at least " + number_text(least_moment) +
           " kg m^2");
    }
  };
  lose("the gait, the touch sensors");
  for (const MovingObject& object : environment.moving_objects) {
    lose_inertia("object " + in_quotes(object.name), object.mass);
  }
  for (const AttachedSensor& sensor : robot.sensors) {
    lose("the sensor " + in_quotes(sensor.name));
  }
  if (std::ranges::any_of(robot.links, [](const Link& link) { return !link.looks.empty(); })) {
    lose("meshes that are only shown");
  }
  for (const Link& link : robot.links) {
    if (const std::string name = body_name(link, robot); name != link.name) {
      lose("the name of link " + in_quotes(link.name) + ", which MuJoCo's own body has: it is " + in_quotes(name));
    }
    lose_inertia("link " + in_quotes(link.name), link.mass);
    if (std::ranges::any_of(link.geometries, [](const Geometry& solid) { return solid.friction_across.has_value(); })) {
      lose("the friction across link " + in_quotes(link.name));
    }
  }
  for (const StaticObject& object : environment.objects) {
    if (std::ranges::any_of(object.geometries, [](const Geometry& solid) { return solid.shape == Shape::surface; })) {
      lose("the triangle mesh of object " + in_quotes(object.name) + ": MuJoCo has convex ones only");
    }
  }
  return result;
}

}  // namespace proleg::sim::mujoco
