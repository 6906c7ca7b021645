// The sensors of a robot's file in each engine, against geometry and mechanics.

#include "sim/sensor/attached_sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shared/computer/errors/input_error.hpp"
#include "sim/mujoco/mujoco_world.hpp"
#include "sim/ode/ode_world.hpp"
#include "sim/reduced/reduced_world.hpp"
#include "tests/sim/physics/small_world.hpp"

namespace proleg::sim {
namespace {

constexpr double radians = std::numbers::pi / 180.0;
constexpr std::uint32_t tick_us = 10'000;
constexpr int steps_per_tick = 10;

AttachedSensor sensor_of(SensorKind kind, std::size_t link, const Pose& pose = {}) {
  AttachedSensor sensor;
  sensor.name = "sensor";
  sensor.kind = kind;
  sensor.part = link;
  sensor.pose = pose;
  sensor.file = "robot.xml";
  sensor.line = 12;
  return sensor;
}

AttachedSensor laser_of(std::size_t link, const Pose& pose, double first_deg, double step_deg, std::size_t rays,
                        double range) {
  AttachedSensor sensor = sensor_of(SensorKind::laser, link, pose);
  sensor.scan = {first_deg * radians, step_deg * radians, rays, range, 0};
  return sensor;
}

Eigen::Quaterniond turned(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * radians, axis));
}

StaticObject box_at(const Eigen::Vector3d& middle, const Eigen::Vector3d& half_sides) {
  StaticObject object;
  object.name = "box";
  object.pose.position = middle;
  Geometry geometry;
  geometry.extents = half_sides;
  object.geometries.push_back(geometry);
  return object;
}

/// A floor through the origin that is turned about it, and the chain that lies on it.
EnvironmentModel slope(const Eigen::Quaterniond& turn, double friction) {
  EnvironmentModel environment;
  StaticObject floor = floor_with_friction(friction);
  floor.pose = Pose{Eigen::Vector3d::Zero(), turn} * floor.pose;
  environment.objects.push_back(floor);
  environment.robot_pose = Pose{Eigen::Vector3d::Zero(), turn} * Pose{{0, 0, 0.02}, Eigen::Quaterniond::Identity()};
  return environment;
}

EnvironmentModel weightless() {
  EnvironmentModel environment;
  environment.gravity.setZero();
  return environment;
}

std::unique_ptr<World> make_world(const std::string& engine, const RobotModel& robot,
                                  const EnvironmentModel& environment) {
  if (engine == "mujoco") {
    return mujoco::make_mujoco_world(robot, environment, step_s, "robot.xml");
  }
  return engine == "reduced" ? reduced::make_reduced_world(robot, environment, step_s, "robot.xml")
                             : make_ode_world(robot, environment, step_s, Stepper::direct);
}

/// The chain with sensors, in a world.
class Rig {
 public:
  Rig(const std::string& engine, std::vector<AttachedSensor> sensors, const EnvironmentModel& environment)
      : robot_(chain(2)), poses_(2) {
    robot_.sensors = std::move(sensors);
    world_ = make_world(engine, robot_, environment);
    measuring_.emplace(robot_.sensors, environment.gravity, step_s, tick_us, *world_);
  }

  void run_ticks(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      for (int step = 0; step < steps_per_tick; ++step) {
        world_->step();
        measuring_->add_step(*world_);
      }
      world_->read_links(poses_);
      measuring_->finish_tick(*world_, poses_, currents);
    }
  }

  std::array<double, 1> currents{};
  [[nodiscard]] World& world() { return *world_; }
  [[nodiscard]] AttachedSensors& sensors() { return *measuring_; }
  [[nodiscard]] std::span<const double> values() const { return measuring_->values(); }

 private:
  RobotModel robot_;
  std::vector<Pose> poses_;
  std::unique_ptr<World> world_;
  std::optional<AttachedSensors> measuring_;
};

/// Each test runs in the engines that have its sensor.
class AttachedSensorsIn : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (GetParam() == "mujoco" && !mujoco::is_built_in()) {
      GTEST_SKIP() << "without MuJoCo";
    }
  }
};
using Laser = AttachedSensorsIn;
using Touch = AttachedSensorsIn;
using Inclination = AttachedSensorsIn;
using Acceleration = AttachedSensorsIn;

constexpr double front_face = 0.04;  // of the head, from its middle

TEST_P(Laser, RaysToAWallAreLongerByTheCosine) {
  EnvironmentModel environment = weightless();
  environment.objects.push_back(box_at({0, 1.1, 0}, {5, 0.1, 5}));
  const Pose at_front{{0, front_face, 0}, turned(90, Eigen::Vector3d::UnitZ())};
  Rig rig(GetParam(), {laser_of(0, at_front, -30, 15, 5, 1.05)}, environment);
  rig.run_ticks(1);
  for (const std::size_t ray : {1U, 2U, 3U}) {
    const double angle = (-30 + 15 * static_cast<double>(ray)) * radians;
    EXPECT_NEAR(rig.values()[ray], (1.0 - front_face) / std::cos(angle), 1e-9) << "ray " << ray;
  }
  EXPECT_EQ(rig.values()[0], 1.05) << "a wall beyond the range is not seen";
  EXPECT_EQ(rig.values()[4], 1.05);
}

TEST_P(Laser, AnglesGrowFromXTowardsY) {
  EnvironmentModel environment = weightless();
  environment.objects.push_back(box_at({1.5, 0, 0}, {0.5, 0.5, 0.5}));
  environment.objects.push_back(box_at({0, 2.5, 0}, {0.5, 0.5, 0.5}));
  Rig rig(GetParam(), {laser_of(0, {}, 0, 90, 2, 10)}, environment);
  rig.run_ticks(1);
  EXPECT_NEAR(rig.values()[0], 1.0, 1e-9);
  EXPECT_NEAR(rig.values()[1], 2.0, 1e-9);
}

TEST_P(Laser, MeasuresTheFloorFromTheSide) {
  EnvironmentModel environment = flat_ground(0.5, 0.3);
  environment.gravity.setZero();
  const Pose downwards{{0, 0, 0}, turned(90, Eigen::Vector3d::UnitY())};  // its x axis points down
  Rig rig(GetParam(), {laser_of(0, downwards, -60, 20, 7, 10)}, environment);
  rig.run_ticks(1);
  for (std::size_t ray = 0; ray < 7; ++ray) {
    const double angle = (-60 + 20 * static_cast<double>(ray)) * radians;
    EXPECT_NEAR(rig.values()[ray], 0.3 / std::cos(angle), 1e-9) << "ray " << ray;
  }
}

TEST_P(Laser, MeasuresASphereAndACylinder) {
  EnvironmentModel environment = weightless();
  StaticObject round = box_at({2, 0, 0}, {0.25, 0, 0});
  round.geometries[0].shape = Shape::sphere;
  environment.objects.push_back(round);
  StaticObject post = box_at({0, 3, 0}, {0.5, 2, 0});
  post.geometries[0].shape = Shape::cylinder;  // along y
  environment.objects.push_back(post);
  Rig rig(GetParam(), {laser_of(0, {}, 0, 90, 2, 10)}, environment);
  rig.run_ticks(1);
  EXPECT_NEAR(rig.values()[0], 1.75, 1e-9);
  EXPECT_NEAR(rig.values()[1], 1.0, 1e-9);
}

TEST_P(Laser, SeesOtherLinksAndNotItsOwn) {
  const Pose forwards{{0, 0, 0}, turned(90, Eigen::Vector3d::UnitZ())};
  Rig rig(GetParam(), {laser_of(1, forwards, 0, 1, 1, 10)}, weightless());
  rig.run_ticks(1);
  EXPECT_NEAR(rig.values()[0], 0.1 - front_face, 1e-9) << "the rear face of the head";
}

TEST_P(Laser, SeesAnObjectThatMoves) {
  EnvironmentModel environment = weightless();
  MovingObject crate;
  crate.name = "crate";
  crate.pose.position = {2, 0, 0};
  crate.geometries = box_at(Eigen::Vector3d::Zero(), {0.25, 0.25, 0.25}).geometries;
  crate.mass.mass = 1.0;
  crate.mass.inertia = Eigen::Matrix3d::Identity() * 0.01;
  environment.moving_objects.push_back(crate);
  Rig rig(GetParam(), {laser_of(0, {}, 0, 90, 2, 10)}, environment);
  rig.run_ticks(1);
  EXPECT_NEAR(rig.values()[0], 1.75, 1e-6);
  EXPECT_EQ(rig.values()[1], 10.0);
}

TEST_P(Laser, ScansInItsPeriod) {
  AttachedSensor laser = laser_of(0, {}, 0, 1, 1, 10);
  laser.scan.period_us = 3 * tick_us;
  Rig rig(GetParam(), {laser}, weightless());
  std::string scans;
  for (int tick = 0; tick < 9; ++tick) {
    rig.run_ticks(1);
    scans += rig.sensors().measured()[0] != 0 ? '1' : '0';
  }
  EXPECT_EQ(scans, "100100100");
}

TEST_P(Laser, KeepsItsPeriodOnAverageIfThatIsNoMultipleOfTheTick) {
  AttachedSensor laser = laser_of(0, {}, 0, 1, 1, 10);
  laser.scan.period_us = 5 * tick_us / 2;
  Rig rig(GetParam(), {laser}, weightless());
  std::string scans;
  for (int tick = 0; tick < 11; ++tick) {
    rig.run_ticks(1);
    scans += rig.sensors().measured()[0] != 0 ? '1' : '0';
  }
  EXPECT_EQ(scans, "10010100101") << "2.5 ticks after the first scan comes the next, at the end of the third";
}

INSTANTIATE_TEST_SUITE_P(Engines, Laser, testing::Values("ode", "mujoco"));

TEST_P(Touch, NormalOnASlopeIsThatOfTheSlope) {
  const Eigen::Quaterniond turn = turned(10, Eigen::Vector3d::UnitX()) * turned(5, Eigen::Vector3d::UnitY());
  Rig rig(GetParam(), {sensor_of(SensorKind::touch, 0)}, slope(turn, 1.0));
  EXPECT_EQ(rig.values()[0], 0.0);
  rig.run_ticks(50);
  const Eigen::Vector3d normal = turn * Eigen::Vector3d::UnitZ();
  EXPECT_EQ(rig.values()[0], 1.0);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(rig.values()[1 + static_cast<std::size_t>(axis)], normal[axis], 1e-3) << "axis " << axis;
  }
}

TEST_P(Touch, OnlyContactsInItsBoxPressIt) {
  AttachedSensor below = sensor_of(SensorKind::touch, 0, {{0, 0.03, -0.02}, Eigen::Quaterniond::Identity()});
  below.extents = {0.03, 0.02, 0.005};
  AttachedSensor face = sensor_of(SensorKind::touch, 0, {{0, 0.04, 0.005}, Eigen::Quaterniond::Identity()});
  face.extents = {0.02, 0.005, 0.012};
  Rig rig(GetParam(), {below, face}, slope(Eigen::Quaterniond::Identity(), 1.0));
  rig.run_ticks(50);
  EXPECT_EQ(rig.values()[0], 1.0);
  EXPECT_EQ(rig.values()[4], 0.0) << "the floor touches the lower edge, outside of the box";
  EXPECT_EQ(rig.values()[7], 0.0) << "no direction without a contact";
}

TEST_P(Touch, AWallPressesTheFaceAndPushesBack) {
  AttachedSensor face = sensor_of(SensorKind::touch, 0, {{0, 0.04, 0.0}, Eigen::Quaterniond::Identity()});
  face.extents = {0.03, 0.005, 0.03};
  EnvironmentModel environment = weightless();
  environment.objects.push_back(box_at({0, 0.5395, 0}, {5, 0.5, 5}));  // half a millimetre inside the head
  Rig rig(GetParam(), {face}, environment);
  rig.world().step();  // the next ones push the robot out of the wall
  rig.sensors().add_step(rig.world());
  const std::vector<Pose> poses{rig.world().link_pose(0), rig.world().link_pose(1)};
  rig.sensors().finish_tick(rig.world(), poses, rig.currents);
  EXPECT_EQ(rig.values()[0], 1.0);
  EXPECT_NEAR(rig.values()[2], -1.0, 1e-9) << "towards the tail";
}

TEST_P(Touch, AContactInAnyStepOfTheTickCounts) {
  EnvironmentModel environment = weightless();
  environment.objects.push_back(box_at({0, 0.5395, 0}, {5, 0.5, 5}));  // half a millimetre inside the head
  Rig rig(GetParam(), {sensor_of(SensorKind::touch, 0)}, environment);
  rig.world().step();
  rig.sensors().add_step(rig.world());
  rig.world().move_robot({{0, -0.1, 0}, Eigen::Quaterniond::Identity()});
  rig.run_ticks(1);
  EXPECT_EQ(rig.values()[0], 1.0);
  rig.run_ticks(1);
  EXPECT_EQ(rig.values()[0], 0.0) << "and only in that tick";
}

TEST_P(Touch, AWiredSensorTakesThePlaceOfTheOneUnderTheLink) {
  AttachedSensor face = sensor_of(SensorKind::touch, 0, {{0, 0.04, 0.02}, Eigen::Quaterniond::Identity()});
  face.extents = {0.02, 0.005, 0.01};
  face.input = TouchInput::front;
  Rig rig(GetParam(), {face}, slope(Eigen::Quaterniond::Identity(), 1.0));
  rig.run_ticks(50);
  std::array<std::uint8_t, 2> contacts{3, 3};
  rig.sensors().replace_inputs(contacts);
  EXPECT_EQ(contacts[0], 1U) << "front is released, rear stays";
  EXPECT_EQ(contacts[1], 3U) << "of the other link";
}

INSTANTIATE_TEST_SUITE_P(Engines, Touch, testing::Values("ode", "mujoco"));

TEST_P(Inclination, AtRestIsTheSlopeAlongTheRobot) {
  Rig rig(GetParam(), {sensor_of(SensorKind::inclinometer, 0)}, slope(turned(12, Eigen::Vector3d::UnitX()), 1.0));
  rig.run_ticks(100);
  EXPECT_NEAR(rig.values()[0], 12.0, 0.05) << "front above rear is positive";
  EXPECT_NEAR(rig.values()[1], 0.0, 0.05);
}

TEST_P(Inclination, FollowsTheSensorsFrame) {
  const Pose tilted{{0, 0, 0}, turned(20, Eigen::Vector3d::UnitY())};
  Rig rig(GetParam(), {sensor_of(SensorKind::inclinometer, 1, tilted)}, slope(Eigen::Quaterniond::Identity(), 1.0));
  rig.run_ticks(20);
  EXPECT_NEAR(rig.values()[0], 0.0, 0.05);
  EXPECT_NEAR(rig.values()[1], 20.0, 0.05) << "about the direction ahead, right side down";
}

INSTANTIATE_TEST_SUITE_P(Engines, Inclination, testing::Values("ode", "mujoco", "reduced"));

TEST_P(Acceleration, AtRestIsGravityUpwards) {
  Rig rig(GetParam(), {sensor_of(SensorKind::accelerometer, 1, {{0.01, 0.02, 0.0}, Eigen::Quaterniond::Identity()})},
          slope(Eigen::Quaterniond::Identity(), 1.0));
  rig.run_ticks(100);
  EXPECT_NEAR(rig.values()[0], 0.0, 0.01);
  EXPECT_NEAR(rig.values()[1], 0.0, 0.01);
  EXPECT_NEAR(rig.values()[2], gravity, 0.01);
}

TEST_P(Acceleration, InFreeFallIsZeroFromTheFirstTick) {
  Rig rig(GetParam(), {sensor_of(SensorKind::accelerometer, 0)}, flat_ground(0.5, 1.0));
  rig.run_ticks(1);
  EXPECT_NEAR(Eigen::Vector3d(rig.values()[0], rig.values()[1], rig.values()[2]).norm(), 0.0, 1e-6);
  rig.run_ticks(20);
  EXPECT_NEAR(Eigen::Vector3d(rig.values()[0], rig.values()[1], rig.values()[2]).norm(), 0.0, 1e-6);
}

TEST_P(Acceleration, OfABodyThatSlidesIsFrictionAndSupport) {
  constexpr double angle = 20.0 * radians;
  constexpr double friction = 0.1;
  Rig rig(GetParam(), {sensor_of(SensorKind::accelerometer, 0)}, slope(turned(20, Eigen::Vector3d::UnitX()), friction));
  rig.run_ticks(60);
  // It accelerates by g (sin - mu cos) down the slope. Less gravity, friction and support remain.
  EXPECT_NEAR(rig.values()[1], friction * gravity * std::cos(angle), 0.03) << "up the slope";
  EXPECT_NEAR(rig.values()[2], gravity * std::cos(angle), 0.05);
}

TEST_P(Acceleration, AMoveByHandIsNone) {
  Rig rig(GetParam(), {sensor_of(SensorKind::accelerometer, 0)}, slope(Eigen::Quaterniond::Identity(), 1.0));
  rig.run_ticks(50);
  rig.world().move_robot({{0, 0.5, 0}, Eigen::Quaterniond::Identity()});
  const std::vector<Pose> poses{rig.world().link_pose(0), rig.world().link_pose(1)};
  rig.sensors().rest_at(poses);
  rig.run_ticks(1);
  EXPECT_NEAR(rig.values()[1], 0.0, 0.2);
  EXPECT_NEAR(rig.values()[2], gravity, 0.5);
}

INSTANTIATE_TEST_SUITE_P(Engines, Acceleration, testing::Values("ode", "mujoco", "reduced"));

TEST(ServoCurrentSensor, IsThatOfItsJoint) {
  Rig rig("ode", {sensor_of(SensorKind::servo_current, 0)}, flat_ground(0.5, 0.02));
  rig.currents = {321.5};
  rig.run_ticks(1);
  EXPECT_EQ(rig.values()[0], 321.5);
}

TEST(SensorSummaries, HaveLeastGreatestAndMean) {
  Rig rig("ode", {sensor_of(SensorKind::servo_current, 0)}, flat_ground(0.5, 0.02));
  for (const double current : {100.0, 400.0, 10.0}) {
    rig.currents = {current};
    rig.run_ticks(1);
  }
  const SensorSummary& summary = rig.sensors().summaries().at(0);
  EXPECT_EQ(summary.quantity, "current");
  EXPECT_EQ(summary.least, 10.0);
  EXPECT_EQ(summary.greatest, 400.0);
  EXPECT_DOUBLE_EQ(summary.mean(), 170.0);
}

TEST(ReducedEngine, RefusesSensorsThatItDoesNotHave) {
  for (const SensorKind kind : {SensorKind::laser, SensorKind::touch}) {
    try {
      const Rig rig("reduced", {sensor_of(kind, 0)}, flat_ground(0.5, 0.02));
      ADD_FAILURE() << name_of(kind);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()), "robot.xml:12: found sensor 'sensor' of type " + std::string(name_of(kind)) +
                                               ", expected what the reduced engine has: ServoCurrent, Inclinometer and "
                                               "Accelerometer (--engine ode has all sensors)");
    }
  }
}

}  // namespace
}  // namespace proleg::sim
