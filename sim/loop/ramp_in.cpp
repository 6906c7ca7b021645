#include "sim/loop/ramp_in.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "shared/kernel/servo_pulses.hpp"

namespace proleg::sim {

void ramp_in(const Scenario& scenario, const Plant& plant, PulsePlayer& player,
             std::span<const ServoPulse> first_pulses) {
  const std::uint32_t tick_us = scenario.kernel.tick_period_us;
  const std::int32_t step =
      std::max(1, static_cast<std::int32_t>(servo_quarter_turn * std::uint64_t{tick_us} / 1'000'000));
  const std::uint32_t resting_ticks = 500'000 / tick_us;
  std::vector<std::int32_t> goals(plant.servo_commands().begin(), plant.servo_commands().end());
  for (std::size_t i = std::min(first_pulses.size(), goals.size()); i-- > 0;) {
    goals[first_pulses[i].joint] = first_pulses[i].command;
  }
  std::vector<std::int32_t> commands(plant.servo_commands().begin(), plant.servo_commands().end());
  std::vector<ServoPulse> pulses(goals.size());
  for (std::uint32_t rested = 0; rested < resting_ticks; rested += commands == goals ? 1U : 0U) {
    for (std::uint32_t joint = 0; joint < goals.size(); ++joint) {
      commands[joint] = std::clamp(goals[joint], commands[joint] - step, commands[joint] + step);
      pulses[joint] = {0, joint, commands[joint]};
    }
    player.advance(0, pulses);
  }
}

}  // namespace proleg::sim
