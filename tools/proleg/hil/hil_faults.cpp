#include "tools/proleg/hil/hil_faults.hpp"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/fault_run.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/hil/hil_report.hpp"

namespace proleg::tools {
namespace {

constexpr std::size_t end_count = static_cast<std::size_t>(sim::JointEnd::unsafe) + 1;

std::uint64_t run_us(const ScenarioRun& run) { return std::uint64_t{run.ticks} * run.scenario.kernel.tick_period_us; }

bool is_number(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// Parses the seed, and the count if it is present; nothing for the name of a file.
std::optional<FaultPlan> parse_seeds(const std::string& argument) {
  constexpr std::uint32_t max_runs = 1'000'000;
  const std::size_t colon = argument.find(':');
  const std::string_view first = std::string_view(argument).substr(0, colon);
  const std::string_view second = colon == std::string::npos ? "1" : std::string_view(argument).substr(colon + 1);
  if (!is_number(first) || !is_number(second)) {
    return std::nullopt;
  }
  FaultPlan plan;
  const auto seed = parse_whole<std::uint64_t>(first);
  const auto runs = parse_whole<std::uint32_t>(second);
  if (!seed || !runs || *runs == 0 || *runs > max_runs) {
    throw InputError("--faults", 0, in_quotes(argument), "FILE, SEED or SEED:COUNT, COUNT 1 to 1000000");
  }
  plan.seed = *seed;
  if (colon != std::string::npos) {
    plan.runs = *runs;
  }
  return plan;
}

/// The schedule of a seed, which depends only on the seed and the length of the run.
sim::FaultSchedule random_schedule(const ScenarioRun& run, std::uint64_t seed, bool has_chips) {
  return sim::random_faults({seed, run_us(run), has_chips}, run.scenario);
}

/// The results of a campaign.
struct Campaign {
  sim::FaultStatistics statistics;
  std::uint32_t compared = 0;   ///< schedules that native modules and the image have played
  std::uint32_t identical = 0;  ///< compared schedules with the same set-points and servo commands
  std::uint32_t different = 0;  ///< compared schedules with different ones although all faults act at ticks
};

/// Runs one schedule; prints the faults that it has found.
void run_one(const ScenarioRun& run, HilModules& modules, std::uint64_t seed, Campaign& campaign) {
  const sim::FaultSchedule schedule = random_schedule(run, seed, modules.any_virtual());
  const sim::FaultRunResult result = sim::run_with_faults(
      run.scenario, schedule, run.ticks, [&](const sim::ModuleParts& parts) { return modules.make(parts); },
      modules.start_time_us());
  campaign.statistics.add(schedule, result);
  std::vector<std::string> found = result.violations;
  if (modules.any_virtual() && sim::can_play_natively(schedule)) {
    const sim::FaultRunResult native =
        sim::run_with_faults(run.scenario, schedule, run.ticks, nullptr, modules.start_time_us());
    ++campaign.compared;
    if (native.setpoint_hash == result.setpoint_hash && native.servo_hash == result.servo_hash) {
      ++campaign.identical;
    } else if (sim::act_at_ticks(schedule, run.scenario.kernel.tick_period_us)) {
      ++campaign.different;
      found.emplace_back("the image and native modules have different set-points or servo commands");
    }
  }
  for (const std::string& text : found) {
    std::cerr << "proleg hil: seed " << seed << ": " << text << '\n';
  }
  if (!found.empty()) {
    std::cerr << sim::faults_text(schedule, run.scenario.robot);
  }
}

Json campaign_json(const HilOptions& options, const ScenarioRun& run, const HilModules& modules, const FaultPlan& plan,
                   const Campaign& campaign) {
  Json kinds = Json::empty_object();
  for (const sim::FaultDeclaration& kind : sim::fault_declarations()) {
    kinds.add(std::string(kind.name), campaign.statistics.faults_of_kind[static_cast<std::size_t>(kind.kind)]);
  }
  Json ends = Json::empty_object();
  for (std::size_t end = 0; end < end_count; ++end) {
    ends.add(describe(static_cast<sim::JointEnd>(end)), campaign.statistics.joints_ended[end]);
  }
  return {{"scenario", options.file},
          {"modules", run.scenario.modules.size()},
          {"module_kind", modules.kind()},
          {"first_seed", plan.seed},
          {"runs", campaign.statistics.runs},
          {"run_s", run.scenario.duration_s},
          {"faults", campaign.statistics.faults},
          {"faults_of_kind", kinds},
          {"joints_ended", ends},
          {"broken_runs", campaign.statistics.broken_runs},
          {"compared_with_native", campaign.compared},
          {"identical_to_native", campaign.identical},
          {"different_from_native", campaign.different},
          {"worst", worst_object(campaign.statistics.worst)},
          {"build_id", build_id}};
}

void print_campaign(const ScenarioRun& run, const HilModules& modules, const Campaign& campaign) {
  const sim::FaultStatistics& statistics = campaign.statistics;
  std::printf("modules           %zu %s\n", run.scenario.modules.size(), modules.kind().c_str());
  std::printf("schedules         %u of %s, with %u faults\n", statistics.runs, sim::time_word(run_us(run)).c_str(),
              statistics.faults);
  std::string kinds;
  for (const sim::FaultDeclaration& kind : sim::fault_declarations()) {
    const std::uint32_t count = statistics.faults_of_kind[static_cast<std::size_t>(kind.kind)];
    kinds += (kinds.empty() ? "" : ", ") + std::to_string(count) + " " + std::string(kind.name);
  }
  std::printf("faults            %s\n", kinds.c_str());
  std::string ends;
  for (std::size_t end = 0; end < end_count; ++end) {
    ends += (end == 0 ? "" : ", ") + std::to_string(statistics.joints_ended[end]) + " " +
            describe(static_cast<sim::JointEnd>(end));
  }
  std::printf("joints ended in   %s\n", ends.c_str());
  std::printf("worst             %s\n", worst_values(statistics.worst).c_str());
  std::printf("broken rules      in %u schedules\n", statistics.broken_runs);
  if (modules.any_virtual()) {
    std::printf(
        "identity          %u schedules with native modules too: %u identical, %u different although their "
        "faults act at ticks\n",
        campaign.compared, campaign.identical, campaign.different);
  }
}

}  // namespace

FaultPlan read_fault_plan(const HilOptions& options, const ScenarioRun& run, bool any_virtual) {
  if (!options.faults) {
    return {};
  }
  std::optional<FaultPlan> plan = parse_seeds(*options.faults);
  if (!plan) {
    FaultPlan from_file;
    from_file.schedule = sim::read_faults(*options.faults, run.scenario.robot, run_us(run));
    return from_file;
  }
  if (run_us(run) < sim::min_random_run_us) {
    throw InputError("--faults", 0, "a run of " + sim::time_word(run_us(run)),
                     "at least " + sim::time_word(sim::min_random_run_us) + " for random faults");
  }
  if (!plan->runs) {
    plan->schedule = random_schedule(run, plan->seed, any_virtual);
  }
  return *plan;
}

void warn_of_faults_without_effect(const sim::FaultSchedule& schedule, const ScenarioRun& run,
                                   const HilModules& modules) {
  for (const sim::Fault& fault : schedule) {
    if (fault.joint && sim::declaration_of(fault.kind).needs_chip && !modules.is_virtual(*fault.joint)) {
      print_warning("proleg hil", "--faults: found " + in_quotes(describe(fault, run.scenario.robot)) +
                                      ", which a native module cannot play; it has no effect without --modules mcu");
    }
  }
}

int run_fault_campaign(const HilOptions& options, const ScenarioRun& run, HilModules& modules, const FaultPlan& plan) {
  Campaign campaign;
  {
    CountProgress progress("schedules", *plan.runs);
    for (std::uint32_t i = 0; i < *plan.runs && !interrupted(); ++i) {
      run_one(run, modules, plan.seed + i, campaign);
      progress.show(i + 1);
    }
  }
  if (options.json) {
    std::cout << campaign_json(options, run, modules, plan, campaign).text() << '\n';
  } else {
    print_campaign(run, modules, campaign);
  }
  std::cout.flush();
  const bool is_good = campaign.statistics.broken_runs == 0 && campaign.different == 0 && !interrupted();
  return is_good ? exit_success : exit_failed;
}

}  // namespace proleg::tools
