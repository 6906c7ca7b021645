#pragma once

// The environment of a draft as a person edits it: a list of objects, rulers, the start of the robot.

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sim/authoring/draft.hpp"
#include "sim/robot/pose.hpp"

namespace proleg::sim {

/// A shape of an object: a <Geom>.
struct WorldShape {
  ElementNumber element = 0;
  std::string type;  ///< "box", "sphere", "cylinder", "trimesh" or "heightfield"
  /// m; box: sides x, y, z; sphere: radius; cylinder: radius, height; height field: sides x, y; mesh of a file: sides
  /// x, y, z of the box around it; other mesh: nothing
  std::vector<double> size;
  std::optional<double> friction;
  std::optional<Eigen::Vector3d> colour;  ///< red, green, blue, 0 to 1
  Pose pose;                              ///< in the object
  /// The lowest and the highest corner of the box around a mesh of a file, in the frame of the mesh.
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> mesh_box = {};
};

/// An object: a <Body>.
struct WorldObject {
  std::string name;
  std::string file;  ///< where its <Body> is
  int line = 0;
  /// In the environment file; nothing: the object is in a file of its own, which other robots may share, and cannot be
  /// edited here.
  std::optional<ElementNumber> body;
  /// The <KinBody> directly in the environment that has the body.
  std::optional<ElementNumber> group;
  std::size_t group_size = 1;  ///< bodies of the group
  bool moves = false;
  std::size_t index = 0;  ///< in EnvironmentModel::objects, or in moving_objects if it moves
  double mass = 0.0;      ///< kg, of one that moves
  Pose pose;              ///< in the world
  std::vector<WorldShape> shapes;
};

struct WorldRuler {
  ElementNumber element = 0;
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
};

struct WorldContents {
  std::string file;                  ///< the environment file of the draft
  std::vector<WorldObject> objects;  ///< in the order of the file; then those of other files
  std::vector<WorldRuler> rulers;
  /// The start of the robot as the file gives it; the robot may be lifted from there onto the ground.
  Eigen::Vector3d start = Eigen::Vector3d::Zero();          ///< m
  Eigen::Vector3d start_degrees = Eigen::Vector3d::Zero();  ///< about x, then y, then z
};

[[nodiscard]] WorldContents read_world_contents(const Draft& draft);

}  // namespace proleg::sim
