#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// What computes the motion (docs/physics.md).
enum class PhysicsEngine : std::uint8_t {
  ode,      ///< the Open Dynamics Engine: any robot, any environment
  reduced,  ///< chains of boxes; the same bits on every computer
  mujoco,   ///< a second opinion, if the program is built with it
};

struct PhysicsEngineName {
  PhysicsEngine engine;
  std::string_view word;   ///< in --engine and <physicsengine>
  std::string_view title;  ///< in a sentence
};

/// The names of the engines, in the order of PhysicsEngine.
inline constexpr std::array<PhysicsEngineName, 3> physics_engines{
    {{PhysicsEngine::ode, "ode", "ODE"},
     {PhysicsEngine::reduced, "reduced", "the reduced engine"},
     {PhysicsEngine::mujoco, "mujoco", "MuJoCo"}}};

[[nodiscard]] constexpr std::string_view name_of(PhysicsEngine engine) {
  return physics_engines.at(static_cast<std::size_t>(engine)).word;
}
[[nodiscard]] constexpr std::string_view title_of(PhysicsEngine engine) {
  return physics_engines.at(static_cast<std::size_t>(engine)).title;
}

[[nodiscard]] constexpr std::optional<PhysicsEngine> engine_named(std::string_view word) {
  for (const PhysicsEngineName& name : physics_engines) {
    if (name.word == word) {
      return name.engine;
    }
  }
  return std::nullopt;
}

/// "'ode', 'reduced' or 'mujoco'"
[[nodiscard]] inline std::string engine_words() {
  std::string text;
  for (std::size_t i = 0; i < physics_engines.size(); ++i) {
    text += (i == 0                           ? "'"
             : i + 1 < physics_engines.size() ? ", '"
                                              : " or '") +
            std::string(physics_engines[i].word) + "'";
  }
  return text;
}

/// An object in the world that does not move: the floor, a wall, a step.
struct StaticObject {
  std::string name;
  Pose pose;  ///< in the world
  std::vector<Geometry> geometries;
  std::vector<Look> looks;  ///< shown beside the geometries
  std::string file = {};    ///< where its <Body> is; empty: in no file
  int line = 0;
};

/// An object in the world that moves when something pushes it: a ball, a box. Its geometries are convex.
struct MovingObject {
  std::string name;
  Pose pose;  ///< of its frame in the world, at the start
  MassProperties mass;
  std::vector<Geometry> geometries;
  std::vector<Look> looks;  ///< shown beside the geometries
  std::string file = {};    ///< where its <Body> is; empty: in no file
  int line = 0;
};

/// A scale on the ground, for the eye only: segments of equal length whose colours alternate.
struct Ruler {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< m, in the world
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< not at `from`
  double division = 1.0;                           ///< m, length of a segment; the last one may be shorter
  double width = 0.1;                              ///< m
};

/// The world a robot crawls in.
struct EnvironmentModel {
  PhysicsEngine engine = PhysicsEngine::ode;
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2
  bool self_collision = false;               ///< whether links that are not neighbours collide
  /// Coulomb coefficient between two geometries of which neither has one.
  double unspecified_friction = default_friction;
  std::vector<StaticObject> objects;
  std::vector<MovingObject> moving_objects;
  std::vector<Ruler> rulers;
  Pose robot_pose;  ///< where the robot starts
};

}  // namespace proleg::sim
