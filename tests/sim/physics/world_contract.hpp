#pragma once

// What every physics engine must do. The cases are in world_contract_test.cpp, which the test program of each engine
// compiles, and in tests/sim/mesh/objects_contract_test.cpp; the file of the engine's own tests says for which engines
// they run, and how exact these are. The oracles are the mechanics of rigid bodies.

#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "sim/ode/ode_world.hpp"
#include "tests/sim/physics/small_world.hpp"

namespace proleg::sim {

/// An engine, and by how much its worlds may differ from what mechanics says.
struct Engine {
  std::string name;
  std::unique_ptr<World> (*make)(const RobotModel& robot, const EnvironmentModel& environment);
  bool is_planar = false;             ///< its robots move in a vertical plane and have joints about horizontal axes
  std::size_t contacts_of_a_box = 4;  ///< number of contact points of a box that lies on the ground
  double position = 1e-9;             ///< m: poses of links after they were set
  double rotation = 1e-7;             ///< rad: poses of links after they were set
  double weight = 1e-3;               ///< share of the weight: contact forces at rest
  double rest = 1e-3;                 ///< m/s, and ten times that in rad/s: how fast a robot at rest may seem to be
  double sliding = 1e-3;              ///< share of the gravity: acceleration of a link that slides
  double step_force = 1e-3;           ///< share: normal force of a link that slides, in each step
  double joint = 1e-3;                ///< rad: angle of a joint that its motor turns
  double stop = 1e-3;                 ///< rad: angle of a joint that is driven against its stop
  double torque = 1e-3;               ///< Nm: torque of a motor that holds a link
};

inline void PrintTo(const Engine& engine, std::ostream* stream) { *stream << engine.name; }

/// The name of an engine as the suffix of its cases.
inline std::string engine_name(const testing::TestParamInfo<Engine>& info) { return info.param.name; }

inline std::unique_ptr<World> ode_world(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_ode_world(robot, environment, step_s, Stepper::direct);
}

inline EnvironmentModel weightless() {
  EnvironmentModel environment;
  environment.gravity.setZero();
  return environment;
}

inline Eigen::Quaterniond turn(double rad, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(rad, axis.normalized()));
}

inline void expect_near(const Pose& pose, const Pose& expected, double position, double rotation,
                        const std::string& name) {
  EXPECT_LT((pose.position - expected.position).norm(), position) << name;
  EXPECT_LT(pose.orientation.angularDistance(expected.orientation), rotation) << name;
}

/// A step of a run that bends, slips and touches.
inline void wriggle(World& world, std::size_t joints, int step) {
  for (std::size_t joint = 0; joint < joints; ++joint) {
    world.set_joint_speed(joint, 3.0 * std::sin(0.01 * step + static_cast<double>(joint)));
  }
  world.step();
}

/// Bends all joints to an angle, as a servo does, and holds them there.
inline void bend(World& world, std::size_t joints, double angle, double seconds) {
  for (long i = 0; i < std::lround(seconds / step_s); ++i) {
    for (std::size_t joint = 0; joint < joints; ++joint) {
      world.set_joint_speed(joint, 5.0 * (angle - world.joint_angle(joint)));
    }
    world.step();
  }
}

class EngineTest : public testing::TestWithParam<Engine> {
 protected:
  [[nodiscard]] static std::unique_ptr<World> make(const RobotModel& robot, const EnvironmentModel& environment) {
    return GetParam().make(robot, environment);
  }
};

/// Of every engine.
class WorldContract : public EngineTest {};
/// Of engines whose links may have each form of Shape that is no mesh.
class RoundShapes : public EngineTest {};
/// Of engines in which links that are not neighbours push each other away.
class SelfCollision : public EngineTest {};
/// Of engines whose environment may have objects of each size at each place.
class SeveralObjects : public EngineTest {};
/// Of engines whose links may be convex meshes.
class ConvexMeshes : public EngineTest {};
/// Of engines whose ground may be a height field.
class HeightFields : public EngineTest {};
/// Of engines with objects that move.
class MovingObjects : public EngineTest {};
/// Of engines in which two boxes touch each other only where both are.
class TouchingBoxes : public EngineTest {};
/// The friction of a flat plate on the ground, which a horizontal load pulls towards a heading.
class PulledPlate : public testing::TestWithParam<std::tuple<Engine, double>> {};

/// Headings, in degrees, for PulledPlate.
inline const auto headings = testing::Values(0.0, 10.0, 17.0, 30.0, 45.0, 67.5, 90.0, 115.0, 135.0, 200.0);

inline std::string engine_and_heading(const testing::TestParamInfo<std::tuple<Engine, double>>& info) {
  return std::get<0>(info.param).name + std::to_string(info.index);
}

}  // namespace proleg::sim
