#include "sim/ode/hinge_motor.hpp"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <tuple>

#include "sim/ode/engine.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {
namespace {

constexpr double bars_step_s = 1e-3;

/// Two bars that a hinge connects, in free space. The first is heavy.
class Bars {
 public:
  Bars(double lower_stop, double upper_stop) {
    prepare_engine_for_this_thread();
    world_ = dWorldCreate();
    hinge_ = dJointCreateHinge(world_, nullptr);
    dJointAttach(hinge_, add_bar(1.0, 0.05), add_bar(0.05, -0.05));
    dJointSetHingeAnchor(hinge_, 0, 0, 0);
    dJointSetHingeAxis(hinge_, 0, 1, 0);
    dJointSetHingeParam(hinge_, dParamLoStop, lower_stop);
    dJointSetHingeParam(hinge_, dParamHiStop, upper_stop);
  }
  ~Bars() { dWorldDestroy(world_); }
  Bars(const Bars&) = delete;
  Bars& operator=(const Bars&) = delete;

  void step() { dWorldStep(world_, bars_step_s); }
  [[nodiscard]] dJointID hinge() const { return hinge_; }

 private:
  dBodyID add_bar(double mass_kg, double x) {
    const dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetBoxTotal(&mass, mass_kg, 0.1, 0.02, 0.02);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, x, 0, 0);
    return body;
  }

  dWorldID world_;
  dJointID hinge_;
};

/// Lower and upper stop, rad.
class Stops : public testing::TestWithParam<std::tuple<double, double>> {};

/// The motion of a hinge whose stops the engine knows in every step is the same to the last bit.
TEST_P(Stops, ThatTheEngineLearnsWhenTheyMatterGiveTheSameMotion) {
  const auto [lower, upper] = GetParam();
  Bars with_motor(lower, upper);
  Bars plain(lower, upper);
  Joint joint;
  joint.anchor = {0, 0, 0};
  joint.axis = {0, 1, 0};
  joint.max_torque = 0.2;
  Link link;
  link.mass.center = {0.05, 0, 0};
  HingeMotor motor;
  motor.attach(with_motor.hinge(), dJointGetBody(with_motor.hinge(), 0), joint, link);
  dJointSetHingeParam(plain.hinge(), dParamFMax, joint.max_torque);

  std::mt19937 random(46);
  std::uniform_real_distribution<double> speeds(-12.0, 12.0);
  std::uniform_int_distribution<int> durations(1, 300);
  int at_lower = 0;
  int at_upper = 0;
  int between = 0;
  for (int change = 0; change < 200; ++change) {
    const double speed = speeds(random);
    const bool is_limp = change % 5 == 4;
    motor.set_max_torque(is_limp ? 0.0 : joint.max_torque);
    motor.set_speed(speed);
    dJointSetHingeParam(plain.hinge(), dParamFMax, is_limp ? 0.0 : joint.max_torque);
    dJointSetHingeParam(plain.hinge(), dParamVel, speed);
    const int steps = durations(random);
    for (int step = 0; step < steps; ++step) {
      motor.begin_step();
      with_motor.step();
      motor.end_step();
      plain.step();
      ASSERT_EQ(motor.angle(), dJointGetHingeAngle(plain.hinge())) << "change " << change << ", step " << step;
      at_lower += motor.angle() <= lower ? 1 : 0;
      at_upper += motor.angle() >= upper ? 1 : 0;
      between += motor.angle() > lower && motor.angle() < upper ? 1 : 0;
    }
  }
  EXPECT_GT(std::min(at_lower, at_upper), 100);
  EXPECT_GT(between, 100);
}

INSTANTIATE_TEST_SUITE_P(Pairs, Stops,
                         testing::Values(std::tuple(-0.5 * std::numbers::pi, 0.5 * std::numbers::pi),
                                         std::tuple(-0.01, 0.02), std::tuple(-2.0, 0.0)));

}  // namespace
}  // namespace proleg::sim
