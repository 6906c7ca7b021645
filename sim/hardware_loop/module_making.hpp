#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/module/module.hpp"
#include "sim/hardware_loop/crystal.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The crystal of a joint's module: off by up to error_ppm, by an amount that follows from the scenario's seed.
[[nodiscard]] Crystal make_crystal(const Scenario& scenario, std::size_t joint, std::uint32_t error_ppm);

/// The identity of a joint's module: its node id; a unique id that follows from the scenario's seed, or has the serial
/// number that the robot's file names; this program's core; a feedback potentiometer.
[[nodiscard]] firmware::ModuleIdentity make_identity(const Scenario& scenario, std::size_t joint);

}  // namespace proleg::sim
