#pragma once

// The text of the objects that the library has.

#include <map>
#include <string>

#include <Eigen/Core>

#include "sim/authoring/world.hpp"

namespace proleg::sim {

/// A <KinBody> of a library item, for XmlText::add_behind(). values: of all its parameters. position: m, of the middle
/// of its front edge, or of its middle, on the ground; it is turned about the vertical there.
[[nodiscard]] std::string item_text(LibraryItem item, const std::map<std::string, double>& values,
                                    const std::string& name, const Eigen::Vector3d& position, double turn_degrees);

}  // namespace proleg::sim
