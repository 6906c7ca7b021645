// Triangle meshes, against mechanics.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "sim/ode/contacts.hpp"
#include "tests/sim/mesh/mesh_shapes.hpp"
#include "tests/sim/mesh/mesh_worlds.hpp"
#include "tests/sim/physics/world_contract.hpp"

namespace proleg::sim {
namespace {

class MeshSlope : public testing::TestWithParam<double> {};

TEST_P(MeshSlope, ABoxStaysBelowTheAngleOfFrictionAndSlidesAbove) {
  constexpr double mu = 0.5;
  for (const double slope : {0.9 * std::atan(mu), 1.3 * std::atan(mu)}) {
    EnvironmentModel environment = world_of(surface(sheet(60, 0.05), mu), 0.02);
    environment.gravity = tilted(slope, GetParam());
    const std::unique_ptr<World> world = ode_world(chain(1), environment);
    constexpr double seconds = 0.6;
    run(*world, seconds);
    const double expected = std::max(0.0, gravity * (std::sin(slope) - mu * std::cos(slope))) * seconds * seconds / 2.0;
    const Eigen::Vector3d way = world->center_of_mass() - Eigen::Vector3d(0, 0, 0.02);
    EXPECT_NEAR(way.head<2>().norm(), expected, 0.004 + 0.02 * expected) << "slope " << slope;
    EXPECT_NEAR(way.z(), 0.0, 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Headings, MeshSlope, testing::Values(0.0, 0.4, 0.785, 1.3));

TEST(MeshWorld, AConvexMeshSlidesOnATriangleMeshAsTheBoxThatItIs) {
  expect_to_slide_as_a_box(ode_world, world_of(surface(sheet(60, 0.05), 0.5), 0.02));
}

TEST(MeshWorld, ALinkOnAMeshPressesItsSensorsAndBearsItsWeight) {
  const std::unique_ptr<World> world = ode_world(chain(2), world_of(surface(sheet(10, 0.1), 0.5), 0.02));
  run(*world, 0.5);
  EXPECT_EQ(world->link_contacts(0), 3U);
  EXPECT_EQ(world->link_contacts(1), 3U);
  EXPECT_NEAR(world->contact_force(0) + world->contact_force(1), 0.2 * gravity, 0.02);
  EXPECT_NEAR(*world->lowest_ground(), 0.0, 1e-12);
}

TEST(MeshWorld, WithObjectsThatMoveRepeatsToTheLastBit) {
  EnvironmentModel environment = world_of(surface(sheet(30, 0.05), 0.5), 0.05);
  environment.moving_objects.push_back(box_object({0.03, 0.1, 0.1}, {0.03, 0.03, 0.03}, 0.1, 0.5));
  const RobotModel robot = chain(3);
  const auto run_once = [&] {
    const std::unique_ptr<World> world = ode_world(robot, environment);
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
