// Motions whose measures can be computed by hand.

#include "sim/measure/gait_meter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "test_robot.hpp"
#include "test_units.hpp"

namespace proleg::sim {
namespace {

/// Feeds a meter with a robot that slides without turning, its links at the positions of its model.
class Motion {
 public:
  using Path = std::function<Eigen::Vector3d(double t)>;
  using Angle = std::function<double(std::size_t joint, double t)>;
  using Contact = std::function<std::uint8_t(std::size_t link, int tick)>;

  explicit Motion(std::size_t links = 6) : robot(straight_robot(links)) {}

  RobotModel robot;
  EnvironmentModel environment;
  Path path = [](double /*t*/) { return Eigen::Vector3d(0, 0, 0); };
  Angle angle = [](std::size_t /*joint*/, double /*t*/) { return 0.0; };
  Contact contact = [](std::size_t /*link*/, int /*tick*/) { return std::uint8_t{0}; };

  [[nodiscard]] GaitMeter after(double seconds) const {
    GaitMeter meter(robot, environment, path(0.0), step_s, tick_s);
    std::vector<Pose> poses(robot.links.size());
    std::vector<double> angles(robot.joints.size());
    std::vector<std::uint8_t> contacts(robot.links.size());
    for (int tick = 1; tick <= std::lround(seconds / tick_s); ++tick) {
      const double t = tick * tick_s;
      for (std::size_t link = 0; link < poses.size(); ++link) {
        poses[link] = robot.links[link].pose;
        poses[link].position += path(t) - path(0.0);
        contacts[link] = contact(link, tick - 1);
      }
      for (std::size_t joint = 0; joint < angles.size(); ++joint) {
        angles[joint] = angle(joint, t);
      }
      meter.add_tick({path(t), poses, angles, angles, angles, contacts});
    }
    return meter;
  }
  [[nodiscard]] MeasureValues values_after(double seconds) const { return after(seconds).values(); }
};

TEST(GaitMeter, DefinesNothingBeforeTheFirstTick) {
  const GaitMeter meter = Motion().after(0);
  const MeasureValues values = meter.values();
  for (const double value : values.all()) {
    EXPECT_TRUE(std::isnan(value));
  }
  for (const double factor : meter.link_duty_factors()) {
    EXPECT_TRUE(std::isnan(factor));
  }
}

TEST(GaitMeter, DistanceIsHorizontalAndStraight) {
  Motion motion;
  motion.path = [](double t) { return Eigen::Vector3d(1 + 0.3 * t, 2 - 0.4 * t, 7 * t); };
  EXPECT_NEAR(motion.values_after(2)[Measure::distance], 1.0, 1e-12) << "thesis, equation 3.7";
  EXPECT_NEAR(motion.values_after(2)[Measure::height], 14.0, 1e-12);
  motion.path = [](double t) { return Eigen::Vector3d(std::cos(t), std::sin(t), 0); };
  EXPECT_NEAR(motion.values_after(2)[Measure::distance], 2 * std::sin(1.0), 1e-12) << "not along the path";
}

TEST(GaitMeter, SpeedIsAlongAHeadingRelativeToTheDirectionOfTheHead) {
  Motion motion;  // its head points to +y, so its left is -x
  motion.path = [](double t) { return Eigen::Vector3d(0.3 * t, 0.4 * t, t); };
  const GaitMeter meter = motion.after(3);
  const auto speed = [&meter](double heading) { return meter.values(heading)[Measure::speed]; };
  EXPECT_NEAR(speed(0), 0.4, 1e-12);
  EXPECT_NEAR(speed(180), -0.4, 1e-12);
  EXPECT_NEAR(speed(90), -0.3, 1e-12);
  EXPECT_NEAR(speed(-90), 0.3, 1e-12);
  EXPECT_NEAR(speed(-std::atan2(0.3, 0.4) / degree), 0.5, 1e-12) << "the heading it takes";
  EXPECT_EQ(meter.values()[Measure::speed], speed(0));

  motion.environment.robot_pose.orientation =
      Eigen::Quaterniond(Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));  // now it points to +x
  EXPECT_NEAR(motion.values_after(3)[Measure::speed], 0.3, 1e-12);
  motion.environment.robot_pose.orientation =
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(std::isnan(motion.values_after(3)[Measure::speed])) << "it stands on its tail";
}

TEST(GaitMeter, SmoothnessIsTheRootMeanSquareOfTheAcceleration) {
  Motion motion;
  motion.path = [](double t) { return Eigen::Vector3d(0.3 * t, 0.4 * t, 0.1 * t); };
  EXPECT_NEAR(motion.values_after(2)[Measure::smoothness], 0.0, 1e-9);
  motion.path = [](double t) { return Eigen::Vector3d(t * t, 0, t * t); };
  EXPECT_NEAR(motion.values_after(2)[Measure::smoothness], std::sqrt(8.0), 1e-8);
  constexpr double w = 2 * std::numbers::pi;
  motion.path = [](double t) { return Eigen::Vector3d(0, 0.05 * std::sin(w * t), 0); };
  EXPECT_NEAR(motion.values_after(10)[Measure::smoothness], 0.05 * w * w / std::sqrt(2.0), 0.01);
}

TEST(GaitMeter, LargestAccelerationIsThatOfASingleJolt) {
  Motion motion;
  motion.path = [](double t) { return Eigen::Vector3d(0.3 * t, 0, t * t); };
  EXPECT_NEAR(motion.values_after(2)[Measure::largest_acceleration], 2.0, 1e-8);
  constexpr double w = 2 * std::numbers::pi;
  motion.path = [](double t) { return Eigen::Vector3d(0, 0.05 * std::sin(w * t), 0); };
  EXPECT_NEAR(motion.values_after(10)[Measure::largest_acceleration], 0.05 * w * w, 0.01);
  // From 0.2 m/s to rest within a tick of 10 ms.
  motion.path = [](double t) { return Eigen::Vector3d(0, 0.2 * std::min(t, 1.0), 0); };
  EXPECT_NEAR(motion.values_after(2)[Measure::largest_acceleration], 0.2 / tick_s, 1e-6);
}

TEST(GaitMeter, TheStabilityMarginIsTheDistanceFromTheCentreOfMassToTheNearerOutermostSupport) {
  // Three links of 72 mm: their sensors lie 18 mm before and behind their middles, at +72, 0 and -72 mm. The head
  // points to +y; the centre of mass is that of the path, at 0 by default.
  Motion motion(3);
  const auto margin = [&motion](const std::vector<std::uint8_t>& contacts, double center = 0.0) {
    motion.path = [center](double /*t*/) { return Eigen::Vector3d(0, center, 0); };
    motion.contact = [&contacts](std::size_t link, int /*tick*/) { return contacts[link]; };
    // The links are where their model has them, 72 mm further back than described above.
    return motion.values_after(0.1)[Measure::stability_margin];
  };
  EXPECT_NEAR(margin({3, 0, 3}, -0.072), 0.090, 1e-12);
  EXPECT_NEAR(margin({1, 0, 2}, -0.072), 0.054, 1e-12) << "rear sensor of the head, front sensor of the tail";
  EXPECT_NEAR(margin({0, 3, 0}, -0.072), 0.018, 1e-12);
  EXPECT_NEAR(margin({3, 0, 3}, -0.052), 0.070, 1e-12) << "the nearer one";
  EXPECT_NEAR(margin({3, 0, 3}, -0.092), 0.070, 1e-12) << "on either side";
  EXPECT_NEAR(margin({0, 0, 3}, -0.072), -0.054, 1e-12) << "outside";
  EXPECT_NEAR(margin({2, 0, 0}, -0.072), -0.090, 1e-12) << "one support: the distance to it";
  EXPECT_TRUE(std::isnan(margin({0, 0, 0}))) << "in the air";
}

TEST(GaitMeter, TheStabilityMarginIsAMeanOfTheTicksWithSupport) {
  Motion motion(3);
  motion.path = [](double /*t*/) { return Eigen::Vector3d(0, -0.072, 0); };
  motion.contact = [](std::size_t link, int tick) {
    const std::array<std::array<std::uint8_t, 3>, 4> gait{{{3, 0, 3}, {0, 3, 0}, {0, 0, 0}, {2, 0, 0}}};
    return gait[static_cast<std::size_t>(tick) % 4][link];
  };
  EXPECT_NEAR(motion.values_after(0.4)[Measure::stability_margin], (0.090 + 0.018 - 0.090) / 3, 1e-12);
}

TEST(GaitMeter, TheDutyFactorIsTheShareOfWholeStridesOnTheGround) {
  Motion motion(4);
  motion.angle = [](std::size_t joint, double t) {
    return 0.5 * std::sin(2 * std::numbers::pi * t - static_cast<double>(joint));
  };
  // By stride of 100 ticks: the head always, the next 30 ticks with one sensor or both, then 50, the tail never.
  motion.contact = [](std::size_t link, int tick) -> std::uint8_t {
    const int phase = tick % 100;
    switch (link) {
      case 0:
        return 3;
      case 1:
        return phase < 10 ? 1 : phase < 20 ? 3 : phase < 30 ? 2 : 0;
      case 2:
        return phase >= 50 ? 1 : 0;
      default:
        return 0;
    }
  };
  for (const double seconds : {5.0, 5.37, 7.9}) {
    const GaitMeter meter = motion.after(seconds);
    const std::vector<double> factors = meter.link_duty_factors();
    ASSERT_EQ(factors.size(), 4U);
    EXPECT_NEAR(factors[0], 1.0, 1e-12);
    EXPECT_NEAR(factors[1], 0.3, 1e-12) << seconds << " s: not those of a part of a stride";
    EXPECT_NEAR(factors[2], 0.5, 1e-12);
    EXPECT_NEAR(factors[3], 0.0, 1e-12);
    EXPECT_NEAR(meter.values()[Measure::duty_factor], 1.8 / 4, 1e-12);
  }
  motion.angle = [](std::size_t /*joint*/, double /*t*/) { return 0.0; };
  EXPECT_NEAR(motion.after(1.3).link_duty_factors()[1], 60.0 / 130, 1e-12) << "without strides: of all ticks";
}

TEST(GaitMeter, StridesGiveLengthFrequencyAndFroudeNumber) {
  Motion motion;
  motion.path = [](double t) { return Eigen::Vector3d(0, 0.06 * t, 0); };
  motion.angle = [](std::size_t joint, double t) {
    return 0.5 * std::sin(2 * std::numbers::pi * 1.5 * t - static_cast<double>(joint));
  };
  const MeasureValues values = motion.values_after(20);
  EXPECT_NEAR(values[Measure::stride_frequency], 1.5, 1e-3);
  EXPECT_NEAR(values[Measure::stride_length], 0.04, 4e-5);
  EXPECT_NEAR(values[Measure::froude_number], 0.06 * 0.06 / (9.81 * 0.04), 1e-5) << "v^2 / (g * stride length)";
  motion.angle = [](std::size_t /*joint*/, double /*t*/) { return 0.2; };
  const MeasureValues still = motion.values_after(20);
  for (const Measure measure : {Measure::stride_frequency, Measure::stride_length, Measure::froude_number}) {
    EXPECT_TRUE(std::isnan(still[measure])) << declaration_of(measure).name;
  }
}

TEST(GaitMeter, SlipIsThePathThatTheLoadSlidesOverTheDistance) {
  const auto slip = [](double normal_force, double sliding_speed, double speed) {
    Motion motion;
    motion.path = [speed](double t) { return Eigen::Vector3d(0, speed * t, 0); };
    GaitMeter meter = motion.after(2.0);
    for (long step = 0; step < std::lround(2.0 / step_s); ++step) {
      meter.add_contacts(normal_force, normal_force * sliding_speed, 0.0);
    }
    return meter.values()[Measure::slip];
  };
  EXPECT_NEAR(slip(6.0, 0.1, 0.1), 1.0, 1e-9) << "a box that is dragged";
  EXPECT_NEAR(slip(6.0, 0.0, 0.1), 0.0, 1e-9) << "contacts that hold";
  EXPECT_NEAR(slip(6.0, 0.3, 0.1), 3.0, 1e-9) << "a robot that slips back and forth";
  EXPECT_NEAR(slip(60.0, 0.3, 0.1), 3.0, 1e-9) << "of any weight";
  EXPECT_TRUE(std::isnan(slip(0.0, 0.0, 0.1))) << "in the air";
  EXPECT_TRUE(std::isnan(slip(6.0, 0.3, 0.0))) << "on the spot";
}

TEST(GaitMeter, SlipCountsOnlyTheLoadThatSlides) {
  Motion motion;
  motion.path = [](double t) { return Eigen::Vector3d(0, 0.1 * t, 0); };
  GaitMeter meter = motion.after(2.0);
  for (long step = 0; step < std::lround(2.0 / step_s); ++step) {
    meter.add_contacts(4.0, 1.0 * 0.1, 0.0);  // a quarter of the load is dragged
  }
  EXPECT_NEAR(meter.values()[Measure::slip], 0.25, 1e-9);
}

TEST(GaitMeter, HeadingAndSidewaysSpeedAreRelativeToTheHeadAtTheStart) {
  Motion motion;  // its head points to +y, so its left is -x
  motion.path = [](double t) { return Eigen::Vector3d(-0.3 * t, 0.3 * t, 0); };
  MeasureValues values = motion.values_after(2);
  EXPECT_NEAR(values[Measure::heading], 45.0, 1e-9);
  EXPECT_NEAR(values[Measure::sideways_speed], 0.3, 1e-12);
  motion.path = [](double t) { return Eigen::Vector3d(0.2 * t, 0, 0); };
  values = motion.values_after(2);
  EXPECT_NEAR(values[Measure::heading], -90.0, 1e-9);
  EXPECT_NEAR(values[Measure::sideways_speed], -0.2, 1e-12);
  EXPECT_NEAR(values[Measure::speed], 0.0, 1e-12);
  EXPECT_NEAR(values[Measure::yaw_rate], 0.0, 1e-12) << "it goes sideways and does not turn";
  motion.path = [](double /*t*/) { return Eigen::Vector3d(0, 0, 0); };
  EXPECT_TRUE(std::isnan(motion.values_after(2)[Measure::heading]));
}

TEST(GaitMeter, TheYawRateCountsWholeTurnsOfTheBody) {
  const RobotModel robot = straight_robot(6);
  const std::vector<double> angles(5);
  const std::vector<std::uint8_t> contacts(6);
  for (const double rate_deg : {30.0, -30.0, 400.0}) {
    GaitMeter meter(robot, EnvironmentModel{}, Eigen::Vector3d::Zero(), step_s, tick_s);
    for (int tick = 1; tick <= 300; ++tick) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(rate_deg * degree * tick * tick_s, Eigen::Vector3d::UnitZ()));
      std::vector<Pose> poses;
      for (const Link& link : robot.links) {
        poses.push_back(Pose{{0, 0, 0}, turn} * link.pose);
      }
      meter.add_tick({Eigen::Vector3d::Zero(), poses, angles, angles, angles, contacts});
    }
    EXPECT_NEAR(meter.values()[Measure::yaw_rate], rate_deg, 1e-6);
  }
}

/// A robot of two joints that swings at `frequency` and goes along a circle at `speed`, from one gait to the next.
class ChangingGait {
 public:
  ChangingGait()
      : robot_(straight_robot(3)), meter_(robot_, EnvironmentModel{}, Eigen::Vector3d::Zero(), step_s, tick_s) {}

  std::optional<double> speed_after(double seconds, double frequency, double amplitude_deg,
                                    const Eigen::Vector2d& speed) {
    const std::vector<Pose> poses(3);
    const std::vector<std::uint8_t> contacts(3);
    for (long tick = 0; tick < std::lround(seconds / tick_s); ++tick) {
      phase_ += 2.0 * std::numbers::pi * frequency * tick_s;
      place_ += speed * tick_s;
      // Within a stride the body goes forth and back by a millimetre.
      const Eigen::Vector2d swing(0.001 * std::sin(phase_), 0.0);
      const std::vector<double> angles{amplitude_deg * degree * std::sin(phase_), 0.0};
      const Eigen::Vector2d center = place_ + swing;
      meter_.add_tick({{center.x(), center.y(), 0.0}, poses, angles, angles, angles, contacts});
    }
    return meter_.recent_speed();
  }

 private:
  RobotModel robot_;
  GaitMeter meter_;
  double phase_ = 0.0;
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero();
};

TEST(GaitMeter, TheRecentSpeedIsThatOfTheLastTwoStridesInAnyDirection) {
  ChangingGait gait;
  EXPECT_FALSE(gait.speed_after(1.9, 1.0, 40, {0.05, 0.0}));
  EXPECT_NEAR(*gait.speed_after(5.0, 1.0, 40, {0.05, 0.0}), 0.05, 1e-4);
  EXPECT_NEAR(*gait.speed_after(2.6, 20.0, 9, {0.035, 0.0}), 0.035, 1e-4) << "a faster gait, 2.5 s after the change";
  EXPECT_NEAR(*gait.speed_after(9.0, 0.3, 40, {0.0, -0.17}), 0.17, 1e-3) << "a slow one that goes to its side";
  EXPECT_NEAR(*gait.speed_after(5.0, 1.0, 0.0, {-0.02, 0.0}), 0.02, 1e-4) << "joints that stand still: two seconds";
}

/// One joint, which follows its set-points badly for some seconds.
GaitMeter tracking(double error_deg, double commanded_speed, double torque, double seconds, bool limp = false) {
  const RobotModel robot = straight_robot(2);  // 2 Nm, 4.5 rad/s
  GaitMeter meter(robot, EnvironmentModel{}, Eigen::Vector3d::Zero(), step_s, tick_s);
  const std::vector<Pose> poses(2);
  const std::vector<std::uint8_t> contacts(2);
  for (long tick = 0; tick < std::lround(seconds / tick_s); ++tick) {
    for (int step = 0; step < 10; ++step) {
      meter.add_joint_step(0, {torque, commanded_speed, 0.0, 0.0, limp});
    }
    const double sign = tick % 2 == 0 ? 1.0 : -1.0;
    const double angle = 0.3;
    const double setpoint = 0.3 + sign * error_deg * degree;
    meter.add_tick({Eigen::Vector3d::Zero(), poses, {&angle, 1}, {&angle, 1}, {&setpoint, 1}, contacts});
  }
  return meter;
}

TEST(GaitMeter, TrackingErrorsAreThoseFromTheSetPointsAfterTheFirstSecond) {
  const MeasureValues values = tracking(3.0, 1.0, 0.5, 4.0).values();
  EXPECT_NEAR(values[Measure::tracking_error], 3.0, 1e-9) << "root mean square";
  EXPECT_NEAR(values[Measure::max_tracking_error], 3.0, 1e-9);
  EXPECT_EQ(values[Measure::at_speed_limit], 0.0);
  EXPECT_EQ(values[Measure::at_torque_limit], 0.0);
  for (const MeasureValues& none :
       {tracking(3.0, 1.0, 0.5, 0.9).values(), tracking(3.0, 1.0, 0.5, 4.0, true).values()}) {
    EXPECT_TRUE(std::isnan(none[Measure::tracking_error])) << "before the gait, or without pulses";
    EXPECT_TRUE(std::isnan(none[Measure::at_speed_limit]));
  }
}

TEST(GaitMeter, AServoIsAtItsLimitInEitherDirection) {
  EXPECT_EQ(tracking(3.0, 4.5, 0.5, 2.0).values()[Measure::at_speed_limit], 1.0);
  EXPECT_EQ(tracking(3.0, -4.5, 0.5, 2.0).values()[Measure::at_speed_limit], 1.0);
  EXPECT_EQ(tracking(3.0, 4.4, 0.5, 2.0).values()[Measure::at_speed_limit], 0.0);
  EXPECT_EQ(tracking(3.0, 1.0, 2.0, 2.0).values()[Measure::at_torque_limit], 1.0);
  EXPECT_EQ(tracking(3.0, 1.0, -2.0, 2.0).values()[Measure::at_torque_limit], 1.0);
  EXPECT_EQ(tracking(3.0, 1.0, 1.9, 2.0).values()[Measure::at_torque_limit], 0.0);
  EXPECT_NEAR(tracking(3.0, 4.5, 0.5, 3.0).tracking()[0].at_speed_limit(), 1.0, 1e-12);
}

// docs/gait-measures.md: above a fifth of the time at a limit, and above 5 degrees.
TEST(GaitMeter, AServoAtALimitThatMissesItsAnglesCannotFollow) {
  const auto cannot_follow = [](double error_deg, double commanded_speed, double torque) {
    return tracking(error_deg, commanded_speed, torque, 3.0).tracking()[0].cannot_follow();
  };
  EXPECT_TRUE(cannot_follow(5.1, 4.5, 0.5));
  EXPECT_TRUE(cannot_follow(5.1, 1.0, 2.0));
  EXPECT_FALSE(cannot_follow(4.9, 4.5, 2.0)) << "it keeps its angle";
  EXPECT_FALSE(cannot_follow(5.1, 1.0, 0.5)) << "it lags behind without a limit";
  EXPECT_FALSE(tracking(5.1, 4.5, 0.5, 0.9).tracking()[0].cannot_follow()) << "before the gait";
}

/// The measures after one joint has turned at a speed with a torque for a second.
MeasureValues turning(Motion motion, double torque, double speed, double commanded, bool limp = false) {
  GaitMeter meter(motion.robot, motion.environment, Eigen::Vector3d::Zero(), step_s, tick_s);
  double angle = 0.0;
  meter.add_joint_step(0, {0.0, speed, -speed * step_s, 0.0, true});  // the joint has its speed already
  const double before = 0.06 * 0.01 * step_s;                         // J, drawn in this step
  for (int step = 0; step < 1000; ++step) {
    meter.add_joint_step(0, {torque, commanded, angle, angle + speed * step_s, limp});
    angle += speed * step_s;
  }
  const std::vector<Pose> poses(motion.robot.links.size());
  const std::vector<double> angles(motion.robot.joints.size());
  const std::vector<std::uint8_t> contacts(motion.robot.links.size());
  meter.add_tick({{0.5, 0, 0}, poses, angles, angles, angles, contacts});
  MeasureValues values = meter.values();
  EXPECT_GE(values[Measure::electrical_energy], before);
  return values;
}

TEST(GaitMeter, MechanicalEnergyIsPositiveWorkOnly) {
  const Motion motion(2);
  EXPECT_NEAR(turning(motion, 0.2, 3.0, 3.0)[Measure::mechanical_energy], 0.6, 1e-9);
  EXPECT_NEAR(turning(motion, -0.2, -3.0, -3.0)[Measure::mechanical_energy], 0.6, 1e-9) << "in both directions";
  EXPECT_EQ(turning(motion, -0.2, 3.0, 3.0)[Measure::mechanical_energy], 0.0) << "braking gives nothing back";
  EXPECT_EQ(turning(motion, 0.2, 0.0, 1.0)[Measure::mechanical_energy], 0.0) << "holding is no work";
}

TEST(GaitMeter, ElectricalEnergyIsWhatTheServosDrawAtSixVolts) {
  const Motion motion(2);
  const auto energy = [&motion](double speed, double commanded, bool limp = false) {
    return turning(motion, 0.1, speed, commanded, limp)[Measure::electrical_energy];
  };
  constexpr double tolerance = 1e-3;  // the step before the second
  EXPECT_NEAR(energy(0, 0), 6 * 0.010, tolerance) << "at rest";
  EXPECT_NEAR(energy(4.5, 4.5), 6 * 0.200, tolerance) << "free, at full speed";
  EXPECT_NEAR(energy(0, 4.5), 6 * 1.5, tolerance) << "held";
  EXPECT_NEAR(energy(0, -4.5), 6 * 1.5, tolerance);
  EXPECT_NEAR(energy(2.0, 4.5, true), 6 * 0.010, tolerance) << "without pulses";
}

TEST(GaitMeter, MeanCurrentIsThatOfAServo) {
  const Motion motion(2);
  EXPECT_NEAR(turning(motion, 0.1, 4.5, 4.5)[Measure::mean_current], 200.0, 0.5) << "free, at full speed";
  EXPECT_NEAR(turning(motion, 0.1, 0, 4.5)[Measure::mean_current], 1500.0, 2.0) << "held";
}

TEST(GaitMeter, CostsOfTransportAreEnergyPerMassAndDistance) {
  Motion motion(2);  // 0.2 kg; turning() goes half a metre
  const MeasureValues values = turning(motion, 0.2, 3.0, 3.0);
  EXPECT_NEAR(values[Measure::cost_of_transport], 0.6 / (0.2 * 0.5), 1e-8);
  EXPECT_NEAR(values[Measure::specific_resistance], 0.6 / (0.2 * 0.5 * 9.81), 1e-9);
  EXPECT_NEAR(values[Measure::electrical_cost_of_transport], values[Measure::electrical_energy] / 0.1, 1e-12);

  motion.environment.gravity.setZero();
  EXPECT_TRUE(std::isnan(turning(motion, 0.2, 3.0, 3.0)[Measure::specific_resistance]));
  EXPECT_NEAR(turning(motion, 0.2, 3.0, 3.0)[Measure::cost_of_transport], 6.0, 1e-8);

  for (Link& link : motion.robot.links) {
    link.mass.mass *= 3;
  }
  EXPECT_NEAR(turning(motion, 0.2, 3.0, 3.0)[Measure::cost_of_transport], 2.0, 1e-8)
      << "of a robot three times as heavy";
}

TEST(GaitMeter, ARobotThatDoesNotMoveHasNoCostOfTransport) {
  Motion motion;
  motion.path = [](double t) { return Eigen::Vector3d(0, 0.0009 * t, 0); };
  MeasureValues values = motion.values_after(1);
  EXPECT_TRUE(std::isnan(values[Measure::cost_of_transport]));
  EXPECT_TRUE(std::isnan(values[Measure::electrical_cost_of_transport]));
  EXPECT_TRUE(std::isnan(values[Measure::specific_resistance]));
  values = motion.values_after(2);
  EXPECT_EQ(values[Measure::cost_of_transport], 0.0) << "1.8 mm, without work";
}

TEST(GaitMeter, ADayLongRunTakesItsStridesFromTheLastTicks) {
  Motion motion(2);
  const double change_s = 0.5 * static_cast<double>(GaitMeter::history_ticks) * tick_s;
  motion.angle = [&](std::size_t /*joint*/, double t) {
    return 0.5 * std::sin(2 * std::numbers::pi * (t < change_s ? 1.0 : 2.0) * t);
  };
  const double seconds = 2.2 * static_cast<double>(GaitMeter::history_ticks) * tick_s;
  const GaitMeter meter = motion.after(seconds);
  EXPECT_NEAR(meter.values()[Measure::stride_frequency], 2.0, 1e-4) << "early strides do not count";
  EXPECT_LE(meter.stride()->end_tick, 2 * GaitMeter::history_ticks);
}

}  // namespace
}  // namespace proleg::sim
