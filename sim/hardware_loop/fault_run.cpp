#include "sim/hardware_loop/fault_run.hpp"

#include <algorithm>
#include <utility>

#include "sim/physics/physics_error.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t end_count = static_cast<std::size_t>(JointEnd::unsafe) + 1;

void take_worse(MotionWatch::Worst& worst, const MotionWatch::Worst& other) {
  worst.change_steps = std::max(worst.change_steps, other.change_steps);
  worst.beyond_limit_deg = std::max(worst.beyond_limit_deg, other.beyond_limit_deg);
  worst.motion_after_command_s = std::max(worst.motion_after_command_s, other.motion_after_command_s);
}

}  // namespace

FaultRunResult run_with_faults(const Scenario& scenario, const FaultSchedule& schedule, std::uint32_t ticks,
                               const std::function<std::unique_ptr<JointModule>(const ModuleParts&)>& make_module,
                               std::uint32_t start_time_us) {
  HardwareOptions options;
  options.faults = schedule;
  options.make_module = make_module;
  options.start_time_us = start_time_us;
  HardwareLoop loop(scenario, std::move(options));
  FaultRunResult result;
  try {
    while (loop.tick() < ticks) {
      loop.advance();
    }
  } catch (const PhysicsError& error) {
    result.violations.emplace_back(error.what());
  } catch (const HardwareError& error) {
    result.violations.emplace_back(error.what());
  }
  loop.finish_watch();
  const MotionWatch& watch = loop.motion_watch();
  result.ends = watch.ends();
  std::ranges::copy(watch.violations(), std::back_inserter(result.violations));
  for (const ModuleProblem& problem : loop.problems()) {
    if (problem.leaves_model) {
      result.violations.push_back(scenario.robot.joints[problem.joint].name + " " + problem.text);
    }
  }
  if (const auto& difference = loop.first_difference()) {
    result.violations.push_back(describe(*difference, scenario.robot.joints[difference->joint].name));
  }
  result.worst = watch.worst();
  result.setpoint_hash = loop.setpoint_hash().hex();
  result.servo_hash = loop.servo_hash().hex();
  return result;
}

bool can_play_natively(const FaultSchedule& schedule) {
  constexpr std::uint32_t tenth = 429'496'730;  // of 2^32
  return std::ranges::none_of(schedule, [](const Fault& fault) {
    return declaration_of(fault.kind).needs_chip || (fault.kind == FaultKind::corrupt && fault.amount > tenth);
  });
}

FaultStatistics::FaultStatistics() : faults_of_kind(fault_declarations().size()), joints_ended(end_count) {}

void FaultStatistics::add(const FaultSchedule& schedule, const FaultRunResult& result) {
  ++runs;
  for (const Fault& fault : schedule) {
    ++faults;
    ++faults_of_kind[static_cast<std::size_t>(fault.kind)];
  }
  for (const JointEnd end : result.ends) {
    ++joints_ended[static_cast<std::size_t>(end)];
  }
  broken_runs += result.violations.empty() ? 0U : 1U;
  take_worse(worst, result.worst);
}

}  // namespace proleg::sim
