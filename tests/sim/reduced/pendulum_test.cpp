// Links that hang from limp joints. Oracles: the laws of conservation, and Lagrange's equations of the double pendulum,
// integrated by the method of Runge and Kutta. The engine's method is of first order: with half the step, half the
// error.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "sim/reduced/chain_batch.hpp"
#include "sim/reduced/robot_chain.hpp"
#include "tests/sim/physics/small_world.hpp"

namespace proleg::sim::reduced {
namespace {

RobotModel limp_chain(std::size_t links) {
  RobotModel robot = chain(links);
  for (Joint& joint : robot.joints) {
    joint.lower_limit = -3.0;
    joint.upper_limit = 3.0;
  }
  return robot;  // a batch gives motors no torque at first
}

struct Conserved {
  double energy = 0.0;    ///< J, of motion and height
  double rotation = 0.0;  ///< kg m^2/s, about the centre of mass
};

Conserved conserved(const PlanarChain& chain, const ChainBatch<Planar>& batch, std::size_t links) {
  Conserved result;
  const Point center = batch.center(0);
  for (std::size_t i = 0; i < links; ++i) {
    const ChainBatch<Planar>::LinkMotion motion = batch.link_motion(0, i);
    const Point place = batch.link_place(0, i).position;
    const Point& v = motion.velocity;
    result.energy += chain.masses[i] * (0.5 * (v.x * v.x + v.z * v.z) - chain.gravity.z * place.z) +
                     0.5 * chain.inertias[i] * motion.rotation * motion.rotation;
    result.rotation += chain.masses[i] * ((place.x - center.x) * v.z - (place.z - center.z) * v.x) +
                       chain.inertias[i] * motion.rotation;
  }
  return result;
}

/// rad: by which a link has turned since the start.
double angle(const ChainBatch<Planar>& batch, std::size_t link) {
  const ChainBatch<Planar>::LinkPlace place = batch.link_place(0, link);
  return 2.0 * std::atan2(place.half_sine, place.half_cosine);
}

/// The two foremost of three links hang over the edge of a floor; the third is their heavy foot.
struct HangingArm {
  explicit HangingArm(double step) : planar(make(step)), batch(std::span(&planar, 1)) {}

  static PlanarChain make(double step) {
    RobotModel robot = limp_chain(3);
    robot.links[2].mass.mass = 1000.0;
    robot.links[2].mass.inertia *= 1e4;
    EnvironmentModel environment = flat_ground(1.0, 0.02);
    environment.objects[0].pose.position.y() = -50.19;  // the floor ends under the foot
    return make_planar_chain(robot, environment, step, "test");
  }
  void run(double seconds, double step) {
    for (long i = 0; i < std::lround(seconds / step); ++i) {
      batch.step();
    }
  }

  PlanarChain planar;
  ChainBatch<Planar> batch;
};

// Angles below the horizontal of the inner and the outer link, and their rates.
using State = std::array<double, 4>;

State rate(const State& s) {
  const Link link = chain(1).links[0];
  const double m = link.mass.mass;
  const double inertia = link.mass.inertia(0, 0);
  constexpr double a = 0.05;  // m, from a link's joint to its centre of mass
  constexpr double l = 0.1;   // m, between joints
  const double m11 = inertia + m * a * a + m * l * l;
  const double m22 = inertia + m * a * a;
  const double m12 = m * l * a * std::cos(s[0] - s[1]);
  const double coupling = m * l * a * std::sin(s[0] - s[1]);
  const double q1 = (m * a + m * l) * gravity * std::cos(s[0]) - coupling * s[3] * s[3];
  const double q2 = m * a * gravity * std::cos(s[1]) + coupling * s[2] * s[2];
  const double determinant = m11 * m22 - m12 * m12;
  return {s[2], s[3], (m22 * q1 - m12 * q2) / determinant, (m11 * q2 - m12 * q1) / determinant};
}

State integrate(double seconds) {
  State s{};
  constexpr int steps = 10'000;
  const double h = seconds / steps;
  const auto moved = [](const State& from, const State& k, double by) {
    State to = from;
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] += by * k[i];
    }
    return to;
  };
  for (int i = 0; i < steps; ++i) {
    const State k1 = rate(s);
    const State k2 = rate(moved(s, k1, h / 2));
    const State k3 = rate(moved(s, k2, h / 2));
    const State k4 = rate(moved(s, k3, h));
    s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
  }
  return s;
}

constexpr double swing_s = 0.18;  // then the outer link is below the edge

TEST(Pendulum, TwoLimpLinksSwingAsLagrangesEquationsSay) {
  const State expected = integrate(swing_s);
  ASSERT_GT(expected[0], 1.0) << "they do swing";
  std::array<double, 2> errors{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double step = i == 0 ? 2e-4 : 1e-4;
    HangingArm arm(step);
    arm.run(swing_s, step);
    // A joint's angle is that of the link behind less that of the link in front, from x towards z; the foot is behind.
    const double inner = angle(arm.batch, 1);
    const double outer = angle(arm.batch, 0);
    EXPECT_LT(std::abs(angle(arm.batch, 2)), 1e-3) << "the foot stands";
    errors[i] = std::hypot(std::abs(inner) - expected[0], std::abs(outer) - expected[1]);
  }
  EXPECT_LT(errors[1], 5e-3);
  EXPECT_NEAR(errors[1] / errors[0], 0.5, 0.15) << errors[0] << ", " << errors[1];
}

TEST(Pendulum, ItsEnergyErrorFallsWithTheStep) {
  std::array<double, 2> errors{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double step = i == 0 ? 2e-4 : 1e-4;
    HangingArm arm(step);
    const double before = conserved(arm.planar, arm.batch, 2).energy;
    arm.run(swing_s, step);
    errors[i] = std::abs(conserved(arm.planar, arm.batch, 2).energy - before);
  }
  const double fallen = 0.2 * gravity * 0.1;  // J, about what turns into motion
  EXPECT_LT(errors[1], 0.01 * fallen);
  EXPECT_LT(errors[1], 0.7 * errors[0]) << errors[0] << ", " << errors[1];
}

/// Two links roll over an edge and fall, limp, with a spin.
struct Tumble {
  double momentum_error;  ///< m/s, of the horizontal speed of the centre of mass, in the air
  double rotation_error;  ///< share of the angular momentum
  double spin;            ///< kg m^2/s
  double drop_error;      ///< m, against the free fall of the centre of mass
};

Tumble tumble(double step) {
  RobotModel robot = limp_chain(2);
  EnvironmentModel environment = flat_ground(0.5, 0.02);
  environment.objects[0].pose.position.y() = -50.08;
  const PlanarChain planar = make_planar_chain(robot, environment, step, "test");
  ChainBatch<Planar> batch(std::span(&planar, 1));
  long steps = 0;
  const auto is_in_the_air = [&] { return batch.center(0).z < -0.2; };
  while (!is_in_the_air() && steps++ < 100'000) {
    batch.step();
  }
  EXPECT_TRUE(is_in_the_air());
  EXPECT_EQ(batch.contact_count(0), 0U);
  const Conserved start = conserved(planar, batch, 2);
  const double speed = (batch.link_motion(0, 0).velocity.x + batch.link_motion(0, 1).velocity.x) / 2;
  const double fall = (batch.link_motion(0, 0).velocity.z + batch.link_motion(0, 1).velocity.z) / 2;
  const Point from = batch.center(0);
  const long count = std::lround(0.2 / step);
  for (long i = 0; i < count; ++i) {
    batch.step();
    EXPECT_EQ(batch.contact_count(0), 0U);
  }
  const double after = (batch.link_motion(0, 0).velocity.x + batch.link_motion(0, 1).velocity.x) / 2;
  const auto n = static_cast<double>(count);
  const double expected = from.z + n * step * fall - gravity * step * step * n * (n + 1) / 2;
  return {std::abs(after - speed), std::abs(conserved(planar, batch, 2).rotation / start.rotation - 1.0),
          std::abs(start.rotation), std::abs(batch.center(0).z - expected)};
}

TEST(Pendulum, LinksThatTumbleKeepTheirMomentum) {
  const Tumble coarse = tumble(2e-4);
  const Tumble fine = tumble(1e-4);
  EXPECT_GT(fine.spin, 1e-5) << "they do spin";
  EXPECT_LT(fine.momentum_error, 1e-13);
  EXPECT_LT(fine.drop_error, 1e-9);
  // The links' velocities become those of their new places only in the next step.
  EXPECT_LT(fine.rotation_error, 0.01);
  EXPECT_LT(fine.rotation_error, 0.7 * coarse.rotation_error + 1e-9);
}

}  // namespace
}  // namespace proleg::sim::reduced
