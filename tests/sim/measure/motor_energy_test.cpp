// The torque of a motor that the world reports, and the energy that the meter computes from it, against mechanics: the
// weight that a motor holds, the height to which it lifts it, the speed that it gives it.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/measure/gait_meter.hpp"
#include "sim/ode/ode_world.hpp"
#include "test_robot.hpp"
#include "test_units.hpp"

namespace proleg::sim {
namespace {

constexpr double gravity = 9.81;

/// A heavy foot on the ground that a light arm stands out from, towards the head and in the air.
RobotModel arm_robot() {
  RobotModel robot = straight_robot(2, 0.1, 0.1);
  robot.links[1].mass.mass = 50.0;
  robot.links[1].mass.inertia *= 500.0;
  robot.links[0].geometries.clear();
  return robot;
}

EnvironmentModel rough_ground(double start_height) {
  EnvironmentModel environment;
  StaticObject floor;
  floor.pose.position = {0, 0, -0.5};
  Geometry geometry;
  geometry.extents = {5, 5, 0.5};
  geometry.friction = 1.0;
  floor.geometries.push_back(geometry);
  environment.objects.push_back(floor);
  environment.robot_pose.position = {0, 0, start_height};
  return environment;
}

/// A world with a meter that gets the motion of its joints.
class MeteredWorld {
  std::unique_ptr<World> made_;

 public:
  MeteredWorld(const RobotModel& robot, const EnvironmentModel& environment, Stepper stepper = Stepper::direct)
      : made_(make_ode_world(robot, environment, step_s, stepper)),
        world(*made_),
        joints_(robot.joints.size()),
        start_(world.center_of_mass()),
        meter_(robot, environment, start_, step_s, step_s) {}

  World& world;

  void step() {
    std::vector<double> before(joints_);
    for (std::size_t joint = 0; joint < joints_; ++joint) {
      before[joint] = world.joint_angle(joint);
    }
    world.step();
    for (std::size_t joint = 0; joint < joints_; ++joint) {
      const double angle = world.joint_angle(joint);
      meter_.add_joint_step(joint, {world.motor_torque(joint), 0.0, before[joint], angle, false});
      work_ += world.motor_torque(joint) * 0.5 * ((angle - before[joint]) / step_s + speed(joint)) * step_s;
      speeds_.resize(joints_);
      speeds_[joint] = (angle - before[joint]) / step_s;
    }
  }
  void run(double seconds) {
    for (long i = 0; i < std::lround(seconds / step_s); ++i) {
      step();
    }
  }
  /// Positive work only, and all of it.
  [[nodiscard]] double energy() {
    const std::vector<Pose> poses(joints_ + 1);
    const std::vector<double> angles(joints_);
    const std::vector<std::uint8_t> contacts(joints_ + 1);
    GaitMeter meter = meter_;
    meter.add_tick({world.center_of_mass(), poses, angles, angles, angles, contacts});
    return meter.values()[Measure::mechanical_energy];
  }
  [[nodiscard]] double work() const { return work_; }
  [[nodiscard]] double speed(std::size_t joint) const { return joint < speeds_.size() ? speeds_[joint] : 0.0; }

 private:
  std::size_t joints_;
  Eigen::Vector3d start_;
  GaitMeter meter_;
  double work_ = 0.0;
  std::vector<double> speeds_;
};

class MotorTorque : public testing::TestWithParam<Stepper> {};

TEST_P(MotorTorque, HoldsAnArmAgainstItsWeight) {
  const RobotModel robot = arm_robot();
  const std::unique_ptr<World> world = make_ode_world(robot, rough_ground(0.02), step_s, GetParam());
  EXPECT_EQ(world->motor_torque(0), 0.0) << "before the first step";
  for (int i = 0; i < 500; ++i) {
    world->step();
  }
  // The arm's centre of mass is 50 mm before the joint; a positive angle raises it.
  EXPECT_NEAR(world->motor_torque(0), 0.1 * gravity * 0.05, 1e-3 * 0.049);
}

TEST_P(MotorTorque, IsAboutTheAxisInEitherDirection) {
  RobotModel robot = arm_robot();
  robot.joints[0].axis = -Eigen::Vector3d::UnitX();
  // The frame of the arm has any orientation and origin.
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
  const Eigen::Vector3d shift(0.01, 0.02, -0.03);
  Link& arm = robot.links[0];
  arm.mass.center = turned.conjugate() * -shift;
  arm.mass.inertia = turned.conjugate().toRotationMatrix() * arm.mass.inertia * turned.toRotationMatrix();
  arm.pose = {arm.pose.position + shift, turned};
  EnvironmentModel environment = rough_ground(0.02);
  environment.robot_pose.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()));
  const std::unique_ptr<World> world = make_ode_world(robot, environment, step_s, GetParam());
  for (int i = 0; i < 500; ++i) {
    world->step();
  }
  EXPECT_NEAR(world->motor_torque(0), -0.1 * gravity * 0.05, 1e-3 * 0.049);
}

TEST_P(MotorTorque, IsTheMaximumUnderOverloadAndZeroWhenLimp) {
  const std::unique_ptr<World> world = make_ode_world(arm_robot(), rough_ground(0.02), step_s, GetParam());
  for (int i = 0; i < 200; ++i) {
    world->step();
  }
  world->set_joint_torque(0, 0.03);  // 0.049 Nm are needed
  for (int i = 0; i < 20; ++i) {
    world->step();
    EXPECT_NEAR(world->motor_torque(0), 0.03, 1e-12) << i;
  }
  world->set_joint_torque(0, 0.0);
  for (int i = 0; i < 20; ++i) {
    world->step();
    EXPECT_EQ(world->motor_torque(0), 0.0) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Steppers, MotorTorque, testing::Values(Stepper::direct, Stepper::iterative),
                         [](const auto& stepper) { return stepper.param == Stepper::direct ? "Direct" : "Iterative"; });

TEST(MotorEnergy, OfAnArmThatIsLiftedIsItsPotentialEnergy) {
  const RobotModel robot = arm_robot();
  MeteredWorld metered(robot, rough_ground(0.02));
  metered.run(0.2);  // the foot comes to rest
  const double energy_before = metered.energy();
  const double height_before = metered.world.link_pose(0).position.z();
  metered.world.set_joint_speed(0, 1.0);
  metered.run(0.8);
  metered.world.set_joint_speed(0, 0.0);
  metered.run(0.05);
  const double gained = 0.1 * gravity * (metered.world.link_pose(0).position.z() - height_before);
  EXPECT_NEAR(metered.world.joint_angle(0), 0.8, 0.01);
  // The kinetic energy that the brake removed at the end counts, too: 1 rad/s about the joint.
  const double kinetic = 0.5 * (robot.links[0].mass.inertia(0, 0) + 0.1 * 0.05 * 0.05);
  EXPECT_NEAR(metered.energy() - energy_before, gained + kinetic, 0.002 * gained);
}

TEST(MotorEnergy, IsNotReturnedWhenTheArmIsLowered) {
  MeteredWorld metered(arm_robot(), rough_ground(0.02));
  metered.world.set_joint_speed(0, 1.0);
  metered.run(0.8);
  const double lifted = metered.energy();
  metered.world.set_joint_speed(0, -1.0);
  metered.run(0.8);
  EXPECT_NEAR(metered.energy(), lifted, 0.01 * lifted);
  EXPECT_NEAR(metered.work(), 0.0, 0.01 * lifted) << "including the work of braking";
}

/// The sum over links, from two poses a step apart.
double kinetic_energy(const RobotModel& robot, const std::vector<Pose>& before, const std::vector<Pose>& after) {
  double energy = 0.0;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const MassProperties& mass = robot.links[i].mass;
    const Eigen::Vector3d velocity = (after[i] * mass.center - before[i] * mass.center) / step_s;
    const Eigen::AngleAxisd turn(before[i].orientation.conjugate() * after[i].orientation);
    const Eigen::Vector3d rate = turn.angle() / step_s * turn.axis();
    energy += 0.5 * mass.mass * velocity.squaredNorm() + 0.5 * rate.dot(mass.inertia * rate);
  }
  return energy;
}

std::vector<Pose> poses_of(const World& world, std::size_t links) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < links; ++i) {
    poses.push_back(world.link_pose(i));
  }
  return poses;
}

TEST(MotorEnergy, OfARobotInSpaceIsItsKineticEnergy) {
  const RobotModel robot = straight_robot(4);
  EnvironmentModel space;
  space.gravity.setZero();
  space.robot_pose.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(0.9, Eigen::Vector3d(3, 1, 2).normalized()));
  MeteredWorld metered(robot, space);
  double max_energy = 0.0;
  std::vector<Pose> before = poses_of(metered.world, 4);
  for (int i = 0; i < 1000; ++i) {
    for (std::size_t joint = 0; joint < 3; ++joint) {
      metered.world.set_joint_speed(joint, 4.0 * std::sin(0.01 * i + static_cast<double>(joint)));
    }
    metered.step();
    const std::vector<Pose> after = poses_of(metered.world, 4);
    const double energy = kinetic_energy(robot, before, after);
    max_energy = std::max(max_energy, energy);
    EXPECT_NEAR(metered.work(), energy, 0.02 * max_energy) << "step " << i;
    before = after;
  }
  EXPECT_GT(max_energy, 1e-3);
  EXPECT_GE(metered.energy(), max_energy);
}

}  // namespace
}  // namespace proleg::sim
