// The cost of the simulator beyond the physics engine: the time of `simulate`, and of `hil` with native modules on the
// simulated bus, without a recorder, against a bare loop over the same world that calls the engine and nothing else.
// They run in turn in one process, so their ratios are valid on any machine. The bare loop always has the same gait:
// the travelling wave of uniform.simulation.xml with 40 degrees of amplitude, 55 degrees of phase difference and 1 Hz.
//
//   bench_simulate SCENARIO [SECONDS] [REPETITIONS]

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/ode/engine.hpp"
#include "sim/scenario/reader.hpp"

namespace {

using namespace proleg;
using namespace proleg::sim;

/// The scenario's robot made of boxes on its flat floor, in the engine's own terms, and a sine at every joint.
class BareLoop {
 public:
  explicit BareLoop(const Scenario& scenario) : scenario_(scenario) {
    prepare_engine_for_this_thread();
    threading_ = dThreadingAllocateSelfThreadedImplementation();
    world_ = dWorldCreate();
    dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_), threading_);
    // Two spaces, as in the simulator: the engine does not test pairs of links.
    robot_space_ = dSimpleSpaceCreate(nullptr);
    environment_space_ = dSimpleSpaceCreate(nullptr);
    group_ = dJointGroupCreate(0);
    dWorldSetGravity(world_, 0, 0, scenario.environment.gravity.z());
    for (const StaticObject& object : scenario.environment.objects) {
      for (const Geometry& geometry : object.geometries) {
        const dGeomID floor = dCreateBox(environment_space_, 2 * geometry.extents.x(), 2 * geometry.extents.y(),
                                         2 * geometry.extents.z());
        const Eigen::Vector3d position = (object.pose * geometry.pose).position;
        dGeomSetPosition(floor, position.x(), position.y(), position.z());
        friction_ = geometry.friction.value_or(default_friction);
      }
    }
    const Pose& start = scenario.environment.robot_pose;
    for (const Link& link : scenario.robot.links) {
      const dBodyID body = dBodyCreate(world_);
      dMass mass;
      dMassSetParameters(&mass, link.mass.mass, 0, 0, 0, link.mass.inertia(0, 0), link.mass.inertia(1, 1),
                         link.mass.inertia(2, 2), 0, 0, 0);
      dBodySetMass(body, &mass);
      const Eigen::Vector3d center = start * (link.pose * link.mass.center);
      dBodySetPosition(body, center.x(), center.y(), center.z());
      for (const Geometry& geometry : link.geometries) {
        const dGeomID box =
            dCreateBox(robot_space_, 2 * geometry.extents.x(), 2 * geometry.extents.y(), 2 * geometry.extents.z());
        dGeomSetBody(box, body);
        const Eigen::Vector3d offset = geometry.pose.position - link.mass.center;
        dGeomSetOffsetPosition(box, offset.x(), offset.y(), offset.z());
      }
      bodies_.push_back(body);
    }
    for (std::size_t i = 0; i < scenario.robot.joints.size(); ++i) {
      const Joint& joint = scenario.robot.joints[i];
      const dJointID hinge = dJointCreateHinge(world_, nullptr);
      dJointAttach(hinge, bodies_[i], bodies_[i + 1]);
      const Eigen::Vector3d anchor = start * joint.anchor;
      dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
      dJointSetHingeAxis(hinge, joint.axis.x(), joint.axis.y(), joint.axis.z());
      dJointSetHingeParam(hinge, dParamFMax, joint.max_torque);
      joints_.push_back(hinge);
    }
  }
  BareLoop(const BareLoop&) = delete;
  BareLoop& operator=(const BareLoop&) = delete;
  ~BareLoop() {
    dJointGroupDestroy(group_);
    dSpaceDestroy(robot_space_);
    dSpaceDestroy(environment_space_);
    dWorldDestroy(world_);
    dThreadingFreeImplementation(threading_);
  }

  void run(double seconds) {
    const bool direct = bodies_.size() <= 8;
    const long steps = std::lround(seconds / scenario_.step_s);
    const double gain = scenario_.robot.servo.gain;
    const double speed_limit = scenario_.robot.joints.front().max_speed;
    const double phase_step = 55 * std::numbers::pi / 180;
    const double amplitude = 40 * std::numbers::pi / 180;
    for (long step = 0; step < steps; ++step) {
      const double clock = 2 * std::numbers::pi * static_cast<double>(step) * scenario_.step_s;
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        const double target = amplitude * std::sin(clock + phase_step * static_cast<double>(i));
        const double speed = gain * (target - dJointGetHingeAngle(joints_[i]));
        dJointSetHingeParam(joints_[i], dParamVel, std::clamp(speed, -speed_limit, speed_limit));
      }
      dSpaceCollide2(reinterpret_cast<dGeomID>(robot_space_), reinterpret_cast<dGeomID>(environment_space_), this,
                     &BareLoop::on_near);
      if (direct) {
        dWorldStep(world_, scenario_.step_s);
      } else {
        dWorldQuickStep(world_, scenario_.step_s);
      }
      dJointGroupEmpty(group_);
    }
    mean_contacts_ = static_cast<double>(contacts_) / static_cast<double>(steps);
  }

  [[nodiscard]] double mean_contacts() const { return mean_contacts_; }

 private:
  static void on_near(void* self, dGeomID a, dGeomID b) {
    auto& loop = *static_cast<BareLoop*>(self);
    std::array<dContact, 8> contacts{};
    const int count = dCollide(a, b, 8, &contacts[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      dContact& contact = contacts[static_cast<std::size_t>(i)];
      contact.surface.mode = dContactApprox1;
      contact.surface.mu = loop.friction_;
      dJointAttach(dJointCreateContact(loop.world_, loop.group_, &contact), dGeomGetBody(a), dGeomGetBody(b));
    }
    loop.contacts_ += static_cast<std::size_t>(count);
  }

  const Scenario& scenario_;
  dThreadingImplementationID threading_;
  dWorldID world_;
  dSpaceID robot_space_;
  dSpaceID environment_space_;
  dJointGroupID group_;
  std::vector<dBodyID> bodies_;
  std::vector<dJointID> joints_;
  double friction_ = 0.0;
  double mean_contacts_ = 0.0;
  std::size_t contacts_ = 0;
};

double time_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void print_ratio(const char* name, std::vector<double> ratios, const char* wanted) {
  std::printf("ratio %s / bare: median %.3f, %.3f to %.3f   (wanted: at most %s)\n", name, median(ratios),
              *std::min_element(ratios.begin(), ratios.end()), *std::max_element(ratios.begin(), ratios.end()), wanted);
}

int benchmark(const Scenario& scenario, double seconds, int repetitions) {
  std::vector<double> bare_times;
  std::vector<double> simulate_times;
  std::vector<double> hil_times;
  std::vector<double> simulate_ratios;
  std::vector<double> hil_ratios;
  BusStatistics bus;
  double bare_contacts = 0.0;
  double simulate_contacts = 0.0;
  double displacement = 0.0;
  for (int i = 0; i <= repetitions; ++i) {
    const double bare = time_of([&] {
      BareLoop loop(scenario);
      loop.run(seconds);
      bare_contacts = loop.mean_contacts();
    });
    const double simulated = time_of([&] {
      Simulation simulation(scenario);
      while (simulation.time_s() < seconds - 1e-9) {
        simulation.advance();
      }
      simulate_contacts = simulation.plant().mean_contacts();
      displacement = simulation.plant().displacement();
    });
    // Includes the set-up. A difference from the gait in memory would make the time worthless.
    const double in_the_loop = time_of([&] {
      HardwareLoop loop(scenario, {});
      while (loop.time_s() < seconds - 1e-9) {
        loop.advance();
      }
      if (loop.differences() != 0) {
        throw std::runtime_error("the modules differ from the gait in memory");
      }
      bus = loop.bus_statistics();
    });
    if (i > 0) {  // the first round warms up
      bare_times.push_back(bare);
      simulate_times.push_back(simulated);
      hil_times.push_back(in_the_loop);
      simulate_ratios.push_back(simulated / bare);
      hil_ratios.push_back(in_the_loop / bare);
    }
  }
  std::printf("%zu links, %.0f s at %.0f us a step, %d repetitions, medians\n", scenario.robot.links.size(), seconds,
              scenario.step_s * 1e6, repetitions);
  std::printf("                   wall s   x real time   contacts\n");
  std::printf("bare engine loop   %6.3f   %11.1f   %8.2f\n", median(bare_times), seconds / median(bare_times),
              bare_contacts);
  std::printf("simulate           %6.3f   %11.1f   %8.2f   displacement %.3f m\n", median(simulate_times),
              seconds / median(simulate_times), simulate_contacts, displacement);
  std::printf("hil, native        %6.3f   %11.1f              %llu frames, %.1f %% bus load\n", median(hil_times),
              seconds / median(hil_times), static_cast<unsigned long long>(bus.frames), 100 * bus.load());
  print_ratio("simulate", simulate_ratios, "1.05");
  print_ratio("hil", hil_ratios, "2.2");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("bench_simulate: found no scenario, expected SCENARIO [SECONDS] [REPETITIONS]\n", stderr);
    return 2;
  }
  try {
    DiskFiles files;
    const Scenario scenario = read_scenario(argv[1], files);
    const double seconds = argc > 2 ? std::atof(argv[2]) : 30.0;
    const int repetitions = argc > 3 ? std::atoi(argv[3]) : 9;
    return benchmark(scenario, seconds > 0 ? seconds : 30.0, repetitions > 0 ? repetitions : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_simulate: %s\n", error.what());
    return 2;
  }
}
