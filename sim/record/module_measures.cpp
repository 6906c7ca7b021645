#include "sim/record/module_measures.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/measure/gait_meter.hpp"
#include "sim/robot/servo.hpp"

namespace proleg::sim {
namespace {

constexpr std::array of_currents{Measure::electrical_energy, Measure::mean_current};
constexpr std::array of_contacts{Measure::duty_factor, Measure::lifted_links};
constexpr std::array of_commands{Measure::stride_frequency, Measure::wave_count, Measure::predicted_distance};

constexpr auto of_modules = [] {
  std::array<Measure, of_currents.size() + of_contacts.size() + of_commands.size()> all{};
  auto end = std::ranges::copy(of_currents, all.begin()).out;
  end = std::ranges::copy(of_contacts, end).out;
  std::ranges::copy(of_commands, end);
  return all;
}();

}  // namespace

std::span<const Measure> measures_of_modules() { return of_modules; }

bool is_sensed_by_modules(Measure measure) {
  return std::ranges::count(of_currents, measure) + std::ranges::count(of_contacts, measure) > 0;
}

MeasureValues measure_modules(const Recording& recording, const Scenario& scenario) {
  if (recording.joints().size() != scenario.robot.joints.size() ||
      recording.links().size() != scenario.robot.links.size()) {
    throw InputError(recording.path().string(), 0, "the recording of another robot", "that of " + scenario.path);
  }
  const double tick_s = recording.tick_period_us() * 1e-6;
  // What it computes from the path of the robot, which the recording does not have, is not used.
  GaitMeter meter(scenario.robot, scenario.environment, Eigen::Vector3d::Zero(), scenario.step_s, tick_s);
  double current_sum_ma = 0.0;
  double ticks = 0.0;
  bool was_touched = false;
  std::vector<double> targets(scenario.robot.joints.size());
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const RecordedTick& tick) {
    current_sum_ma = std::accumulate(tick.servo_currents.begin(), tick.servo_currents.end(), current_sum_ma);
    was_touched =
        was_touched || std::ranges::any_of(tick.latched_contacts, [](std::uint8_t bits) { return bits != 0; });
    std::ranges::transform(tick.servo_commands, targets.begin(), servo_target);
    meter.add_tick({.center_of_mass = Eigen::Vector3d::Zero(),
                    .link_poses = tick.link_poses,
                    .joint_angles = tick.joint_angles,
                    .joint_targets = targets,
                    .setpoints = {},
                    .link_contacts = tick.latched_contacts});
    ticks += 1.0;
  });
  const MeasureValues all = meter.values();
  MeasureValues values;
  for (const Measure measure : of_commands) {
    values[measure] = all[measure];
  }
  if (was_touched) {
    for (const Measure measure : of_contacts) {
      values[measure] = all[measure];
    }
  }
  if (current_sum_ma > 0.0) {
    values[Measure::electrical_energy] = current_sum_ma * 1e-3 * servo_supply_v * tick_s;
    values[Measure::mean_current] = current_sum_ma / (ticks * static_cast<double>(targets.size()));
  }
  return values;
}

}  // namespace proleg::sim
