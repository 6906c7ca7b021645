#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/hardware_loop/motion_watch.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// How a run with faults ended.
struct FaultRunResult {
  std::vector<JointEnd> ends;  ///< by joint
  /// Violations of the rules of MotionWatch, differences before the first fault, and modules that leave the model.
  std::vector<std::string> violations;
  MotionWatch::Worst worst;
  std::string setpoint_hash;
  std::string servo_hash;
};

/// Runs a scenario with faults for that many ticks. make_module: as HardwareOptions has it; null: native modules.
/// start_time_us: the same. A run that the physics ends is a violation, too. Throws InputError and HardwareError as
/// HardwareLoop's constructor.
[[nodiscard]] FaultRunResult run_with_faults(
    const Scenario& scenario, const FaultSchedule& schedule, std::uint32_t ticks,
    const std::function<std::unique_ptr<JointModule>(const ModuleParts&)>& make_module = nullptr,
    std::uint32_t start_time_us = 0);

/// Whether native modules can play all faults, with the same result as chips. On a bus that destroys more than a tenth
/// of the frames, the microseconds that a program needs decide which nodes are in bus-off, and when.
[[nodiscard]] bool can_play_natively(const FaultSchedule& schedule);

/// What many runs have in common.
struct FaultStatistics {
  std::uint32_t runs = 0;
  std::uint32_t faults = 0;
  std::vector<std::uint32_t> faults_of_kind;  ///< by FaultKind
  std::vector<std::uint32_t> joints_ended;    ///< by JointEnd
  std::uint32_t broken_runs = 0;              ///< with a violation
  MotionWatch::Worst worst;

  FaultStatistics();
  void add(const FaultSchedule& schedule, const FaultRunResult& result);
};

}  // namespace proleg::sim
