#include "tools/proleg/hil/hil_report.hpp"

#include <cmath>
#include <cstdio>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {
namespace {

/// Prints the course of one run: the schedule, the events of each module with their times, and the end of each module.
void print_fault_report(const ScenarioRun& run, const HilResult& result) {
  for (const sim::Fault& fault : result.faults) {
    std::printf("fault             %s\n", describe(fault, run.scenario.robot).c_str());
  }
  for (const sim::ModuleEvent& event : result.module_events) {
    std::printf("%10.4f s      %s: %s\n", event.time_s, joint_and_node(run, event.joint).c_str(), event.text.c_str());
  }
  for (std::uint32_t joint = 0; joint < result.joint_ends.size(); ++joint) {
    std::printf("ended             %s: %s\n", joint_and_node(run, joint).c_str(), describe(result.joint_ends[joint]));
  }
  std::printf("worst             %s\n", worst_values(result.worst_motion).c_str());
}

Json fault_json(const ScenarioRun& run, const HilResult& result) {
  Json faults = Json::empty_array();
  for (const sim::Fault& fault : result.faults) {
    faults.append(describe(fault, run.scenario.robot));
  }
  Json events = Json::empty_array();
  for (const sim::ModuleEvent& event : result.module_events) {
    events.append({{"time_s", event.time_s},
                   {"node", run.scenario.modules[event.joint].node},
                   {"joint", run.scenario.robot.joints[event.joint].name},
                   {"text", event.text}});
  }
  Json ends = Json::empty_array();
  for (const sim::JointEnd end : result.joint_ends) {
    ends.append(describe(end));
  }
  Json violations = Json::empty_array();
  for (const std::string& violation : result.violations) {
    violations.append(violation);
  }
  return {{"schedule", faults},
          {"events", events},
          {"joints_ended", ends},
          {"violations", violations},
          {"worst", worst_object(result.worst_motion)}};
}

}  // namespace

std::string worst_values(const sim::MotionWatch::Worst& worst) {
  std::string text =
      "change between pulses " + number_text(worst.change_steps) + " of what the greatest speed allows; ";
  text += number_text(std::abs(worst.beyond_limit_deg)) + " deg " +
          (worst.beyond_limit_deg > 0.0 ? "beyond" : "inside") + " the limits; motion " +
          number_text(worst.motion_after_command_s) + " of 1.5 s after the last command";
  return text;
}

Json worst_object(const sim::MotionWatch::Worst& worst) {
  return {{"change_of_allowed", worst.change_steps},
          {"beyond_limit_deg", worst.beyond_limit_deg},
          {"motion_after_command_s", worst.motion_after_command_s}};
}

std::string joint_and_node(const ScenarioRun& run, std::uint32_t joint) {
  return run.scenario.robot.joints[joint].name + " (node " + std::to_string(run.scenario.modules[joint].node) + ")";
}

std::string list_dropped_changes(const HilResult& result) {
  std::vector<std::string> ticks;
  for (const std::uint32_t tick : result.dropped_changes) {
    ticks.push_back(std::to_string(tick));
  }
  return listed(ticks);
}

Json hil_json(const HilOptions& options, const ScenarioRun& run, const HilModules& modules, const HilResult& result) {
  Json restarts = Json::empty_array();
  for (const RestartReport& restart : result.restarts) {
    restarts.append({{"node", restart.node},
                     {"joint", restart.joint},
                     {"tick", restart.tick},
                     {"joined_tick", restart.joined_tick}});
  }
  Json dropped_changes = Json::empty_array();
  for (const std::uint32_t tick : result.dropped_changes) {
    dropped_changes.append(tick);
  }
  Json failures = Json::empty_array();
  for (const auto& failure : result.failures) {
    failures.append({{"node", run.scenario.modules[failure.joint].node},
                     {"joint", run.scenario.robot.joints[failure.joint].name},
                     {"tick", failure.tick}});
  }
  Json problems = Json::empty_array();
  for (const auto& problem : result.problems) {
    problems.append({{"node", run.scenario.modules[problem.joint].node},
                     {"joint", run.scenario.robot.joints[problem.joint].name},
                     {"tick", problem.tick},
                     {"text", problem.text}});
  }
  return {{"scenario", options.file},
          {"seed", run.scenario.kernel.seed},
          {"overrides", overrides_object(run.scenario.overrides)},
          {"modules", run.scenario.modules.size()},
          {"module_kind", modules.kind()},
          {"image", modules.any_virtual() ? modules.image().file().string() : ""},
          {"displacement_m", result.displacement_m},
          {"simulated_s", result.simulated_s},
          {"setpoint_hash", result.setpoint_hash},
          {"servo_hash", result.servo_hash},
          {"world_hash", result.world_hash},
          {"motion_hash", result.motion_hash},
          {"differences", result.differences},
          {"first_difference", result.first_difference},
          {"dropped_changes", dropped_changes},
          {"failures", failures},
          {"problems", problems},
          {"instructions_per_tick", result.costliest_tick ? result.costliest_tick->cost.to_state_frame : 0},
          {"command_latency_us", durations_object(result.command_latency_ns, 1e-3)},
          {"lost_frames", result.lost_frames},
          {"frame_receptions", result.receptions},
          {"bit_errors", result.bit_errors},
          {"restarts", restarts},
          {"frames", result.frames},
          {"setup_frames", result.setup_frames},
          {"bus_load", result.bus_load},
          {"real_time_factor", result.real_time_factor()},
          {"contacts_mean", result.contacts_mean},
          {"measures", measures_object(result.measures.values)},
          {"faults", result.faults.empty() ? Json() : fault_json(run, result)},
          {"link_duty_factors", result.measures.link_duty_factors},
          {"servos", servos_array(result.measures, run.scenario.robot)},
          {"sensors", sensors_array(result.sensors)},
          {"recording", options.record.value_or("")},
          {"can_log", options.can_log.value_or("")},
          {"build_id", build_id}};
}

void print_hil_table(const HilOptions& options, const ScenarioRun& run, const HilModules& modules,
                     const HilResult& result) {
  const auto count = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf("modules           %zu %s\n", run.scenario.modules.size(), modules.kind().c_str());
  std::printf("displacement      %.4f m in %.2f s\n", result.displacement_m, result.simulated_s);
  std::printf("real-time factor  %.1f\n", result.real_time_factor());
  std::printf("bus               %llu frames, %.1f %% load; %llu frames before the start\n", count(result.frames),
              100.0 * result.bus_load, count(result.setup_frames));
  if (options.losses) {
    std::printf("lost frames       %s\n", losses_text(result.lost_frames, result.receptions).c_str());
  }
  if (options.bit_errors) {
    std::printf("bit errors        %llu frames destroyed and sent again\n", count(result.bit_errors));
  }
  if (!result.dropped_changes.empty()) {
    std::printf("dropped changes   %zu of %zu, for the ticks %s\n", result.dropped_changes.size(),
                run.scenario.changes.size(), list_dropped_changes(result).c_str());
  }
  for (const RestartReport& restart : result.restarts) {
    std::printf("restart           node %u (%s) at tick %u, %s\n", unsigned{restart.node}, restart.joint.c_str(),
                restart.tick,
                restart.joined_tick ? ("joined again at tick " + std::to_string(*restart.joined_tick)).c_str()
                                    : "has not joined again");
  }
  if (const auto& worst = result.costliest_tick) {
    std::printf("instructions      at most %llu from SYNC to the state frame (node %u, tick %u)\n",
                count(worst->cost.to_state_frame), unsigned{worst->node}, worst->cost.tick);
  }
  std::printf("servo commands    after SYNC: %s\n",
              durations_text(result.command_latency_ns, 1e-3, "us", "commands").c_str());
  for (const auto& failure : result.failures) {
    std::printf("failure           %s did not finish tick %u\n", joint_and_node(run, failure.joint).c_str(),
                failure.tick);
  }
  for (const auto& problem : result.problems) {
    std::printf("problem           %s, tick %u: %s\n", joint_and_node(run, problem.joint).c_str(), problem.tick,
                problem.text.substr(0, problem.text.find('\n')).c_str());
  }
  print_hashes(result.setpoint_hash, result.servo_hash, result.world_hash, result.motion_hash);
  std::printf(
      "differences       %llu against the gait in memory%s\n", count(result.differences),
      result.first_fault_tick
          ? (" until tick " + std::to_string(*result.first_fault_tick) + ", when the first fault begins").c_str()
          : "");
  if (!result.faults.empty()) {
    print_fault_report(run, result);
  }
  if (options.record) {
    std::printf("recording         %s\n", options.record->c_str());
  }
  if (options.can_log) {
    std::printf("CAN log           %s\n", options.can_log->c_str());
  }
  print_measures(result.measures.values, options.all_measures);
  print_sensors(result.sensors);
}

std::vector<std::pair<std::string, std::string>> hil_summary(const ScenarioRun& run, const HilResult& result) {
  std::vector<std::pair<std::string, std::string>> summary{
      {"displacement_m", exact_text(result.displacement_m)},
      {"simulated_s", exact_text(result.simulated_s)},
      {"contacts_mean", exact_text(result.contacts_mean)},
      {"differences", std::to_string(result.differences)},
      {"lost_frames", std::to_string(result.lost_frames)},
      {"dropped_changes", std::to_string(result.dropped_changes.size())},
      {"frames", std::to_string(result.frames)},
      {"bus_load", exact_text(result.bus_load)},
      {"setpoint_hash", result.setpoint_hash},
      {"servo_hash", result.servo_hash}};
  if (result.world_hash) {
    summary.emplace_back("world_hash", *result.world_hash);
  }
  summary.emplace_back("motion_hash", result.motion_hash);
  append_results(result.measures, run.scenario.robot, summary);
  append_sensors(result.sensors, summary);
  return summary;
}

}  // namespace proleg::tools
