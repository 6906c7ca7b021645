#pragma once

// A small robot with made-up motion for recordings. The same functions give the expected values, from the tick alone.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sim/record/recorder.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::sim {

/// Three joints (J3, J2, J1 from the head), four links; a sine on all joints and direct access on the last; one
/// amplitude that is not the default, one commit at tick 5, one distortion at tick 7.
[[nodiscard]] Scenario small_scenario();

// Made-up measurements at SYNC tick + 1.
[[nodiscard]] double made_up_angle(std::uint32_t tick, std::size_t joint);
[[nodiscard]] double made_up_torque(std::uint32_t tick, std::size_t joint);
[[nodiscard]] double made_up_current(std::uint32_t tick, std::size_t joint);
[[nodiscard]] double made_up_contact_force(std::uint32_t tick, std::size_t link);
[[nodiscard]] Pose made_up_pose(std::uint32_t tick, std::size_t link);
/// The last pulse before SYNC tick + 1.
[[nodiscard]] std::int32_t made_up_command(std::uint32_t tick, std::size_t joint);
/// Two for each joint, the later one that of made_up_command.
[[nodiscard]] std::vector<ServoPulse> made_up_pulses(std::uint32_t tick, std::size_t joints);
/// Made-up contacts at SYNC tick.
[[nodiscard]] std::uint8_t made_up_contacts(std::uint32_t tick, std::size_t link);

/// Runs the kernel of a scenario as the simulator does, with changes and contacts, and calls `use` for each tick.
void run_small(const Scenario& scenario, std::uint32_t ticks,
               const std::function<void(const TickSample& sample, const Change* change)>& use);

/// Runs a scenario into a new recording and finishes it.
void record_small(const std::filesystem::path& path, const Scenario& scenario, std::uint32_t ticks);

}  // namespace proleg::sim
