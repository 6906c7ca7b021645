#pragma once

// The chain of a robot in the text of its file, for changes that add, remove or exchange links.

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/robot_elements.hpp"

namespace proleg::sim {

/// Links and joints in the order in which a person counts them: from the tail. Joint i joins the links i and i + 1.
struct ChainText {
  struct Link {
    std::string name;
    LinkElements elements;
    ElementNumber place = 0;
  };
  struct Joint {
    std::string name;
    ElementNumber element = 0;
    std::size_t file_index = 0;      ///< position among the joints of the file
    bool is_framed_by_rear = false;  ///< its anchor is in the frame of the link towards the tail
  };
  std::vector<Link> links;
  std::vector<Joint> joints;
};

/// The chain of a scenario. Throws InputError with the reason if the file has a form whose links cannot be added,
/// removed or exchanged: links that are not beside each other, joints in other files, prefixes around them.
[[nodiscard]] ChainText read_chain_text(const Scenario& scenario, const XmlText& robot, const TextOf& text_of);
/// The same after the edits of a change so far; scenario: of this state.
[[nodiscard]] ChainText read_chain_text(DraftChange& change, const Scenario& scenario);

/// How far the chain in front of a link between two joints moves if a copy of the link comes in; in the robot's frame,
/// m. link: from the tail.
[[nodiscard]] Eigen::Vector3d length_of_link(const Scenario& scenario, std::size_t link);

/// Moves the links in front of link `behind` by a vector in the robot's frame, in m.
void shift_links_in_front(DraftChange& change, const Scenario& scenario, const ChainText& chain, std::size_t behind,
                          const Eigen::Vector3d& shift);

/// The vector in the frame around an element, such as the <KinBody> of a chain, that has these coordinates in the
/// robot's frame.
[[nodiscard]] Eigen::Vector3d in_frame_around(const XmlText& robot, ElementNumber element,
                                              const Eigen::Vector3d& vector);

/// The patch that gives a link another name, by the `prefix` of its <KinBody> or the name of its <Body>. place: of the
/// link, or of a copy of it. Throws InputError for a name that does not end with that of a <Body> in a file of its own.
[[nodiscard]] TextPatch link_name_patch(const XmlText& robot, ElementNumber place, const LinkElements& link,
                                        const std::string& name);

using NewNames = std::map<std::string, std::string>;  ///< by the old ones

/// Exchanges names of links, all at once, where the robot's file names them: in joints, <adjacent> and sensors.
void replace_link_names(DraftChange& change, const std::string& file, const NewNames& names);
/// The same in one element and those in it.
void replace_link_names(DraftChange& change, const std::string& file, ElementNumber element, const NewNames& names);

/// Names that count: "J12" is {"J", "", false} with the number 12.
struct CountedNames {
  std::string before;
  std::string behind;
  bool from_the_end = false;  ///< the last name has the number 1

  /// The name at a position in a list of `count`.
  [[nodiscard]] std::string at(std::size_t position, std::size_t count) const;
};
/// How the names of a list count: from 1, without a gap, in one direction or the other. Nothing: they do not.
[[nodiscard]] std::optional<CountedNames> counted_names(const std::vector<std::string>& names);

}  // namespace proleg::sim
