#pragma once

// Kinds of modules that a link of a draft can become: those that Proleg knows, and those that a person makes of a mesh.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/authoring/draft.hpp"
#include "sim/authoring/own_mesh.hpp"
#include "sim/authoring/robot_kinds.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// A module for each place in a chain.
struct ModuleRole {
  std::string_view file;  ///< in the folder of the modules
  std::string_view body;  ///< name of the <Body>
  double side;            ///< in which direction of y its middle is: -1 or 1
  std::string_view comment;
};
inline constexpr ModuleRole tail_role{
    "tail.kinbody.xml", "Tail", -1.0,
    "The last link; the origin is at its joint, and the link lies towards negative y."};
inline constexpr ModuleRole segment_role{
    "segment.kinbody.xml", "Seg", 1.0,
    "A link between two joints along y; the origin is at the joint towards the tail."};
inline constexpr ModuleRole head_role{
    "head.kinbody.xml", "Head", 1.0,
    "The first link; the origin is at its joint, and the link lies towards positive y."};

struct ModuleKind {
  std::string name;
  double length = 0.0;            ///< m, between two joints
  std::vector<SourceFile> files;  ///< of all roles, and what they name; names without a folder
  /// Its files are in this folder beside the robot's file, or as many of them as the draft uses; nothing: in none.
  std::optional<std::string> folder = {};
};

[[nodiscard]] ModuleKind module_kind(const RobotKind& kind);

/// What a person says about a module of a mesh.
struct OwnModule {
  std::string name;     ///< of the kind
  MeshFit fit;          ///< the robot lies along y, its head at positive y
  double length = 0.0;  ///< m, between two joints; the middle of the mesh is between them
  double mass = 0.0;    ///< kg
};

/// A kind whose links have the shape of a mesh. Throws InputError for values out of range, the name of a kind that
/// Proleg knows, and a flat mesh.
[[nodiscard]] ModuleKind own_module_kind(const OwnMesh& mesh, const OwnModule& module);

/// The kinds of a draft that own_module_kind() has made: those whose modules its scenario names.
[[nodiscard]] std::vector<ModuleKind> own_kinds(const Scenario& scenario);

}  // namespace proleg::sim
