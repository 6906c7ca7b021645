// What an engine must do that has meshes, height fields and objects that move (world_contract.hpp).

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/sim/mesh/mesh_worlds.hpp"
#include "tests/sim/physics/world_contract.hpp"

namespace proleg::sim {
namespace {

TEST_P(ConvexMeshes, RestAndSlideAsTheBoxThatTheyAre) { expect_to_slide_as_a_box(make, flat_ground(0.5, 0.02)); }

TEST_P(HeightFields, ABoxAndASphereRestOnOneAtItsHeight) {
  // Level at 0.25 m, except a hill far away.
  HeightField field{.columns = 21, .rows = 31, .half_x = 0.5, .half_y = 0.75, .heights = {}};
  field.heights.assign(field.columns * field.rows, 0.25);
  field.heights.back() = 0.5;
  for (const Shape shape : {Shape::box, Shape::sphere}) {
    RobotModel robot = chain(1);
    robot.links[0].geometries[0].shape = shape;
    robot.links[0].geometries[0].extents = {0.02, 0.04, 0.02};
    const std::unique_ptr<World> world = make(robot, world_of(height_field(field, 0.5), 0.28));
    run(*world, 1.0);
    EXPECT_NEAR(world->center_of_mass().z(), 0.27, 1e-4);
    EXPECT_NEAR(world->center_of_mass().head<2>().norm(), 0.0, 1e-3);
  }
}

TEST_P(HeightFields, ASphereOnTheSlopeOfOneRollsAsASphereDoes) {
  // Height rises by 0.2 per metre of x. A sphere that rolls accelerates with 5/7 of g sin(slope).
  constexpr double rise = 0.2;
  HeightField field{.columns = 41, .rows = 5, .half_x = 4.0, .half_y = 0.4, .heights = {}};
  for (std::size_t row = 0; row < field.rows; ++row) {
    for (std::size_t column = 0; column < field.columns; ++column) {
      field.heights.push_back(rise * (-4.0 + 0.2 * static_cast<double>(column)));
    }
  }
  RobotModel robot = chain(1);
  constexpr double radius = 0.05;
  robot.links[0].geometries[0].shape = Shape::sphere;
  robot.links[0].geometries[0].extents.x() = radius;
  robot.links[0].mass.inertia = 0.4 * 0.1 * radius * radius * Eigen::Matrix3d::Identity();
  const double slope = std::atan(rise);
  const std::unique_ptr<World> world = make(robot, world_of(height_field(field, 1.0), radius / std::cos(slope)));
  run(*world, 1.0);
  const double way = (world->center_of_mass() - Eigen::Vector3d(0, 0, radius / std::cos(slope))).norm();
  EXPECT_NEAR(way, 5.0 / 7.0 * gravity * std::sin(slope) / 2.0, 0.01);
  EXPECT_LT(world->center_of_mass().x(), 0.0) << "downhill";
}

TEST_P(MovingObjects, RestOnTheGroundWithTheRobotAndStartWhereTheModelPutsThem) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.moving_objects.push_back(box_object({0.5, 0.2, 0.05}, {0.05, 0.05, 0.05}, 0.3, 0.5));
  environment.moving_objects[0].mass.center = {0.0, 0.0, -0.01};
  const std::unique_ptr<World> world = make(chain(2), environment);
  EXPECT_LT((objects_of(*world, 1)[0].position - Eigen::Vector3d(0.5, 0.2, 0.05)).norm(), GetParam().position);
  run(*world, 1.0);
  EXPECT_LT((objects_of(*world, 1)[0].position - Eigen::Vector3d(0.5, 0.2, 0.05)).norm(), 1e-3);
  EXPECT_TRUE(world->is_slower_than(1e-4, 1e-3));
}

TEST_P(MovingObjects, AFallingOneIsNotAtRestAndAMoveOfTheRobotLeavesItAlone) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.moving_objects.push_back(box_object({1, 0.2, 1.0}, {0.05, 0.05, 0.05}, 0.3, 0.5));
  const std::unique_ptr<World> world = make(chain(2), environment);
  run(*world, 0.2);
  EXPECT_FALSE(world->is_slower_than(1e-3, 1e-2));
  world->move_robot({{0, 0.1, 0}, Eigen::Quaterniond::Identity()});
  constexpr double seconds = 0.3;
  run(*world, seconds - 0.2);
  EXPECT_NEAR(objects_of(*world, 1)[0].position.z(), 1.0 - gravity * seconds * (seconds + step_s) / 2, 1e-6);
}

TEST_P(MovingObjects, BearTheLinkThatLiesOnOneAndPressItsSensors) {
  EnvironmentModel environment = flat_ground(0.5, 0.12);
  environment.moving_objects.push_back(box_object({0, 0, 0.05}, {0.05, 0.05, 0.05}, 0.3, 0.5));
  const std::unique_ptr<World> world = make(chain(1), environment);
  run(*world, 1.0);
  EXPECT_NEAR(world->center_of_mass().z(), 0.12, 1e-3);
  EXPECT_NEAR(world->contact_force(0), 0.1 * gravity, 0.01);
  EXPECT_NE(world->link_contacts(0), 0U);
  EXPECT_TRUE(world->is_slower_than(1e-3, 1e-2));
}

TEST_P(MovingObjects, ALinkThatFallsOnOneRestsOnItAndWeighsOnIt) {
  // Gravity along -y: the box lies on a wall, and the link falls on the box.
  EnvironmentModel environment;
  environment.gravity = {0, -2.0, 0};
  environment.moving_objects.push_back(box_object({0, -0.3, 0}, {0.05, 0.05, 0.05}, 0.3, 0.0));
  environment.moving_objects[0].geometries[0].friction = 0.0;
  StaticObject wall;
  wall.pose.position = {0, -1.35, 0};
  Geometry geometry;
  geometry.extents = {1, 1, 1};
  geometry.friction = 0.0;
  wall.geometries.push_back(geometry);
  environment.objects.push_back(wall);
  const std::unique_ptr<World> world = make(chain(1), environment);
  constexpr double fall = 0.21;  // m, from the link to the box
  run(*world, std::sqrt(2.0 * fall / 2.0) + 1.0);
  // At rest on the box, which is at rest on the wall.
  EXPECT_NEAR(world->center_of_mass().y(), -0.3 + 0.05 + 0.04, 2e-3);
  EXPECT_NEAR(objects_of(*world, 1)[0].position.y(), -0.3, 2e-3);
  EXPECT_NEAR(world->contact_force(0), 0.1 * 2.0, 0.01) << "the link weighs on the box";
}

TEST_P(MovingObjects, APushedPairHasTheMomentumThatGravityGaveIt) {
  // A link slides without friction down a slope into a box that friction holds, and pushes it on. Their momentum along
  // the slope is what gravity gave less what the friction of the box took.
  constexpr double slope = 0.3;
  constexpr double mu = 0.2;
  constexpr double box_mass = 0.2;
  EnvironmentModel environment = flat_ground(1.0, 0.02);
  environment.objects[0].geometries[0].friction = 1.0;
  environment.gravity = gravity * Eigen::Vector3d(0, std::sin(slope), -std::cos(slope));
  environment.moving_objects.push_back(box_object({0, 0.0901, 0.05}, {0.05, 0.05, 0.05}, box_mass, mu * mu));
  RobotModel robot = chain(1);
  robot.links[0].geometries[0].friction = 0.0;  // the mean with any other is 0
  const std::unique_ptr<World> world = make(robot, environment);
  constexpr double seconds = 0.5;
  run(*world, seconds);
  const double link_mass = robot.links[0].mass.mass;
  const double acceleration = gravity * (std::sin(slope) - mu * std::cos(slope) * box_mass / (link_mass + box_mass));
  EXPECT_NEAR(objects_of(*world, 1)[0].position.y() - 0.0901, acceleration * seconds * seconds / 2.0, 0.01);
  EXPECT_NEAR(world->center_of_mass().y(), acceleration * seconds * seconds / 2.0, 0.01);
}

TEST_P(MovingObjects, OnesThatTouchEachOtherStack) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.moving_objects.push_back(box_object({0.5, 0, 0.05}, {0.05, 0.05, 0.05}, 0.3, 0.5));
  environment.moving_objects.push_back(box_object({0.5, 0, 0.13}, {0.03, 0.03, 0.03}, 0.1, 0.5));
  const std::unique_ptr<World> world = make(chain(1), environment);
  run(*world, 1.0);
  EXPECT_NEAR(objects_of(*world, 2)[1].position.z(), 0.13, 1e-3);
}

}  // namespace
}  // namespace proleg::sim
