#include "sim/reduced/robot_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shared/computer/errors/input_error.hpp"
#include "tests/sim/physics/small_world.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim::reduced {
namespace {

PlanarChain planar(const RobotModel& robot, const EnvironmentModel& environment) {
  return make_planar_chain(robot, environment, step_s, "top.xml");
}

Eigen::Quaterniond turn_degrees(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees / 180 * std::numbers::pi, axis));
}

StaticObject object(const std::string& name, const Eigen::Vector3d& position, const Eigen::Vector3d& extents) {
  StaticObject object = floor_with_friction(0.5);
  object.name = name;
  object.pose.position = position;
  object.geometries[0].extents = extents;
  return object;
}

/// Three links on a floor, with names, and a change.
struct Case {
  RobotModel robot = chain(3);
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  Case() {
    for (std::size_t i = 0; i < 3; ++i) {
      robot.links[i].name = "L" + std::to_string(i);
    }
    robot.joints[0].name = "J0";
    robot.joints[1].name = "J1";
    environment.objects[0].name = "floor";
  }
};

template <typename Change>
void expect_refused(const std::string& found, const Change& change) {
  Case changed;
  change(changed);
  const std::string message =
      message_of<InputError>([&] { static_cast<void>(planar(changed.robot, changed.environment)); });
  EXPECT_EQ(message, "top.xml: found " + found +
                         ", expected what the reduced engine has: chains of boxes with parallel, horizontal axes on "
                         "boxes (or --engine ode)");
}

TEST(PlanarChain, RefusesByNameRobotsThatDoNotMoveInAVerticalPlane) {
  expect_refused("joint 'J0', whose axis is not horizontal",
                 [](Case& c) { c.robot.joints[0].axis = Eigen::Vector3d::UnitZ(); });
  expect_refused("joint 'J1', whose axis is not parallel to that of joint 'J0'",
                 [](Case& c) { c.robot.joints[1].axis = Eigen::Vector3d::UnitZ(); });
  expect_refused("joint 'J0', whose axis is not horizontal",
                 [](Case& c) { c.environment.robot_pose.orientation = turn_degrees(90, Eigen::Vector3d::UnitY()); });
  expect_refused("a robot without joints that stands on its side", [](Case& c) {
    c.robot.links.resize(1);
    c.robot.joints.clear();
    c.environment.robot_pose.orientation = turn_degrees(90, Eigen::Vector3d::UnitY());
  });
  expect_refused("the centre of mass of link 'L1', which is not in the plane in which the robot moves",
                 [](Case& c) { c.robot.links[1].mass.center.x() = 0.001; });
  expect_refused("link 'L2', whose mass is not the same on both sides of the plane in which it moves",
                 [](Case& c) { c.robot.links[2].mass.inertia(0, 1) = c.robot.links[2].mass.inertia(1, 0) = 1e-5; });
  expect_refused("a shape of link 'L1', which is not in the plane in which the robot moves",
                 [](Case& c) { c.robot.links[1].geometries[0].pose.position.x() = 0.001; });
  expect_refused("gravity across the plane in which the robot moves", [](Case& c) {
    c.environment.gravity = {0.1, 0, -9.8};
  });
}

TEST(PlanarChain, RefusesByNameLinksThatAreNoRectanglesInThePlane) {
  expect_refused("link 'L1' with a box that is oblique to the plane in which the robot moves", [](Case& c) {
    c.robot.links[1].geometries[0].pose.orientation = turn_degrees(10, Eigen::Vector3d::UnitZ());
  });
  expect_refused("link 'L1' with a sphere", [](Case& c) { c.robot.links[1].geometries[0].shape = Shape::sphere; });
  expect_refused("link 'L2' with a cylinder", [](Case& c) { c.robot.links[2].geometries[0].shape = Shape::cylinder; });
}

std::shared_ptr<const TriangleMesh> triangle() {
  TriangleMesh mesh;
  mesh.vertices = {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return std::make_shared<const TriangleMesh>(mesh);
}

TEST(PlanarChain, RefusesByNameMeshesAndObjectsThatMove) {
  expect_refused("link 'L1' with a convex mesh", [](Case& c) {
    c.robot.links[1].geometries[0].shape = Shape::hull;
    c.robot.links[1].geometries[0].mesh = triangle();
  });
  for (const auto& [shape, name] :
       {std::pair(Shape::surface, "a triangle mesh"), std::pair(Shape::height_field, "a height field")}) {
    expect_refused("object 'hills' with " + std::string(name), [shape = shape](Case& c) {
      StaticObject hills = object("hills", {0, 1, 0}, {1, 1, 1});
      hills.geometries[0].shape = shape;
      hills.geometries[0].mesh = triangle();
      c.environment.objects.push_back(hills);
    });
  }
  expect_refused("object 'ball', which moves", [](Case& c) {
    c.environment.moving_objects.push_back({"ball", {}, {}, {}, {}});
  });
}

TEST(PlanarChain, RefusesByNameObjectsInTheWayThatAreNoRectanglesInThePlane) {
  const auto add = [](const StaticObject& added) {
    return [added](Case& c) { c.environment.objects.push_back(added); };
  };
  StaticObject stone = object("stone", {0, 1, 0}, {0.2, 0.2, 0.2});
  stone.geometries[0].shape = Shape::sphere;
  expect_refused("object 'stone' with a sphere", add(stone));
  stone.geometries[0].shape = Shape::cylinder;
  expect_refused("object 'stone' with a cylinder", add(stone));
  StaticObject step = object("step", {0, 1, 0}, {1, 0.2, 0.05});
  step.pose.orientation = turn_degrees(20, Eigen::Vector3d::UnitZ());
  expect_refused("object 'step' with a box that is oblique to the plane in which the robot moves", add(step));
  step.pose.orientation = turn_degrees(20, Eigen::Vector3d::UnitY());
  expect_refused("object 'step' with a box that is oblique to the plane in which the robot moves", add(step));
  // The robot is 40 mm wide.
  expect_refused("object 'wall', which is in the way of a part of the robot's width only",
                 add(object("wall", {0.1, 1, 0}, {0.09, 0.2, 1})));
  expect_refused("object 'post', which is in the way of a part of the robot's width only",
                 add(object("post", {0, 1, 0}, {0.01, 0.2, 1})));
}

TEST(PlanarChain, LeavesOutWhatIsBesideTheRobotsWay) {
  Case c;
  StaticObject ball = object("ball", {0.5, 0, 0}, {0.4, 0, 0});
  ball.geometries[0].shape = Shape::sphere;
  c.environment.objects.push_back(ball);
  c.environment.objects.push_back(object("wall", {-1.03, 0, 0}, {1, 5, 5}));
  EXPECT_EQ(planar(c.robot, c.environment).terrain.size(), 1U) << "the floor";
  c.environment.objects.erase(c.environment.objects.begin());
  EXPECT_EQ(planar(c.robot, c.environment).terrain.size(), 0U);
}

TEST(PlanarChain, TheLowestGroundIsThatOfAllObjectsAlsoBesideTheWay) {
  EXPECT_FALSE(planar(chain(3), EnvironmentModel{}).lowest_ground);
  Case c;
  StaticObject log = object("log", {5, 0, -2}, {0.25, 1.0, 0});
  log.geometries[0].shape = Shape::cylinder;  // its axis is y
  c.environment.objects.push_back(log);
  EXPECT_DOUBLE_EQ(planar(c.robot, c.environment).lowest_ground.value(), -2.25);
  c.environment.objects[1].pose.orientation = turn_degrees(90, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(planar(c.robot, c.environment).lowest_ground.value(), -3.0, 1e-12);
}

// A floor of 4 x 4 m under a robot whose way is oblique to it. Its half width of 20 mm must be on the floor, too.
TEST(PlanarChain, ATurnedFloorEndsWhereItIsNoLongerUnderTheWholeRobot) {
  Case c;
  c.environment.objects[0] = object("floor", {0, 0, -0.5}, {2, 2, 0.5});
  c.environment.robot_pose.orientation = turn_degrees(30, Eigen::Vector3d::UnitZ());
  const PlanarChain chain = planar(c.robot, c.environment);
  ASSERT_EQ(chain.terrain.size(), 1U);
  const Rectangle& floor = chain.terrain[0];
  EXPECT_EQ(floor.along, (Point{1.0, 0.0}));
  EXPECT_EQ(floor.center.z, -0.5);
  EXPECT_EQ(floor.half_height, 0.5);
  EXPECT_NEAR(floor.center.x, 0.0, 1e-8);
  EXPECT_NEAR(floor.half_length, (2.0 - 0.02 * 0.5) / std::cos(std::numbers::pi / 6), 1e-8);
}

bool is_on_the_grid(double value, int bits) {
  const double scaled = std::ldexp(value, bits);
  return scaled == std::round(scaled);
}

TEST(PlanarChain, NumbersAreWholeMultiplesOfPowersOfTwo) {
  Case c;
  c.environment.robot_pose = {{0.1, 0.2, 0.3},
                              turn_degrees(37, Eigen::Vector3d::UnitZ()) * turn_degrees(11, Eigen::Vector3d::UnitX())};
  c.environment.gravity = {0, 0, -9.80665};
  c.robot.links[1].mass.mass = 1.0 / 3.0;
  const PlanarChain chain = planar(c.robot, c.environment);
  const auto expect_point = [](const Point& point) {
    EXPECT_TRUE(is_on_the_grid(point.x, 30)) << point.x;
    EXPECT_TRUE(is_on_the_grid(point.z, 30)) << point.z;
  };
  for (const Planar::Link& link : chain.links) {
    for (const Point& point : {link.front, link.rear, link.forward, link.down}) {
      expect_point(point);
    }
  }
  const auto expect_rectangle = [&](const Rectangle& rectangle) {
    expect_point(rectangle.center);
    expect_point(rectangle.along);
    expect_point({rectangle.half_length, rectangle.half_height});
  };
  for (const Planar::Shape& shape : chain.shapes) {
    expect_rectangle(shape.outline);
  }
  for (const Rectangle& solid : chain.terrain) {
    expect_rectangle(solid);
  }
  expect_point(chain.gravity);
  expect_point(chain.first_link);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(is_on_the_grid(chain.masses[i], 30)) << chain.masses[i];
    EXPECT_TRUE(is_on_the_grid(chain.inertias[i], 50)) << chain.inertias[i];
    EXPECT_NEAR(chain.masses[i], c.robot.links[i].mass.mass, 1e-9);
    EXPECT_NEAR(chain.inertias[i], c.robot.links[i].mass.inertia(0, 0), 1e-13);
  }
  for (const double friction : chain.friction) {
    EXPECT_TRUE(is_on_the_grid(friction, 30)) << friction;
  }
}

TEST(PlanarChain, AnAxisThatPointsTheOtherWayChangesSignAndLimitsOfItsJoint) {
  Case c;
  c.robot.joints[1].axis = -Eigen::Vector3d::UnitX();
  c.robot.joints[1].lower_limit = -0.25;
  c.robot.joints[1].upper_limit = 0.75;
  const PlanarChain chain = planar(c.robot, c.environment);
  EXPECT_EQ(chain.joint_signs, (std::vector<double>{1.0, -1.0}));
  EXPECT_EQ(chain.joints[0], (JointLimits{-1.0, 1.0}));
  EXPECT_EQ(chain.joints[1], (JointLimits{-0.75, 0.25}));
}

TEST(PlanarChain, FrictionIsTheGeometricMeanOfTwoSurfacesOrThatOfTheOneThatHasIt) {
  Case c;
  c.robot.links[0].geometries[0].friction = 0.25;
  c.environment.objects[0].geometries[0].friction = 1.0;
  const auto on_floor = [&] {
    std::vector<double> friction = planar(c.robot, c.environment).friction;
    friction.resize(3);  // behind these come those of links with each other
    return friction;
  };
  EXPECT_EQ(on_floor(), (std::vector<double>{0.5, 1.0, 1.0}));
  c.environment.objects[0].geometries[0].friction.reset();
  c.environment.unspecified_friction = 0.125;
  EXPECT_EQ(on_floor(), (std::vector<double>{0.25, 0.125, 0.125}));
}

TEST(PlanarChain, ChainsOfOtherMassFrictionAndPlaceHaveTheSameForm) {
  const PlanarChain plain = planar(chain(3), flat_ground(0.5, 0.02));
  RobotModel heavy = chain(3);
  heavy.links[1].mass.mass = 7.0;
  EXPECT_TRUE(plain.has_form_of(planar(heavy, flat_ground(0.25, 0.5))));
  RobotModel narrow = chain(3);
  narrow.joints[1].upper_limit = 0.5;
  EXPECT_FALSE(plain.has_form_of(planar(narrow, flat_ground(0.5, 0.02))));
  EXPECT_FALSE(plain.has_form_of(planar(chain(4), flat_ground(0.5, 0.02))));
  EXPECT_FALSE(plain.has_form_of(planar(chain(3), EnvironmentModel{})));
}

}  // namespace
}  // namespace proleg::sim::reduced
