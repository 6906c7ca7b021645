#include "sim/urdf/urdf_robot.hpp"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <array>
#include <exception>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/tag_scanner.hpp"
#include "sim/scenario/xml_document.hpp"
#include "sim/urdf/urdf_check.hpp"

namespace proleg::sim {
namespace {

/// Keeps what urdfdom would print.
class LogCollector final : public console_bridge::OutputHandler {
 public:
  LogCollector() { console_bridge::useOutputHandler(this); }
  ~LogCollector() override { console_bridge::restorePreviousOutputHandler(); }
  LogCollector(const LogCollector&) = delete;
  LogCollector& operator=(const LogCollector&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/, int /*line*/) override {
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_error_.empty()) {
      first_error_ = text;
    }
  }
  [[nodiscard]] const std::string& first_error() const { return first_error_; }

 private:
  std::string first_error_;
};

Eigen::Vector3d vector_of(const ::urdf::Vector3& value) { return {value.x, value.y, value.z}; }

Pose pose_of(const ::urdf::Pose& pose) {
  const ::urdf::Rotation& q = pose.rotation;
  return {vector_of(pose.position), Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized()};
}

std::optional<MassProperties> mass_of(const ::urdf::Link& link) {
  if (!link.inertial || link.inertial->mass <= 0.0) {
    return std::nullopt;
  }
  const ::urdf::Inertial& from = *link.inertial;
  const Pose pose = pose_of(from.origin);
  Eigen::Matrix3d inertia;
  inertia << from.ixx, from.ixy, from.ixz, from.ixy, from.iyy, from.iyz, from.ixz, from.iyz, from.izz;
  const Eigen::Matrix3d rotation = pose.orientation.toRotationMatrix();
  const Eigen::Matrix3d turned = rotation * inertia * rotation.transpose();
  // A rotation of no angle keeps each bit.
  const bool is_turned = !rotation.isIdentity(0.0);
  return MassProperties{from.mass, pose.position, is_turned ? turned : inertia};
}

UrdfShape shape_of(const ::urdf::Geometry& geometry, const ::urdf::Pose& origin, int line) {
  UrdfShape shape;
  shape.pose = pose_of(origin);
  shape.line = line;
  switch (geometry.type) {
    case ::urdf::Geometry::BOX:
      shape.kind = UrdfShape::Kind::box;
      shape.size = vector_of(dynamic_cast<const ::urdf::Box&>(geometry).dim);
      break;
    case ::urdf::Geometry::SPHERE:
      shape.kind = UrdfShape::Kind::sphere;
      shape.size.x() = dynamic_cast<const ::urdf::Sphere&>(geometry).radius;
      break;
    case ::urdf::Geometry::CYLINDER: {
      const auto& cylinder = dynamic_cast<const ::urdf::Cylinder&>(geometry);
      shape.kind = UrdfShape::Kind::cylinder;
      shape.size.x() = cylinder.radius;
      shape.size.y() = cylinder.length;
      break;
    }
    case ::urdf::Geometry::MESH: {
      const auto& mesh = dynamic_cast<const ::urdf::Mesh&>(geometry);
      shape.kind = UrdfShape::Kind::mesh;
      shape.mesh = mesh.filename;
      shape.size = vector_of(mesh.scale);
      break;
    }
  }
  return shape;
}

/// urdfdom lists the <visual>s and the <collision>s of a link in the order of the file.
std::vector<int> lines_of(const XmlElement& link, std::string_view tag) {
  std::vector<int> lines;
  for (const XmlElement& child : link.children()) {
    if (child.is(tag)) {
      lines.push_back(child.line());
    }
  }
  return lines;
}

int line_at_place(const std::vector<int>& lines, std::size_t place, const XmlElement& link) {
  return place < lines.size() ? lines[place] : link.line();
}

UrdfLink link_of(const ::urdf::Link& from, const XmlElement& element) {
  UrdfLink link;
  link.name = from.name;
  link.line = element.line();
  link.mass = mass_of(from);
  const std::vector<int> visual_lines = lines_of(element, "visual");
  for (const ::urdf::VisualSharedPtr& visual : from.visual_array) {
    UrdfShape shape =
        shape_of(*visual->geometry, visual->origin, line_at_place(visual_lines, link.visuals.size(), element));
    if (visual->material && visual->material->texture_filename.empty()) {
      const ::urdf::Color& colour = visual->material->color;
      shape.colour = Eigen::Vector3f(colour.r, colour.g, colour.b).cast<double>();
    }
    link.visuals.push_back(std::move(shape));
  }
  const std::vector<int> collision_lines = lines_of(element, "collision");
  for (const ::urdf::CollisionSharedPtr& collision : from.collision_array) {
    link.collisions.push_back(shape_of(*collision->geometry, collision->origin,
                                       line_at_place(collision_lines, link.collisions.size(), element)));
  }
  return link;
}

UrdfJoint joint_of(const ::urdf::Joint& from, const XmlElement& element,
                   const std::map<std::string, std::size_t>& links) {
  UrdfJoint joint;
  joint.name = from.name;
  joint.line = element.line();
  joint.kind = from.type == ::urdf::Joint::REVOLUTE     ? UrdfJoint::Kind::revolute
               : from.type == ::urdf::Joint::CONTINUOUS ? UrdfJoint::Kind::continuous
                                                        : UrdfJoint::Kind::fixed;
  joint.parent = links.at(element.required_child("parent").required_attribute("link"));
  joint.child = links.at(element.required_child("child").required_attribute("link"));
  joint.origin = pose_of(from.parent_to_joint_origin_transform);
  if (joint.kind != UrdfJoint::Kind::fixed) {
    joint.axis = vector_of(from.axis).normalized();
  }
  if (from.limits) {
    joint.lower = from.limits->lower;
    joint.upper = from.limits->upper;
    joint.effort = from.limits->effort;
    joint.velocity = from.limits->velocity;
  }
  return joint;
}

/// The line of a link or joint that a message of urdfdom names in brackets or quotes; otherwise that of the root.
int line_named_by(const std::string& message, const UrdfElements& elements) {
  for (const std::vector<XmlElement>* list : {&elements.joints, &elements.links}) {
    for (const XmlElement& element : *list) {
      const std::string name = element.required_attribute("name");
      if (message.find("[" + name + "]") != std::string::npos || message.find("'" + name + "'") != std::string::npos) {
        return element.line();
      }
    }
  }
  return 0;
}

::urdf::ModelInterfaceSharedPtr parse(const std::string& text, const std::string& file, const UrdfElements& elements) {
  static std::mutex mutex;  // the log is one for the whole process
  const std::lock_guard lock(mutex);
  const LogCollector log;
  const auto refuse = [&](const std::string& reason) {
    throw InputError(file, line_named_by(reason, elements),
                     "what urdfdom refuses" + (reason.empty() ? "" : ": " + one_line(shortened(reason, 300))),
                     "a robot in URDF");
  };
  ::urdf::ModelInterfaceSharedPtr model;
  try {
    model = ::urdf::parseURDF(text);
  } catch (const std::exception& error) {
    refuse(error.what());
  }
  if (!model || !log.first_error().empty()) {
    refuse(log.first_error());
  }
  return model;
}

/// Other encodings than UTF-8 begin with a mark, or have a byte 0 in their first tag.
void require_utf8(const std::string& file, const std::string& text) {
  const bool is_utf16 = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") ||
                        (text.size() > 1 && (text[0] == '\0' || text[1] == '\0'));
  if (is_utf16) {
    throw InputError(file, 1, "text in UTF-16", "a URDF file in UTF-8");
  }
}

}  // namespace

UrdfRobot read_urdf(const std::filesystem::path& path, const std::string& text) {
  require_utf8(name_of(path), text);
  const XmlDocument document(path, text, nullptr);
  UrdfElements elements = check_urdf(document);
  const ::urdf::ModelInterfaceSharedPtr model =
      parse(std::string(without_byte_order_mark(text)), document.name(), elements);

  UrdfRobot robot;
  robot.file = document.name();
  robot.name = model->getName();
  std::map<std::string, std::size_t> numbers;
  const auto known = [&](const auto& found, const XmlElement& element) -> decltype(*found)& {
    if (!found) {
      element.refuse(
          element.label() + " " + in_quotes(element.required_attribute("name")) + ", which urdfdom does not find",
          "tags and attributes in small letters");
    }
    return *found;
  };
  for (const XmlElement& element : elements.links) {
    const std::string name = element.required_attribute("name");
    UrdfLink link = link_of(known(model->getLink(name), element), element);
    if (const auto friction = elements.friction.find(name); friction != elements.friction.end()) {
      link.friction = friction->second;
    }
    numbers.emplace(name, robot.links.size());
    robot.links.push_back(std::move(link));
  }
  for (const XmlElement& element : elements.joints) {
    robot.joints.push_back(
        joint_of(known(model->getJoint(element.required_attribute("name")), element), element, numbers));
  }
  const std::size_t count = robot.links.size();
  std::vector<bool> is_child(count, false);
  for (const UrdfJoint& joint : robot.joints) {
    is_child[joint.child] = true;
  }
  robot.root = static_cast<std::size_t>(std::ranges::find(is_child, false) - is_child.begin());
  robot.lost = std::move(elements.lost);
  return robot;
}

}  // namespace proleg::sim
