#include "sim/urdf/urdf_robot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/xml_document.hpp"
#include "sim/urdf/urdf_check.hpp"

namespace proleg::sim {
namespace {

constexpr Range inertia_moments{-1e12, 1e12, "kg m^2"};
/// Torques and speeds of joints. Files write -1, or a number above these, for none.
constexpr double least_limit = 1e-9;
constexpr double most_limit = 1e6;
constexpr double no_angle_limit = 1e3;  // rad; files write 999999 for none
constexpr Range every_number{-1e300, 1e300, ""};

std::optional<MassProperties> read_mass(const XmlElement& link, UrdfRemarks& remarks) {
  const auto inertial = link.child("inertial");
  if (!inertial || inertial->children().empty()) {
    return std::nullopt;
  }
  lose_others(*inertial, {}, {"origin", "mass", "inertia"}, remarks);
  const XmlElement mass = inertial->required_child("mass");
  lose_others(mass, {"value"}, {}, remarks);
  MassProperties result;
  result.mass = urdf_number(mass, "value", any_number);
  if (result.mass < 0.0) {
    mass.refuse("a mass of " + urdf_value(mass, "value") + " kg in link " + in_quotes(urdf_name(link, "name")),
                "a mass above 0, or 0 for a frame without mass");
  }
  const Pose pose = urdf_origin(*inertial, remarks);
  result.center = pose.position;
  result.inertia.setZero();
  if (const auto inertia = inertial->child("inertia")) {
    lose_others(*inertia, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, {}, remarks);
    const auto moment = [&](std::string_view name) { return urdf_number(*inertia, name, inertia_moments); };
    const auto product = [&](std::string_view name) {
      if (!inertia->attribute(name)) {
        remarks.notes.add("products of inertia that are missing are 0", inertia->line());
        return 0.0;
      }
      return moment(name);
    };
    const double xy = product("ixy");
    const double xz = product("ixz");
    const double yz = product("iyz");
    result.inertia << moment("ixx"), xy, xz, xy, moment("iyy"), yz, xz, yz, moment("izz");
  }
  if (result.mass == 0.0) {
    return std::nullopt;
  }
  // A rotation of no angle keeps each bit.
  if (const Eigen::Matrix3d rotation = pose.orientation.toRotationMatrix(); !rotation.isIdentity(0.0)) {
    result.inertia = (rotation * result.inertia * rotation.transpose()).eval();
  }
  return result;
}

class RobotReader {
 public:
  RobotReader(const XmlDocument& document, UrdfRobot& robot)
      : elements_(check_urdf(document, remarks_)), robot_(&robot) {
    const XmlElement root = document.root("robot");
    robot.file = document.name();
    robot.name = root.attribute("name") ? urdf_value(root, "name") : "";
    if (robot.name.empty()) {
      robot.name = "robot";
      remarks_.notes.add("the robot has no name: it is called 'robot'", root.line());
    }
  }

  void run() {
    for (const XmlElement& element : elements_.links) {
      numbers_.emplace(urdf_name(element, "name"), robot_->links.size());
      robot_->links.push_back(read_link(element));
    }
    for (const XmlElement& element : elements_.joints) {
      robot_->joints.push_back(read_joint(element));
    }
    std::vector<bool> is_child(robot_->links.size(), false);
    for (const UrdfJoint& joint : robot_->joints) {
      is_child[joint.child] = true;
    }
    robot_->root = static_cast<std::size_t>(std::ranges::find(is_child, false) - is_child.begin());
    robot_->lost = remarks_.lost.with_lines();
    robot_->notes = remarks_.notes.with_lines();
    robot_->warnings = remarks_.warnings.as_warnings(robot_->file);
  }

 private:
  UrdfLink read_link(const XmlElement& element) {
    lose_others(element, {"name"}, {"inertial", "visual", "collision"}, remarks_);
    UrdfLink link;
    link.name = urdf_name(element, "name");
    link.line = element.line();
    link.mass = read_mass(element, remarks_);
    if (const auto friction = elements_.friction.find(link.name); friction != elements_.friction.end()) {
      link.friction = friction->second;
    }
    for (const XmlElement& child : element.children()) {
      const bool is_look = child.is("visual");
      if (!is_look && !child.is("collision")) {
        continue;
      }
      std::vector<UrdfShape>& shapes = is_look ? link.visuals : link.collisions;
      try {
        const std::vector<UrdfShape> read =
            is_look ? urdf_looks(child, elements_, remarks_) : urdf_shapes(child, remarks_);
        shapes.insert(shapes.end(), read.begin(), read.end());
      } catch (const InputError& error) {
        if (!is_look || !elements_.has_collision) {
          throw;
        }
        remarks_.lost.add("the look of link " + in_quotes(link.name) + ": " + error.problem(), error.line());
      }
    }
    return link;
  }

  UrdfJoint read_joint(const XmlElement& element) {
    UrdfJoint joint;
    joint.name = urdf_name(element, "name");
    joint.line = element.line();
    const std::string type = element.required_attribute("type");
    joint.kind = type == "revolute"     ? UrdfJoint::Kind::revolute
                 : type == "continuous" ? UrdfJoint::Kind::continuous
                                        : UrdfJoint::Kind::fixed;
    for (const auto& [end, number] : {std::pair("parent", &joint.parent), std::pair("child", &joint.child)}) {
      const XmlElement link = element.required_child(end);
      lose_others(link, {"link"}, {}, remarks_);
      *number = numbers_.at(urdf_name(link, "link"));
    }
    joint.origin = urdf_origin(element, remarks_);
    lose_others(element, {"name", "type"},
                {"origin", "parent", "child", "axis", "limit", "mimic", has_damping(element) ? "limit" : "dynamics"},
                remarks_);
    if (joint.kind != UrdfJoint::Kind::fixed) {
      joint.axis = read_axis(element, joint.name);
      read_limits(element, joint);
    }
    return joint;
  }

  static bool has_damping(const XmlElement& joint) {
    return std::ranges::any_of(joint.children(), [](const XmlElement& child) {
      return child.is("dynamics") && std::ranges::any_of(child.attribute_names(), [&](const std::string& name) {
               return parse_number(child.attribute(name).value_or("")) != 0.0;
             });
    });
  }

  Eigen::Vector3d read_axis(const XmlElement& joint, const std::string& name) {
    const auto axis = joint.child("axis");
    if (!axis) {
      return Eigen::Vector3d::UnitX();
    }
    lose_others(*axis, {"xyz"}, {}, remarks_);
    const std::vector<double> xyz = urdf_numbers(*axis, "xyz", 3, directions);
    const Eigen::Vector3d direction(xyz[0], xyz[1], xyz[2]);
    constexpr double least = 1e-6;
    if (direction.norm() < least) {
      axis->refuse("the axis " + in_quotes(urdf_value(*axis, "xyz")) + " of joint " + in_quotes(name),
                   "a direction that is not 0");
    }
    return direction.normalized();
  }

  void read_limits(const XmlElement& element, UrdfJoint& joint) {
    const bool is_revolute = joint.kind == UrdfJoint::Kind::revolute;
    const auto limit = is_revolute ? element.required_child("limit") : element.child("limit");
    if (!limit) {
      return;
    }
    lose_others(*limit, {"lower", "upper", "effort", "velocity"}, {}, remarks_);
    joint.effort = read_most(*limit, "effort");
    joint.velocity = read_most(*limit, "velocity");
    const auto angle = [&](std::string_view name) {
      return limit->attribute(name) ? urdf_number(*limit, name, every_number) : 0.0;
    };
    const double lower = angle("lower");
    const double upper = angle("upper");
    const double largest = std::max(std::abs(lower), std::abs(upper));
    if (!is_revolute) {
      if (largest > 0.0 && largest < no_angle_limit) {
        remarks_.lost.add("the angles of <limit> in a continuous joint", limit->line());
      }
      return;
    }
    const std::string both =
        number_text(lower) + " to " + number_text(upper) + " rad of joint " + in_quotes(joint.name);
    if (lower > upper) {
      limit->refuse("limits " + both, "the smaller one as the lower limit");
    }
    if (lower == upper) {
      remarks_.notes.add("limits " + both + ": it does not move", limit->line());
    }
    constexpr double turn = 2.0 * std::numbers::pi * 1.001;  // files round
    if (largest > turn && largest <= no_angle_limit) {
      remarks_.warnings.add("limits", "limits " + both + "; usually they are in degrees, and URDF has radians",
                            limit->line());
    }
    joint.lower = lower;
    joint.upper = upper;
  }

  /// An effort or a velocity; 0 if it is missing, or no limit.
  double read_most(const XmlElement& limit, std::string_view attribute) {
    if (!limit.attribute(attribute)) {
      return 0.0;
    }
    const std::string text = urdf_value(limit, attribute);
    constexpr std::array<std::string_view, 4> endless{"inf", "+inf", "infinity", "+infinity"};
    const bool is_endless = std::ranges::find(endless, lower_case(text)) != endless.end();
    const double value = is_endless ? any_number.max : urdf_number(limit, attribute, every_number);
    if (value < 0.0 || value > most_limit) {
      remarks_.notes.add(
          std::string(attribute) + '=' + in_quotes(text) + " in <limit> means no limit: as if it is missing",
          limit.line());
      return 0.0;
    }
    return value < least_limit ? 0.0 : value;
  }

  UrdfRemarks remarks_;
  UrdfElements elements_;
  UrdfRobot* robot_;
  std::map<std::string, std::size_t> numbers_;  ///< of the links
};

/// Other encodings than UTF-8 begin with a mark, or have a byte 0 in their first tag.
void require_utf8(const std::string& file, const std::string& text) {
  const bool is_utf16 = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") ||
                        (text.size() > 1 && (text[0] == '\0' || text[1] == '\0'));
  if (is_utf16) {
    throw InputError(file, 1, "text in UTF-16", "a URDF file in UTF-8");
  }
}

/// The text without declarations and a plain document type before its first tag, wherever they are there: they change
/// nothing in a file in UTF-8. All lines keep their numbers.
std::string without_declarations(std::string text) {
  const auto blank = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      text[i] = text[i] == '\n' ? '\n' : ' ';
    }
  };
  std::size_t at = text.size() - without_byte_order_mark(text).size();
  while ((at = text.find_first_not_of(" \t\r\n", at)) != std::string::npos) {
    const std::string_view rest = std::string_view(text).substr(at);
    const bool is_comment = rest.starts_with("<!--");
    const bool is_type = lower_case(rest.substr(0, 9)) == "<!doctype";
    const std::string_view mark = is_comment ? "-->" : rest.starts_with("<?") ? "?>" : ">";
    const std::size_t end = rest.find(mark);
    if (!(is_comment || is_type || rest.starts_with("<?")) || end == std::string_view::npos ||
        (is_type && rest.substr(0, end).find('[') != std::string_view::npos)) {
      break;
    }
    if (!is_comment) {
      blank(at, at + end + mark.size());
    }
    at += end + mark.size();
  }
  return text;
}

}  // namespace

UrdfRobot read_urdf(const std::filesystem::path& path, const std::string& text) {
  require_utf8(name_of(path), text);
  const XmlDocument document(path, without_declarations(text), nullptr);
  UrdfRobot robot;
  RobotReader(document, robot).run();
  return robot;
}

}  // namespace proleg::sim
