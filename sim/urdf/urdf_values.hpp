#pragma once

// Reads values of a URDF file, and collects what an import says about them.

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/pose.hpp"
#include "sim/scenario/values.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Kinds of remarks, each with the lines of the file where it holds: a file with fifty <transmission> gives one line.
class RemarksByKind {
 public:
  void add(const std::string& what, int line) { add(what, what, line); }
  /// Of remarks of one kind the first text counts.
  void add(const std::string& kind, const std::string& what, int line);

  /// "what (line 3)", "what (lines 3, 4)".
  [[nodiscard]] std::vector<std::string> with_lines() const;
  /// "FILE:3: what", "FILE:3: what (also in line 4)".
  [[nodiscard]] std::vector<std::string> as_warnings(const std::string& file) const;

 private:
  struct Remark {
    std::string kind;
    std::string what;
    std::vector<int> lines;
  };
  std::vector<Remark> remarks_;
};

struct UrdfRemarks {
  RemarksByKind lost;
  RemarksByKind notes;
  RemarksByKind warnings;
};

inline constexpr Range urdf_sizes{0.0, 1e4, "m"};
inline constexpr Range any_number{-1e12, 1e12, ""};

/// A value in which, as in all XML, tabs and line ends are blanks; without blanks at its ends.
[[nodiscard]] std::string urdf_value(const XmlElement& element, std::string_view attribute);
[[nodiscard]] std::string urdf_name(const XmlElement& element, std::string_view attribute);

/// `count` numbers of an attribute that the element must have. Throws InputError for words that are no numbers, too
/// many, too few, or out of range.
[[nodiscard]] std::vector<double> urdf_numbers(const XmlElement& element, std::string_view attribute, std::size_t count,
                                               const Range& range);
[[nodiscard]] double urdf_number(const XmlElement& element, std::string_view attribute, const Range& range);

/// The <origin> of an element: xyz with rpy, or with the quat_xyzw of URDF 1.1. Without it, no change of the frame.
/// Throws InputError for both rotations, and for a quaternion without a direction. Warns of angles that look as if they
/// were degrees.
[[nodiscard]] Pose urdf_origin(const XmlElement& parent, UrdfRemarks& remarks);

/// Adds all attributes and tags of an element that are not among these to what is lost. Namespaces have no effect.
void lose_others(const XmlElement& element, std::initializer_list<std::string_view> attributes,
                 std::initializer_list<std::string_view> tags, UrdfRemarks& remarks);

/// Throws InputError for what xacro would replace, in the element and in all that is in it.
void refuse_xacro(const XmlElement& element);

}  // namespace proleg::sim
