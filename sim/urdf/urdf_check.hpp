#pragma once

// Checks the elements of a URDF file. urdfdom reads the same file without lines and reports the first error only; here
// a message has the line.

#include <map>
#include <string>
#include <vector>

#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

struct UrdfElements {
  std::vector<XmlElement> links;   ///< <link>, in the order of the file; no name twice
  std::vector<XmlElement> joints;  ///< <joint>: revolute, continuous or fixed; their parents and children are links
  std::map<std::string, double> friction;  ///< by link: the <mu1> of its <gazebo>
  std::vector<std::string> lost;           ///< what Proleg does not read, one line each
};

/// Throws InputError for a number that is none or out of range, an unknown, missing or repeated name, a kind of joint
/// that Proleg does not have, a ring, two roots, and for what xacro would replace. The document must outlive the
/// result.
[[nodiscard]] UrdfElements check_urdf(const XmlDocument& document);

}  // namespace proleg::sim
