// Steps per second and core of the spatial prototype and of ODE, for the same robots and gaits, in one run.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "sim/ode/ode_world.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/reduced/reduced_world.hpp"

using namespace proleg::sim;
using namespace proleg::sim::reduced;
static double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

constexpr std::size_t joints = 5;
constexpr double step_s = 0.001;
constexpr double gain = 50.0, max_speed = 4.5;

struct Gait {
  double amplitude[joints], frequency, phase[joints], offset[joints];
};

static RobotModel make_robot(int pattern) {  // 0: pitch only, 1: alternating
  RobotModel robot;
  const auto link = [&](double middle, double half, double mass, double mass_half, double mass_middle) {
    Link l;
    l.name = "L" + std::to_string(robot.links.size());
    l.mass.mass = mass;
    l.mass.center = {0, mass_middle, 0};
    const double a = 0.052 * 0.052 / 12, b = 4 * mass_half * mass_half / 12;
    l.mass.inertia = Eigen::Vector3d(mass * (a + b), mass * 2 * a, mass * (a + b)).asDiagonal();
    Geometry g;
    g.pose.position = {0, middle, 0};
    g.extents = {0.026, half, 0.026};
    l.geometries.push_back(g);
    robot.links.push_back(l);
  };
  // from head to tail
  link(0.288 + 0.018, 0.004, 0.05, 0.018, 0.288 + 0.018);
  for (int i = 3; i >= 0; --i) link(0.072 * i + 0.036, 0.018, 0.1, 0.036, 0.072 * i + 0.036);
  link(-0.018, 0.004, 0.05, 0.018, -0.018);
  for (int j = 0; j < 5; ++j) {
    Joint joint;
    joint.name = "J";
    joint.anchor = {0, 0.072 * (4 - j), 0};
    joint.axis = pattern == 1 && j % 2 == 1 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
    joint.lower_limit = -std::numbers::pi / 2;
    joint.upper_limit = std::numbers::pi / 2;
    joint.max_torque = 0.4;
    joint.max_speed = max_speed;
    robot.joints.push_back(joint);
  }
  return robot;
}

static EnvironmentModel make_environment() {
  EnvironmentModel e;
  StaticObject floor;
  floor.pose.position = {0, 0, -0.003};
  Geometry g;
  g.extents = {8, 8, 0.003};
  g.friction = 0.1;
  floor.geometries.push_back(g);
  e.objects.push_back(floor);
  e.robot_pose.position = {0, 0, 0.026};
  return e;
}

struct Track {
  double distance = 0, path = 0, x = 0, y = 0, contacts = 0;
  double seconds = 0;
  bool failed = false;
  std::vector<double> energy;
};

struct Drive {  // targets by a recurrence, the same on both sides
  double s[joints], c[joints], ds, dc;
  explicit Drive(const Gait& g) {
    for (std::size_t j = 0; j < joints; ++j) {
      s[j] = std::sin(g.phase[j]);
      c[j] = std::cos(g.phase[j]);
    }
    ds = std::sin(2 * std::numbers::pi * g.frequency * step_s);
    dc = std::cos(2 * std::numbers::pi * g.frequency * step_s);
  }
  double target(const Gait& g, std::size_t j) {
    const double n = s[j] * dc + c[j] * ds;
    c[j] = c[j] * dc - s[j] * ds;
    s[j] = n;
    return g.offset[j] + g.amplitude[j] * n;
  }
};

static Track run_ode(const RobotModel& robot, const Gait& gait, int steps) {
  auto world = make_ode_world(robot, make_environment(), step_s, Stepper::direct);
  Track t;
  Drive drive(gait);
  const double start = now();
  const Eigen::Vector3d a = world->center_of_mass();
  Eigen::Vector3d last = a;
  try {
    for (int i = 0; i < steps; ++i) {
      for (std::size_t j = 0; j < joints; ++j) {
        world->set_joint_speed(j, std::clamp(gain * (drive.target(gait, j) - world->joint_angle(j)), -max_speed, max_speed));
      }
      world->step();
      t.contacts += double(world->contact_count()) / steps;
      if (i % 100 == 99) {
        const Eigen::Vector3d c = world->center_of_mass();
        t.path += std::hypot(c.x() - last.x(), c.y() - last.y());
        last = c;
      }
    }
  } catch (const PhysicsError&) {
    t.failed = true;
  }
  t.seconds = now() - start;
  const Eigen::Vector3d b = world->center_of_mass();
  t.x = b.x() - a.x();
  t.y = b.y() - a.y();
  t.distance = std::hypot(t.x, t.y);
  return t;
}

static std::vector<Track> run_worlds(const ChainKernel* kernel, const RobotModel& robot, const std::vector<Gait>& gaits, int steps, double& seconds, double& hash, double& contacts) {
  const EnvironmentModel environment = make_environment();
  std::vector<WorldInput> inputs(gaits.size(), WorldInput{&robot, &environment, step_s, "test"});
  ReducedWorlds all(inputs, kernel);
  auto worlds = all.take_worlds();
  std::vector<Drive> drives(gaits.begin(), gaits.end());
  std::vector<Track> tracks(gaits.size());
  std::vector<Eigen::Vector3d> start, last;
  for (auto& w : worlds) start.push_back(w->center_of_mass());
  last = start;
  contacts = 0;
  const double begin = now();
  std::vector<double> angles(joints), torques(joints), speeds(joints);
  for (int step = 0; step < steps; ++step) {
    for (std::size_t w = 0; w < worlds.size(); ++w) {
      worlds[w]->read_joints(angles, torques);
      for (std::size_t j = 0; j < joints; ++j) speeds[j] = std::clamp(gain * (drives[w].target(gaits[w], j) - angles[j]), -max_speed, max_speed);
      worlds[w]->set_joint_speeds(speeds);
    }
    all.step();
    for (auto& w : worlds) { if (worlds.size() > 1) w->step(); contacts += double(w->contact_count()); }
    if (step % 100 == 99) for (std::size_t w = 0; w < worlds.size(); ++w) {
      const Eigen::Vector3d c = worlds[w]->center_of_mass();
      tracks[w].path += std::hypot(c.x() - last[w].x(), c.y() - last[w].y());
      last[w] = c;
    }
  }
  seconds = now() - begin;
  contacts /= double(steps) * double(worlds.size());
  hash = 0;
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    tracks[w].x = last[w].x() - start[w].x();
    tracks[w].y = last[w].y() - start[w].y();
    tracks[w].distance = std::hypot(tracks[w].x, tracks[w].y);
    hash += tracks[w].x * double(w + 1) + tracks[w].y;
  }
  return tracks;
}

static std::vector<double> ranks(const std::vector<double>& v) {
  std::vector<std::size_t> o(v.size());
  std::iota(o.begin(), o.end(), 0U);
  std::ranges::sort(o, {}, [&](std::size_t i) { return v[i]; });
  std::vector<double> r(v.size());
  for (std::size_t i = 0; i < o.size(); ++i) r[o[i]] = double(i);
  return r;
}

int main(int argc, char** argv) {
  const int pattern = argc > 1 ? std::atoi(argv[1]) : 1;
  const std::size_t worlds = argc > 2 ? std::atoi(argv[2]) : 64;
  const int steps = argc > 3 ? std::atoi(argv[3]) : 10000;
  const int ode_worlds = argc > 4 ? std::atoi(argv[4]) : 8;
  const int repeats = argc > 5 ? std::atoi(argv[5]) : 3;
  const RobotModel robot = make_robot(pattern);
  std::mt19937_64 random(1);
  const auto uniform = [&](double a, double b) { return a + (b - a) * double(random() >> 11) * 0x1p-53; };
  std::vector<Gait> gaits(worlds);
  for (Gait& g : gaits) {
    const double pitch = uniform(10, 50), yaw = uniform(10, 50), shift = uniform(-180, 180), side = uniform(-180, 180);
    g.frequency = 1.0;
    const double turn = uniform(-10, 10);
    for (std::size_t j = 0; j < joints; ++j) {
      const bool is_yaw = pattern == 1 && j % 2 == 1;
      g.amplitude[j] = (is_yaw ? yaw : pitch) * std::numbers::pi / 180;
      g.phase[j] = (double(j) * shift + (is_yaw ? side : 0.0)) * std::numbers::pi / 180;
      g.offset[j] = is_yaw ? turn * std::numbers::pi / 180 : 0.0;
    }
  }
  std::vector<Track> ode;
  double ode_seconds = 0, ode_contacts = 0;
  for (int i = 0; i < ode_worlds; ++i) {
    ode.push_back(run_ode(robot, gaits[i], steps));
    ode_seconds += ode.back().seconds;
    ode_contacts += ode.back().contacts / ode_worlds;
  }
  const double ode_rate = double(steps) * ode_worlds / ode_seconds;
  std::printf("%s, %zu worlds, %d steps\nODE        %9.0f steps/s  %.2f us; contacts %.2f\n", pattern ? "pitch and yaw" : "pitch", worlds, steps, ode_rate, 1e6 / ode_rate, ode_contacts);
  std::vector<Track> tracks;
  for (const ChainKernel* kernel : supported_kernels()) {
    std::vector<double> times;
    double hash = 0, contacts = 0;
    for (int r = 0; r < repeats; ++r) {
      double t = 0;
      tracks = run_worlds(kernel, robot, gaits, steps, t, hash, contacts);
      times.push_back(t);
    }
    std::ranges::sort(times);
    const double rate = double(steps) * double(worlds) / times[times.size() / 2];
    std::printf("%-14s %9.0f steps/s  %.3f us  %5.1f x ODE; contacts %.2f  sum %.17g\n", kernel->instructions, rate, 1e6 / rate, rate / ode_rate, contacts, hash);
    std::fflush(stdout);
  }
  std::vector<double> a, b, d, away;
  for (std::size_t i = 0; i < ode.size(); ++i) {
    a.push_back(ode[i].distance);
    b.push_back(tracks[i].distance);
    d.push_back(std::abs(a[i] - b[i]));
    away.push_back(std::hypot(ode[i].x - tracks[i].x, ode[i].y - tracks[i].y));
    if (i < 12) std::printf("  %2zu ODE distance %.3f path %.3f (%.3f %.3f) c %.1f%s   spatial %.3f path %.3f (%.3f %.3f)\n", i, ode[i].distance, ode[i].path, ode[i].x, ode[i].y, ode[i].contacts, ode[i].failed ? " failed" : "", b[i], tracks[i].path, tracks[i].x, tracks[i].y);
  }
  const auto ra = ranks(a), rb = ranks(b);
  double sum = 0;
  for (std::size_t i = 0; i < ra.size(); ++i) sum += (ra[i] - rb[i]) * (ra[i] - rb[i]);
  const double n = double(ra.size());
  std::ranges::sort(d);
  std::ranges::sort(away);
  std::vector<double> sa = a;
  std::ranges::sort(sa);
  std::printf("rank correlation %.4f; difference of distance: median %.3f m, worst %.3f; end points apart: median %.3f, worst %.3f; median distance %.3f\n", 1 - 6 * sum / (n * (n * n - 1)), d[d.size() / 2], d.back(), away[away.size() / 2], away.back(), sa[sa.size() / 2]);
}
