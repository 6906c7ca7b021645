#include "tests/bench/mujoco/mujoco_evaluation.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/computer/hash/value_hash.hpp"
#include "shared/kernel/servo_command.hpp"
#include "shared/kernel/servo_schedule.hpp"
#include "sim/loop/kernel_chain.hpp"
#include "sim/loop/servo_pulses.hpp"
#include "sim/robot/servo.hpp"
#include "tests/bench/mujoco/mujoco_world.hpp"

namespace proleg::bench {

Evaluation evaluate_in_mujoco(const sim::Scenario& scenario, const Workload& workload, const mjModel& model) {
  const std::size_t joints = scenario.robot.joints.size();
  sim::KernelChain chain(scenario.kernel, scenario.joint_limits, scenario.settings);
  sim::ServoPulses pulse_source({scenario.robot.servo.period_us, workload.tick_us}, scenario.joint_limits,
                                scenario.robot.servo.command_speed);
  const std::vector<std::uint8_t> no_contacts(joints);
  std::vector<std::int32_t> commands(joints, servo_center);
  std::vector<sim::ServoPulse> pulses;
  ValueHash hash;
  MujocoWorld world(model);
  const Eigen::Vector3d start = world.center_of_mass();
  std::uint64_t contacts = 0;
  std::size_t taken = 0;
  for (std::uint32_t step = 0; step < workload.steps; ++step) {
    const std::uint64_t now_us = std::uint64_t{step} * workload.step_us;
    if (now_us % workload.tick_us == 0) {
      chain.advance(no_contacts);
      pulses.erase(pulses.begin(), pulses.begin() + static_cast<std::ptrdiff_t>(taken));
      taken = 0;
      const std::size_t waiting = pulses.size();
      pulse_source.append(chain, pulses);
      for (std::size_t i = waiting; i < pulses.size(); ++i) {
        hash.append(pulses[i].command);
      }
    }
    for (; taken < pulses.size() && pulses[taken].time_us <= now_us; ++taken) {
      commands[pulses[taken].joint] = pulses[taken].command;
    }
    for (std::size_t joint = 0; joint < joints; ++joint) {
      world.set_joint_speed(joint, sim::servo_speed(scenario.robot.servo, scenario.robot.joints[joint], commands[joint],
                                                    world.joint_angle(joint)));
    }
    world.step();
    contacts += world.contact_count();
  }
  return {(world.center_of_mass() - start).head<2>().norm(), static_cast<double>(contacts) / workload.steps,
          hash.hex()};
}

}  // namespace proleg::bench
