#pragma once

#include <span>

#include "sim/loop/plant.hpp"
#include "sim/loop/pulse_player.hpp"
#include "sim/robot/servo.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Moves simulated joints to the first pulses of a gait, as the modules of a real robot do before it: the way of each
/// servo at 90 degrees a second, and half a second at rest. These ticks are in no recording.
void ramp_in(const Scenario& scenario, const Plant& plant, PulsePlayer& player,
             std::span<const ServoPulse> first_pulses);

}  // namespace proleg::sim
