#pragma once

// The library of objects for worlds: what there is, and the text of each.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace proleg::sim {

/// An item of the library of objects.
enum class LibraryItem : std::uint8_t {
  box,
  ramp,
  stairs,
  cylinder,  ///< lies across the way: a log
  sphere,
  hills,  ///< waves of a cosine across the way, as the obstacle of the thesis
  rough,  ///< a height field of random heights
};

/// A number of a library item that a person may set before it is added.
struct LibraryParameter {
  std::string_view name;
  std::string_view help;
  std::string_view unit;
  double lowest;
  double highest;
  double usual;
  bool is_whole = false;
};

struct LibraryDeclaration {
  LibraryItem item;
  std::string_view name;  ///< also the name of a new object
  std::string_view help;  ///< a plain sentence
  std::vector<LibraryParameter> parameters;
};

/// All items, in the order of LibraryItem.
[[nodiscard]] const std::vector<LibraryDeclaration>& library();

/// The item with this name; null if there is none.
[[nodiscard]] const LibraryDeclaration* find_library_item(std::string_view name);

/// A <KinBody> of a library item, for XmlText::add_behind(). values: of all its parameters. position: m, of the middle
/// of its front edge, or of its middle, on the ground; it is turned about the vertical there.
[[nodiscard]] std::string item_text(LibraryItem item, const std::map<std::string, double>& values,
                                    const std::string& name, const Eigen::Vector3d& position, double turn_degrees);

}  // namespace proleg::sim
