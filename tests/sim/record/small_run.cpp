#include "small_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "shared/fixed/decimal.hpp"
#include "shared/gait/registry.hpp"
#include "shared/kernel/kernel.hpp"

namespace proleg::sim {
namespace {

std::uint8_t index_of_parameter(const ActuationModule& algorithm, std::string_view name) {
  return static_cast<std::uint8_t>(find_parameter(algorithm.declaration(), name));
}

std::vector<std::int32_t> internal_values(const Kernel& kernel) {
  std::vector<std::int32_t> values;
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    for (unsigned joint = 0; joint < kernel.local_joint_count(); ++joint) {
      const ActuationModule* algorithm = kernel.configuration().slots[slot].algorithm;
      for (unsigned i = 0; kernel.drives(slot, joint) && i < algorithm->declaration().internal_values.size(); ++i) {
        values.push_back(kernel.internal_value(slot, joint, i));
      }
    }
  }
  return values;
}

}  // namespace

Scenario small_scenario() {
  Scenario scenario;
  scenario.path = "some folder/small.simulation.xml";
  scenario.robot.name = "Small";
  for (const char* link : {"Head", "Link2", "Link1", "Tail"}) {
    scenario.robot.links.emplace_back().name = link;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    Joint& joint = scenario.robot.joints.emplace_back();
    joint.name = "J" + std::to_string(3 - i);
    joint.file_index = 2 - i;
  }
  scenario.joint_limits = {{-500'000'000, 600'000'000}, {-quarter_turn, quarter_turn}, {-1'000'000'000, quarter_turn}};

  const ActuationModule& sine = *find_algorithm("PatternGenerator_sinusoidal");
  const ActuationModule& direct = *find_algorithm("DirectJointAccess");
  scenario.kernel.joint_count = 3;
  scenario.kernel.seed = 18446744073709551557U;
  scenario.kernel.slots[0] = {&sine, JointMask::first(3)};
  scenario.kernel.slots[2] = {&direct, JointMask(4)};
  scenario.settings = {{0, 1, index_of_parameter(sine, "amplitude"), false, parse_decimal("12.3", Unit::degree).raw}};
  scenario.changes = {
      {5, {{2, 2, index_of_parameter(direct, "angle"), false, raw(Unit::degree, -7)}}},
      {7,
       {{0, 0, static_cast<std::uint8_t>(find_internal_value(sine.declaration(), "current_phase")), true,
         raw(Unit::phase_degree, 90)}}},
  };
  scenario.sources = {{"some folder/small.simulation.xml", "<simulation/>\n"}, {"robot.xml", "tab\there \"quoted\"\n"}};
  return scenario;
}

double made_up_angle(std::uint32_t tick, std::size_t joint) {
  return 0.7 * std::sin(0.06 * tick + static_cast<double>(joint));
}

double made_up_torque(std::uint32_t tick, std::size_t joint) {
  return 0.4 * std::cos(0.05 * tick - static_cast<double>(joint));
}

double made_up_current(std::uint32_t tick, std::size_t joint) {
  return 10.0 + tick + 0.25 * static_cast<double>(joint);
}

double made_up_contact_force(std::uint32_t tick, std::size_t link) {
  return 1.0 / (1.0 + tick) + static_cast<double>(link);
}

Pose made_up_pose(std::uint32_t tick, std::size_t link) {
  Pose pose;
  pose.position = {0.001 * tick - 0.1 * static_cast<double>(link), 0.01 * std::sin(0.05 * tick), 1.0 / 3.0};
  pose.orientation = Eigen::AngleAxisd(0.01 * tick, Eigen::Vector3d::UnitZ());
  return pose;
}

std::uint8_t made_up_contacts(std::uint32_t tick, std::size_t link) {
  return static_cast<std::uint8_t>((tick / 4 + link) % 4);
}

std::vector<ServoPulse> made_up_pulses(std::uint32_t tick, std::size_t joints) {
  std::vector<ServoPulse> pulses;
  for (const std::uint32_t half : {0U, 1U}) {
    for (std::uint32_t joint = 0; joint < joints; ++joint) {
      const std::int32_t last = made_up_command(tick, joint);
      pulses.push_back({tick * std::uint64_t{10'000} + half * 5'000, joint, half == 0 ? last - 90 : last});
    }
  }
  return pulses;
}

std::int32_t made_up_command(std::uint32_t tick, std::size_t joint) {
  return 18'000 + static_cast<std::int32_t>(tick) - 7 * static_cast<std::int32_t>(joint);
}

void run_small(const Scenario& scenario, std::uint32_t ticks,
               const std::function<void(const TickSample& sample, const Change* change)>& use) {
  const std::size_t joints = scenario.robot.joints.size();
  const std::size_t links = scenario.robot.links.size();
  std::vector<JointMemory> memory(joints);
  Kernel kernel(memory);
  ASSERT_EQ(kernel.configure(scenario.kernel, 0), Status::ok);
  for (unsigned joint = 0; joint < joints; ++joint) {
    ASSERT_EQ(kernel.set_limits(joint, scenario.joint_limits[joint].lower, scenario.joint_limits[joint].upper),
              Status::ok);
  }
  for (const Setting& setting : scenario.settings) {
    ASSERT_EQ(kernel.set_parameter(setting), Status::ok);
  }
  kernel.reset();

  std::vector<std::uint8_t> contacts(links);
  std::vector<std::int32_t> setpoints(joints);
  std::vector<std::int32_t> commands(joints);
  std::vector<double> angles(joints);
  std::vector<double> torques(joints);
  std::vector<double> currents(joints);
  std::vector<Pose> poses(links);
  std::vector<double> forces(links);
  auto next_change = scenario.changes.begin();
  for (std::uint32_t tick = 0; tick < ticks; ++tick) {
    const Change* change = nullptr;
    if (next_change != scenario.changes.end() && next_change->tick == tick) {
      change = &*next_change++;
      for (const Setting& setting : change->settings) {
        ASSERT_EQ(kernel.stage(1, setting), Status::ok);
        ASSERT_EQ(kernel.commit(1, tick), Status::ok);
      }
    }
    for (std::size_t link = 0; link < links; ++link) {
      contacts[link] = made_up_contacts(tick, link);
    }
    for (unsigned joint = 0; joint < joints; ++joint) {
      const unsigned far = joint == 0 ? contacts[0] : 0U;
      kernel.set_contacts(joint, static_cast<std::uint8_t>(contacts[joint + 1] | far << 2U));
    }
    kernel.advance();
    for (unsigned joint = 0; joint < joints; ++joint) {
      setpoints[joint] = kernel.setpoint(joint);
      commands[joint] = made_up_command(tick, joint);
      angles[joint] = made_up_angle(tick, joint);
      torques[joint] = made_up_torque(tick, joint);
      currents[joint] = made_up_current(tick, joint);
    }
    for (std::size_t link = 0; link < links; ++link) {
      poses[link] = made_up_pose(tick, link);
      forces[link] = made_up_contact_force(tick, link);
    }
    const std::vector<std::int32_t> values = internal_values(kernel);
    const std::vector<ServoPulse> pulses = made_up_pulses(tick, joints);
    use({tick, contacts, setpoints, values, pulses, commands, poses, angles, torques, currents, forces, {}}, change);
  }
}

void record_small(const std::filesystem::path& path, const Scenario& scenario, std::uint32_t ticks) {
  Recorder recorder(path, scenario, "test", "build-7");
  run_small(scenario, ticks, [&](const TickSample& sample, const Change* change) {
    if (change != nullptr) {
      recorder.record_change(*change);
    }
    recorder.record_tick(sample);
  });
  recorder.finish({{"displacement_m", "1.625"}, {"setpoint_hash", "abc"}});
}

}  // namespace proleg::sim
