#pragma once

// Kinematic bodies: the OpenRAVE tag <KinBody> with bodies, joints and further KinBodies, in this file or another.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/robot/robot_model.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// A place in the input.
struct Origin {
  std::string file;
  int line = 0;
};

struct BodyEntry {
  Origin origin;
  Link link;              ///< without mass if it is fixed
  bool is_fixed = false;  ///< type="static": only in environments
};

struct JointEntry {
  Origin origin;
  Joint joint;  ///< anchor and axis in the robot's frame, as the file gives them
  /// Names of bodies. The angle is the rotation of the second relative to the first about the axis.
  std::array<std::string, 2> bodies;
  AngleLimits kernel_limits;
  bool is_in_frame_of_body = false;  ///< <offsetfrom> names one of the two bodies
};

/// Two bodies that must not touch each other.
struct AdjacentBodies {
  Origin origin;
  std::array<std::string, 2> bodies;
};

/// The contents of a file, in its order.
struct KinBodyContents {
  std::vector<BodyEntry> bodies;
  std::vector<JointEntry> joints;
  std::vector<AdjacentBodies> adjacent;
};

enum class KinBodyUse : std::uint8_t {
  robot,        ///< named dynamic bodies with mass, and joints
  environment,  ///< bodies that are static or move, no joints
};

/// Reads a <KinBody>, or a <Robot>, which may hold the same. extra_tags: tags that the caller reads itself.
///
/// Nested KinBodies have their pose (read_pose) in the frame of the outer one. A `prefix`
/// precedes the names of all bodies and joints inside; the names of bodies in a joint get the prefixes of that joint.
/// <offsetfrom> names the body in whose frame the anchor and axis of a joint, or the pose of a body, are given; without
/// it the frame is that of the KinBody. A <Mass type="mimicgeom"> with a <density> in a KinBody counts for its bodies
/// that have no <Mass>. The result has poses, anchors and axes in the outermost frame.
[[nodiscard]] KinBodyContents read_kinbody(const XmlElement& element, KinBodyUse use, SourceSet& sources,
                                           std::vector<std::string>& remarks,
                                           std::span<const std::string_view> extra_tags = {});

}  // namespace proleg::sim
