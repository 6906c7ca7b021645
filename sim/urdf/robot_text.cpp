#include "sim/urdf/robot_text.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/xml_text.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

/// A number without the last bits that turning and adding poses leave.
std::string number(double value) {
  constexpr double grid = 1e9;
  constexpr double rounding = 1e-12;
  const double even = std::round(value * grid) / grid;
  const double shown = std::abs(value - even) < rounding ? even : value;
  return exact_text(shown == 0.0 ? 0.0 : shown);
}

std::string vector_text(const Eigen::Vector3d& value) {
  return number(value.x()) + ' ' + number(value.y()) + ' ' + number(value.z());
}

/// The lines <translation> and <quat> of a pose, those that are needed.
std::string pose_text(const Pose& pose, const std::string& indent) {
  std::string text;
  constexpr double none = 1e-12;
  if (pose.position.norm() > none) {
    text += indent + "<translation>" + vector_text(pose.position) + "</translation>\n";
  }
  const Eigen::Quaterniond& q = pose.orientation;
  if (q.vec().norm() > none) {
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;
    text += indent + "<quat>" + number(sign * q.w()) + ' ' + vector_text(sign * q.vec()) + "</quat>\n";
  }
  return text;
}

class RobotWriter {
 public:
  RobotWriter(const UrdfRobot& robot, const UrdfChain& chain, const std::string& source,
              const RobotTextOptions& options, ImportedMeshes& meshes)
      : robot_(&robot), chain_(&chain), source_(&source), options_(options), meshes_(&meshes) {}

  RobotText run() {
    result_.text.add(
        "<!-- Made by 'proleg import' of " + comment_text(*source_) +
            ". x is to the right, y forward, z up: the robot of the\n     URDF file is turned by 90 degrees. -->\n" +
            "<Robot name=\"" + escaped_xml(one_line(robot_->name)) + "\">\n" +
            "  <!-- URDF has no servo. This one is almost ideal: gain in 1/s, a new pulse every millisecond. -->\n" +
            "  <servo>\n    <gain>50</gain>\n    <period unit=\"ms\">1</period>\n  </servo>\n" +
            "  <KinBody name=\"body\">\n",
        robot_->links[robot_->root].line);
    for (const UrdfBody& body : chain_->bodies) {
      write_body(body);
    }
    for (const UrdfHinge& joint : chain_->joints) {
      write_joint(joint);
    }
    result_.text.add("  </KinBody>\n</Robot>\n", 0);
    note_defaults();
    if (has_hull_) {
      note("meshes touch with their convex hulls");
    }
    if (has_plain_colour_) {
      lose("colours of boxes, spheres and cylinders: views draw them in colours of their own");
    }
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(int line, const std::string& found, const std::string& expected) const {
    throw InputError(robot_->file, line, found, expected);
  }

  void lose(const std::string& text) {
    if (std::ranges::find(result_.lost, text) == result_.lost.end()) {
      result_.lost.push_back(text);
    }
  }
  void note(const std::string& text) { result_.notes.push_back(text); }

  static std::string at_line(int line) { return " (line " + std::to_string(line) + ")"; }

  void write_body(const UrdfBody& body) {
    result_.text.add(
        "    <Body name=\"" + escaped_xml(body.name) + "\" type=\"dynamic\">\n" + pose_text(body.pose, "      "),
        body.line);
    std::vector<bool> is_shown(body.visuals.size(), false);
    for (const UrdfBody::Solid& solid : body.collisions) {
      write_collision(body, solid, is_shown);
    }
    for (std::size_t v = 0; v < body.visuals.size(); ++v) {
      if (!is_shown[v]) {
        write_visual(body, body.visuals[v]);
      }
    }
    write_mass(body);
    result_.text.add("    </Body>\n", body.line);
  }

  static bool is_same_pose(const Pose& a, const Pose& b) {
    constexpr double same = 1e-9;
    return (a.position - b.position).norm() < same && a.orientation.angularDistance(b.orientation) < 1e-7;
  }
  static bool is_same_shape(const UrdfShape& a, const UrdfShape& b) {
    return a.kind == b.kind && a.mesh == b.mesh && a.size == b.size && is_same_pose(a.pose, b.pose);
  }

  /// A solid with what is shown in its place: a visual that is the same, or a mesh at the same pose.
  void write_collision(const UrdfBody& body, const UrdfBody::Solid& solid, std::vector<bool>& is_shown) {
    const UrdfShape& shape = solid.shape;
    std::optional<Eigen::Vector3d> colour = shape.colour;
    std::string render;
    for (std::size_t v = 0; v < body.visuals.size(); ++v) {
      const UrdfShape& visual = body.visuals[v];
      if (is_shown[v]) {
        continue;
      }
      if (is_same_shape(visual, shape)) {
        is_shown[v] = true;
        colour = visual.colour;
        render.clear();
        break;
      }
      if (render.empty() && visual.kind == UrdfShape::Kind::mesh && is_same_pose(visual.pose, shape.pose)) {
        if (const std::optional<std::string> file = visual_file(body, visual)) {
          render = mesh_text("render", *file, visual.size);
          colour = visual.colour;
        }
        is_shown[v] = true;
      }
    }
    std::string inner = size_text(body, shape);
    Pose pose = shape.pose;
    if (shape.kind == UrdfShape::Kind::cylinder) {
      // Cylinders of URDF lie along z, those of Proleg along y.
      pose.orientation =
          pose.orientation * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
    }
    inner += render;
    if (colour) {
      if (shape.kind == UrdfShape::Kind::mesh || !render.empty()) {
        inner += colour_text(*colour);
      } else {
        has_plain_colour_ = true;
      }
    }
    if (solid.friction) {
      inner += "        <friction>" + exact_text(*solid.friction) + "</friction>\n";
    }
    result_.text.add(
        "      <Geom type=\"" + type_of(shape) + "\">\n" + pose_text(pose, "        ") + inner + "      </Geom>\n",
        shape.line);
  }

  void write_visual(const UrdfBody& body, const UrdfShape& visual) {
    if (visual.kind != UrdfShape::Kind::mesh) {
      lose("the look of link " + in_quotes(body.name) +
           ": a box, sphere or cylinder is shown where it touches, and only meshes can be shown alone" +
           at_line(visual.line));
      return;
    }
    if (const std::optional<std::string> file = visual_file(body, visual)) {
      result_.text.add("      <Geom type=\"trimesh\">\n" + pose_text(visual.pose, "        ") +
                           mesh_text("render", *file, visual.size) +
                           (visual.colour ? colour_text(*visual.colour) : "") + "      </Geom>\n",
                       visual.line);
    }
  }

  static std::string colour_text(const Eigen::Vector3d& colour) {
    const auto part = [](double value) { return number(std::round(std::clamp(value, 0.0, 1.0) * 1e4) / 1e4); };
    return "        <diffuseColor>" + part(colour.x()) + ' ' + part(colour.y()) + ' ' + part(colour.z()) +
           "</diffuseColor>\n";
  }

  static std::string type_of(const UrdfShape& shape) {
    switch (shape.kind) {
      case UrdfShape::Kind::box:
        return "box";
      case UrdfShape::Kind::sphere:
        return "sphere";
      case UrdfShape::Kind::cylinder:
        return "cylinder";
      case UrdfShape::Kind::mesh:
        break;
    }
    return "trimesh";
  }

  std::string size_text(const UrdfBody& body, const UrdfShape& shape) {
    const auto line = [](const std::string& tag, const std::string& value) {
      return "        <" + tag + ">" + value + "</" + tag + ">\n";
    };
    switch (shape.kind) {
      case UrdfShape::Kind::box:
        return line("extents", vector_text(shape.size / 2.0));
      case UrdfShape::Kind::sphere:
        return line("radius", number(shape.size.x()));
      case UrdfShape::Kind::cylinder:
        return line("radius", number(shape.size.x())) + line("height", number(shape.size.y()));
      case UrdfShape::Kind::mesh:
        break;
    }
    has_hull_ = true;
    return mesh_text("data", collision_file(body, shape), shape.size);
  }

  static std::string mesh_text(const std::string& tag, const std::string& file, const Eigen::Vector3d& scale) {
    const std::string factors = scale == Eigen::Vector3d::Ones() ? "" : ' ' + vector_text(scale);
    return "        <" + tag + ">" + escaped_xml(file) + factors + "</" + tag + ">\n";
  }

  std::string collision_file(const UrdfBody& body, const UrdfShape& shape) {
    if ((shape.size.array() <= 0.0).any()) {
      refuse(shape.line,
             "the scale " + in_quotes(vector_text(shape.size)) + " of a mesh of link " + in_quotes(body.name),
             "factors above 0; save a mirrored mesh as a file of its own");
    }
    if (!is_mesh_file_name(shape.mesh)) {
      refuse(shape.line, "the mesh " + in_quotes(shape.mesh),
             "a file that ends with " + std::string(mesh_file_endings));
    }
    const ImportedMeshes::Named mesh = meshes_->touching(shape.mesh);
    if (mesh.file.empty()) {
      throw InputError(robot_->file + ':' + std::to_string(shape.line) + ": " + mesh.problem);
    }
    return mesh.file;
  }

  /// Without its look a robot moves as with it.
  std::optional<std::string> visual_file(const UrdfBody& body, const UrdfShape& shape) {
    const std::string what = "the look " + in_quotes(shape.mesh) + " of link " + in_quotes(body.name) + ": ";
    if ((shape.size.array() <= 0.0).any()) {
      lose(what + "a mirrored mesh" + at_line(shape.line));
      return std::nullopt;
    }
    if (!is_mesh_file_name(shape.mesh)) {
      lose(what + "files that can be shown end with " + std::string(mesh_file_endings) + at_line(shape.line));
      return std::nullopt;
    }
    ImportedMeshes::Named mesh = meshes_->shown(shape.mesh, shape.size);
    if (mesh.file.empty()) {
      lose(what + mesh.problem + at_line(shape.line));
      return std::nullopt;
    }
    return std::move(mesh.file);
  }

  void write_mass(const UrdfBody& body) {
    if (!body.mass) {
      if (body.collisions.empty()) {
        refuse(body.line, "link " + in_quotes(body.name) + " between joints, without <inertial> and <collision>",
               "a mass, or a geometry to compute one from");
      }
      note("link " + in_quotes(body.name) + " has no mass: that of its geometry at " + number_text(options_.density) +
           " kg/m^3" + at_line(body.line));
      result_.text.add("      <Mass type=\"mimicgeom\">\n        <density>" + number(options_.density) +
                           "</density>\n      </Mass>\n",
                       body.line);
      return;
    }
    if (body.mass->mass < masses.min || body.mass->mass > masses.max) {
      refuse(body.line, "a mass of " + number_text(body.mass->mass) + " kg of link " + in_quotes(body.name),
             number_text(masses.min) + " to " + number_text(masses.max) +
                 " kg, or 0 for a mass that its geometry gives; usually it is not in kilograms");
    }
    result_.text.add("      <Mass type=\"custom\">\n        <total>" + exact_text(body.mass->mass) +
                         "</total>\n        <com>" + vector_text(body.mass->center) + "</com>\n" + inertia_text(body) +
                         "      </Mass>\n",
                     body.line);
  }

  /// Without an <inertia>, Proleg computes that of the geometry.
  std::string inertia_text(const UrdfBody& body) {
    const bool is_good = has_good_inertia(body);
    if (!is_good && body.lacks_inertia) {
      if (body.collisions.empty()) {
        refuse(body.line, "link " + in_quotes(body.name) + " with a mass and without moments of inertia",
               "ixx, iyy and izz above 0, or a <collision> to compute them from");
      }
      note("link " + in_quotes(body.name) + " has no moments of inertia, or they are 0: its geometry gives them" +
           at_line(body.line));
      return "";
    }
    std::string rows;
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 3; ++column) {
        rows +=
            (rows.empty() ? "" : " ") + exact_text(body.mass->inertia(std::min(row, column), std::max(row, column)));
      }
    }
    return "        <inertia>" + rows + "</inertia>\n";
  }

  /// Throws InputError for a bad one, unless a link without an inertia is the cause.
  [[nodiscard]] bool has_good_inertia(const UrdfBody& body) const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(body.mass->inertia, Eigen::EigenvaluesOnly);
    const Eigen::Vector3d& moments = solver.eigenvalues();
    constexpr double least_ratio = 1e-9;
    if (moments[0] > least_ratio * moments[2]) {
      return true;
    }
    if (!body.lacks_inertia) {
      refuse(body.line,
             "link " + in_quotes(body.name) + " with an inertia that is not positive definite (principal moments " +
                 number_text(moments[0]) + ", " + number_text(moments[1]) + ", " + number_text(moments[2]) + " kg m^2)",
             "that of a solid; usually it was computed from a mesh in mm, or a product of inertia has the wrong sign");
    }
    return false;
  }

  void write_joint(const UrdfHinge& joint) {
    std::string text = "    <Joint name=\"" + escaped_xml(joint.name) + "\" type=\"hinge\">\n";
    // The body towards the tail first: the angle turns the other one. If that is the parent, it turns against the
    // child.
    const bool turns_child = joint.child > joint.parent;
    for (const std::size_t body : {std::min(joint.parent, joint.child), std::max(joint.parent, joint.child)}) {
      text += "      <body>" + escaped_xml(chain_->bodies[body].name) + "</body>\n";
    }
    text += "      <offsetfrom>" + escaped_xml(chain_->bodies[joint.child].name) + "</offsetfrom>\n";
    if (joint.anchor.norm() > 1e-12) {
      text += "      <anchor>" + vector_text(joint.anchor) + "</anchor>\n";
    }
    text += "      <axis>" + vector_text(turns_child ? joint.axis : -joint.axis) + "</axis>\n";
    text += "      <maxtorque>" + number(joint.effort > 0.0 ? joint.effort : options_.torque) + "</maxtorque>\n";
    text += "      <maxvel>" + number(joint.velocity > 0.0 ? joint.velocity : default_joint_speed) + "</maxvel>\n";
    text += "      <limitsdeg>" + number(joint.lower * degrees_per_radian) + ' ' +
            number(joint.upper * degrees_per_radian) + "</limitsdeg>\n    </Joint>\n";
    result_.text.add(text, joint.line);
  }

  void note_defaults() {
    std::vector<std::string> without_torque;
    std::vector<std::string> without_speed;
    for (const UrdfHinge& joint : chain_->joints) {
      if (joint.effort <= 0.0) {
        without_torque.push_back(joint.name);
      }
      if (joint.velocity <= 0.0) {
        without_speed.push_back(joint.name);
      }
    }
    if (!without_torque.empty()) {
      note("effort is missing or 0: " + number_text(options_.torque) + " Nm, which lifts half of the robot, for " +
           listed(without_torque));
    }
    if (!without_speed.empty()) {
      note("velocity is missing or 0: " + number_text(default_joint_speed) + " rad/s for " + listed(without_speed));
    }
  }

  const UrdfRobot* robot_;
  const UrdfChain* chain_;
  const std::string* source_;
  RobotTextOptions options_;
  ImportedMeshes* meshes_;
  RobotText result_;
  bool has_hull_ = false;
  bool has_plain_colour_ = false;
};

}  // namespace

RobotText write_robot_text(const UrdfRobot& robot, const UrdfChain& chain, const std::string& source,
                           const RobotTextOptions& options, ImportedMeshes& meshes) {
  return RobotWriter(robot, chain, source, options, meshes).run();
}

}  // namespace proleg::sim
