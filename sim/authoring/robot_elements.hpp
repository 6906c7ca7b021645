#pragma once

// Where the parts of a robot are in the texts of its files.

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/xml_text.hpp"

namespace proleg::sim {

/// A link. Its <Body> may be in a file of its own, which other links share.
struct LinkElements {
  std::string file;        ///< that has the <Body>
  ElementNumber body = 0;  ///< in that file
  std::string body_name;   ///< the link's name without the prefix of `place` and those around it
  /// In the robot's file what places the link and nothing else: a <KinBody> that names the other file or holds the one
  /// <Body>, or the <Body> itself. Nothing: it places other links, too.
  std::optional<ElementNumber> place;
  std::string prefix;  ///< of the elements around `place`
};

struct JointElements {
  ElementNumber joint = 0;  ///< in the robot's file
  std::string prefix;       ///< of the elements around it
};

struct RobotElements {
  std::map<std::string, LinkElements> links;    ///< by the names of the links
  std::map<std::string, JointElements> joints;  ///< by the names of the joints; those in the robot's file
};

/// Gives the text of a file of the scenario; null if there is no such file.
using TextOf = std::function<const std::string*(const std::string& name)>;

/// Follows the <KinBody>s of a robot, and the files that they name, as the scenario reader does. robot: its file. top:
/// path of the top-level file.
[[nodiscard]] RobotElements find_robot_elements(const XmlText& robot, const std::string& top, const TextOf& text_of);
/// The elements of a draft's robot, as they are after the edits of the change so far.
[[nodiscard]] RobotElements find_robot_elements(DraftChange& change, const Scenario& scenario);

}  // namespace proleg::sim
