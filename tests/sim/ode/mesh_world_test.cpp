// Triangle meshes, height fields and objects that move, against mechanics.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "sim/mesh/convex_hull.hpp"
#include "sim/mesh/height_mesh.hpp"
#include "sim/ode/contacts.hpp"
#include "sim/ode/ode_world.hpp"
#include "tests/sim/mesh/mesh_shapes.hpp"
#include "tests/sim/physics/small_world.hpp"

namespace proleg::sim {
namespace {

Geometry surface(TriangleMesh mesh, double friction) {
  Geometry geometry;
  geometry.shape = Shape::surface;
  geometry.mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
  geometry.friction = friction;
  return geometry;
}

Geometry height_field(const HeightField& field, double friction) {
  Geometry geometry = surface(surface_of(field), friction);
  geometry.shape = Shape::height_field;
  geometry.heights = std::make_shared<const HeightField>(field);
  return geometry;
}

EnvironmentModel world_of(Geometry ground, double start_height) {
  EnvironmentModel environment;
  StaticObject object;
  object.name = "ground";
  object.geometries.push_back(std::move(ground));
  environment.objects.push_back(object);
  environment.robot_pose.position.z() = start_height;
  return environment;
}

/// A robot of one link: a convex mesh with the mass of its box.
RobotModel hull_robot(const TriangleMesh& mesh, const Eigen::Vector3d& half_sides) {
  RobotModel robot;
  robot.links.push_back(box_link(0.0, half_sides, 0.1));
  Geometry& geometry = robot.links[0].geometries[0];
  geometry.shape = Shape::hull;
  geometry.mesh = std::make_shared<const TriangleMesh>(convex_hull(mesh).mesh);
  return robot;
}

MovingObject box_object(const Eigen::Vector3d& position, const Eigen::Vector3d& half_sides, double mass,
                        double friction) {
  const Link link = box_link(0.0, half_sides, mass);
  MovingObject object{"box", {}, link.mass, link.geometries, {}};
  object.pose.position = position;
  object.geometries[0].friction = friction;
  return object;
}

std::unique_ptr<World> make(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_ode_world(robot, environment, step_s, Stepper::direct);
}

std::vector<Pose> objects_of(const World& world, std::size_t count) {
  std::vector<Pose> poses(count);
  world.read_objects(poses);
  return poses;
}

/// Gravity as on a slope along a direction in the plane of the ground.
Eigen::Vector3d tilted(double slope, double heading) {
  return gravity *
         Eigen::Vector3d(std::sin(slope) * std::cos(heading), std::sin(slope) * std::sin(heading), -std::cos(slope));
}

class MeshSlope : public testing::TestWithParam<double> {};

TEST_P(MeshSlope, ABoxStaysBelowTheAngleOfFrictionAndSlidesAbove) {
  constexpr double mu = 0.5;
  for (const double slope : {0.9 * std::atan(mu), 1.3 * std::atan(mu)}) {
    EnvironmentModel environment = world_of(surface(sheet(60, 0.05), mu), 0.02);
    environment.gravity = tilted(slope, GetParam());
    const std::unique_ptr<World> world = make(chain(1), environment);
    constexpr double seconds = 0.6;
    run(*world, seconds);
    const double expected = std::max(0.0, gravity * (std::sin(slope) - mu * std::cos(slope))) * seconds * seconds / 2.0;
    const Eigen::Vector3d way = world->center_of_mass() - Eigen::Vector3d(0, 0, 0.02);
    EXPECT_NEAR(way.head<2>().norm(), expected, 0.004 + 0.02 * expected) << "slope " << slope;
    EXPECT_NEAR(way.z(), 0.0, 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Headings, MeshSlope, testing::Values(0.0, 0.4, 0.785, 1.3));

TEST(MeshWorld, AConvexMeshRestsAndSlidesAsTheBoxThatItIs) {
  constexpr double mu = 0.5;
  const Eigen::Vector3d half(0.02, 0.04, 0.02);
  for (const bool on_mesh : {false, true}) {
    EnvironmentModel environment = on_mesh ? world_of(surface(sheet(60, 0.05), mu), 0.02) : flat_ground(mu, 0.02);
    environment.gravity = tilted(1.3 * std::atan(mu), 0.0);
    const std::unique_ptr<World> box = make(chain(1), environment);
    const std::unique_ptr<World> hull = make(hull_robot(box_mesh(half), half), environment);
    run(*box, 0.5);
    run(*hull, 0.5);
    EXPECT_NEAR(hull->center_of_mass().x(), box->center_of_mass().x(), 0.02 * box->center_of_mass().x());
    EXPECT_NEAR(hull->center_of_mass().z(), 0.02, 1e-4);
    EXPECT_GT(box->center_of_mass().x(), 0.05);
  }
}

TEST(MeshWorld, ABoxAndASphereRestOnAHeightFieldAtItsHeight) {
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

TEST(MeshWorld, ASphereOnASlopeOfAHeightFieldRollsAsASphereDoes) {
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

TEST(MeshWorld, ALinkOnAMeshPressesItsSensorsAndBearsItsWeight) {
  const std::unique_ptr<World> world = make(chain(2), world_of(surface(sheet(10, 0.1), 0.5), 0.02));
  run(*world, 0.5);
  EXPECT_EQ(world->link_contacts(0), 3U);
  EXPECT_EQ(world->link_contacts(1), 3U);
  EXPECT_NEAR(world->contact_force(0) + world->contact_force(1), 0.2 * gravity, 0.02);
  EXPECT_NEAR(*world->lowest_ground(), 0.0, 1e-12);
}

TEST(MovingObjects, RestOnTheGroundWithTheRobotAndStartWhereTheModelPutsThem) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.moving_objects.push_back(box_object({0.5, 0.2, 0.05}, {0.05, 0.05, 0.05}, 0.3, 0.5));
  environment.moving_objects[0].mass.center = {0.0, 0.0, -0.01};
  const std::unique_ptr<World> world = make(chain(2), environment);
  EXPECT_LT((objects_of(*world, 1)[0].position - Eigen::Vector3d(0.5, 0.2, 0.05)).norm(), 1e-12);
  run(*world, 1.0);
  EXPECT_LT((objects_of(*world, 1)[0].position - Eigen::Vector3d(0.5, 0.2, 0.05)).norm(), 1e-3);
  EXPECT_TRUE(world->is_slower_than(1e-4, 1e-3));
}

TEST(MovingObjects, AFallingOneIsNotAtRest) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.moving_objects.push_back(box_object({0.5, 0.2, 0.5}, {0.05, 0.05, 0.05}, 0.3, 0.5));
  const std::unique_ptr<World> world = make(chain(1), environment);
  run(*world, 0.2);
  EXPECT_FALSE(world->is_slower_than(1e-4, 1e-3));
  EXPECT_NEAR(objects_of(*world, 1)[0].position.z(), 0.5 - gravity * 0.2 * 0.2 / 2, 1e-3);
}

TEST(MovingObjects, ALinkThatFallsOnOneRestsOnItAndWeighsOnIt) {
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

TEST(MovingObjects, APushedPairHasTheMomentumThatGravityGaveIt) {
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

TEST(MovingObjects, OnesThatTouchEachOtherStack) {
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.moving_objects.push_back(box_object({0.5, 0, 0.05}, {0.05, 0.05, 0.05}, 0.3, 0.5));
  environment.moving_objects.push_back(box_object({0.5, 0, 0.13}, {0.03, 0.03, 0.03}, 0.1, 0.5));
  const std::unique_ptr<World> world = make(chain(1), environment);
  run(*world, 1.0);
  EXPECT_NEAR(objects_of(*world, 2)[1].position.z(), 0.13, 1e-3);
}

TEST(MovingObjects, AWorldWithThemRepeatsToTheLastBit) {
  EnvironmentModel environment = world_of(surface(sheet(30, 0.05), 0.5), 0.05);
  environment.moving_objects.push_back(box_object({0.03, 0.1, 0.1}, {0.03, 0.03, 0.03}, 0.1, 0.5));
  const RobotModel robot = chain(3);
  const auto run_once = [&] {
    const std::unique_ptr<World> world = make(robot, environment);
    world->set_joint_speed(0, 1.0);
    run(*world, 1.0);
    return std::make_pair(world->center_of_mass(), objects_of(*world, 1)[0].position);
  };
  EXPECT_EQ(run_once(), run_once());
}

TEST(ContactChoice, KeepsTheDeepestAndTheCornersOfAFlatSide) {
  std::array<dContactGeom, max_mesh_points> points{};
  std::size_t count = 0;
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) {
      points[count].pos[0] = x;
      points[count].pos[1] = y;
      points[count].depth = x == 4 && y == 5 ? 2.0 : 1.0;
      ++count;
    }
  }
  const std::size_t kept = choose_contacts(std::span(points).first(count), 8);
  ASSERT_EQ(kept, 8U);
  EXPECT_EQ(points[0].depth, 2.0);
  int corners = 0;
  for (std::size_t i = 0; i < kept; ++i) {
    const bool is_corner =
        (points[i].pos[0] == 0 || points[i].pos[0] == 9) && (points[i].pos[1] == 0 || points[i].pos[1] == 9);
    corners += is_corner ? 1 : 0;
  }
  EXPECT_EQ(corners, 4);
}

TEST(ContactChoice, OfPointsAtOnePlaceTheDeepestRemains) {
  std::array<dContactGeom, 4> points{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].depth = static_cast<double>(i);
  }
  points[3].pos[0] = 1.0;
  ASSERT_EQ(choose_contacts(points, 8), 2U);
  EXPECT_EQ(points[0].depth, 2.0);
  EXPECT_EQ(points[1].depth, 3.0);
}

}  // namespace
}  // namespace proleg::sim
