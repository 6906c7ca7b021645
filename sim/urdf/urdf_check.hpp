#pragma once

// The elements of a URDF file: links and joints that form a tree, and what belongs to them elsewhere in the file.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/scenario/xml_document.hpp"
#include "sim/urdf/urdf_values.hpp"

namespace proleg::sim {

struct UrdfElements {
  std::vector<XmlElement> links;   ///< <link>, in the order of the file; no name twice
  std::vector<XmlElement> joints;  ///< <joint>: revolute, continuous or fixed; their parents and children are links
  std::map<std::string, double> friction;            ///< by link: the <mu1> of its <gazebo>
  std::map<std::string, Eigen::Vector3d> materials;  ///< red, green, blue by name: 0 to 1
  bool has_collision = false;                        ///< without one in the whole file the <visual>s touch
};

/// Throws InputError for an unknown, missing or repeated name, a kind of joint that Proleg does not have, a ring, two
/// roots, and for what xacro would replace. The document must outlive the result.
[[nodiscard]] UrdfElements check_urdf(const XmlDocument& document, UrdfRemarks& remarks);

/// The colour of a <material> that has one: red, green, blue from 0 to 1. Another one is lost.
[[nodiscard]] std::optional<Eigen::Vector3d> urdf_colour(const XmlElement& material, UrdfRemarks& remarks);

}  // namespace proleg::sim
