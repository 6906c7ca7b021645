// proleg hil: hardware in the loop. The joints' own programs on a simulated CAN bus move the simulated robot.

#include <chrono>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/bus/candump_log.hpp"
#include "sim/loop/hardware_loop.hpp"
#include "sim/physics/physics_error.hpp"
#include "tools/proleg/build_id.hpp"
#include "tools/proleg/command_line.hpp"
#include "tools/proleg/hil_modules.hpp"
#include "tools/proleg/json_output.hpp"
#include "tools/proleg/progress.hpp"
#include "tools/proleg/run_measures.hpp"
#include "tools/proleg/scenario_run.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct Options : ScenarioOptions, ModuleOptions {
  std::vector<std::string> resets;
  std::vector<std::string> frames;
  std::optional<std::string> bit_errors;
  std::optional<std::string> can_log;
};

struct RestartReport {
  std::uint8_t node;
  std::string joint;
  std::uint32_t tick;
  std::optional<std::uint32_t> joined_tick;
};

struct Result {
  std::uint32_t ticks = 0;
  double simulated_s = 0.0;
  double wall_s = 0.0;
  double displacement_m = 0.0;
  double contacts_mean = 0.0;
  std::uint64_t differences = 0;
  std::string first_difference;
  std::uint64_t lost_frames = 0;
  std::uint64_t bit_errors = 0;
  std::uint64_t frames = 0;
  std::uint64_t setup_frames = 0;
  double bus_load = 0.0;
  std::string setpoint_hash;
  std::string servo_hash;
  std::vector<RestartReport> restarts;
  std::vector<sim::HardwareLoop::Failure> failures;
  std::vector<sim::HardwareLoop::Problem> problems;
  std::optional<HilModules::Costliest> costliest_tick;
  RunMeasures measures;

  [[nodiscard]] double real_time_factor() const { return simulated_s / wall_s; }
};

/// NODE@TICK
sim::Restart parse_reset(const std::string& word, const ScenarioRun& run) {
  const std::size_t at = word.find('@');
  const auto node = parse_whole<std::uint32_t>(std::string_view(word).substr(0, at));
  const auto tick =
      at == std::string::npos ? std::nullopt : parse_whole<std::uint32_t>(std::string_view(word).substr(at + 1));
  if (!node || !tick) {
    throw InputError("--reset", 0, in_quotes(shortened(word)), "NODE@TICK");
  }
  if (*tick == 0 || *tick >= run.ticks) {
    throw InputError("--reset", 0, "tick " + std::to_string(*tick),
                     "a tick of the run, 1 to " + std::to_string(run.ticks - 1));
  }
  const unsigned joint = joint_of_node(run.scenario, node, "--reset", std::to_string(*node));
  if (joint == sim::HardwareLoop::sync_producer) {
    throw InputError("--reset", 0, "node " + std::to_string(*node) + ", which produces the SYNC",
                     "another one: without SYNC the robot stops");
  }
  return {*tick, joint};
}

std::vector<sim::Restart> parse_resets(const Options& options, const ScenarioRun& run) {
  std::vector<sim::Restart> restarts;
  for (const std::string& word : options.resets) {
    restarts.push_back(parse_reset(word, run));
  }
  std::ranges::stable_sort(restarts, {}, &sim::Restart::tick);
  return restarts;
}

/// ID#DATA@TICK: the frame as cansend of can-utils takes it.
sim::InjectedFrame parse_frame(const std::string& word, const ScenarioRun& run) {
  const auto refuse = [&word] {
    throw InputError("--send", 0, in_quotes(shortened(word)),
                     "ID#DATA@TICK: three hexadecimal digits up to 7FF, up to 8 bytes, a tick; for example "
                     "603#4018100100000000@100");
  };
  const std::size_t hash = word.find('#');
  const std::size_t at = word.find('@');
  if (hash != 3 || at == std::string::npos || at < hash) {
    refuse();
  }
  const auto tick = parse_whole<std::uint32_t>(std::string_view(word).substr(at + 1));
  const auto identifier = parse_whole<std::uint16_t>(std::string_view(word).substr(0, hash), 16);
  const std::string_view data = std::string_view(word).substr(hash + 1, at - hash - 1);
  if (!tick || !identifier || *identifier > CanFrame::max_identifier || data.size() % 2 != 0 ||
      data.size() > 2 * CanFrame::max_length) {
    refuse();
  }
  sim::InjectedFrame injected{*tick, {*identifier, static_cast<std::uint8_t>(data.size() / 2), {}}};
  for (std::size_t i = 0; i < data.size() / 2; ++i) {
    const auto byte = parse_whole<std::uint8_t>(data.substr(2 * i, 2), 16);
    if (!byte) {
      refuse();
    }
    injected.frame.data[i] = *byte;
  }
  if (*tick >= run.ticks) {
    throw InputError("--send", 0, "tick " + std::to_string(*tick),
                     "a tick of the run, 0 to " + std::to_string(run.ticks - 1));
  }
  return injected;
}

std::vector<sim::InjectedFrame> parse_frames(const Options& options, const ScenarioRun& run) {
  std::vector<sim::InjectedFrame> frames;
  for (const std::string& word : options.frames) {
    frames.push_back(parse_frame(word, run));
  }
  std::ranges::stable_sort(frames, {}, &sim::InjectedFrame::tick);
  return frames;
}

/// SEED:RATE
sim::HardwareOptions::BitErrors parse_bit_errors(const std::string& word) {
  const std::size_t colon = word.find(':');
  const auto seed = parse_whole<std::uint64_t>(std::string_view(word).substr(0, colon));
  const auto rate = colon == std::string::npos ? std::nullopt : parse_rate(std::string_view(word).substr(colon + 1));
  if (!seed || !rate) {
    throw InputError("--bit-errors", 0, in_quotes(shortened(word)), "SEED:RATE, for example 7:1%");
  }
  return {*seed, *rate};
}

std::string joint_name(const ScenarioRun& setup, std::uint32_t joint) {
  return setup.scenario.robot.joints[joint].name + " (node " + std::to_string(setup.scenario.modules[joint].node) + ")";
}

Result run(const ScenarioRun& setup, const HilModules& modules, sim::HardwareOptions hardware,
           sim::Recorder* recorder) {
  sim::HardwareLoop loop(setup.scenario, std::move(hardware));
  Progress progress("in the loop", "s", setup.scenario.duration_s);
  Result result;
  const auto start = std::chrono::steady_clock::now();
  while (loop.tick() < setup.ticks && !interrupted()) {
    const sim::Change* change = loop.advance();
    const std::uint32_t tick = loop.tick() - 1;
    for (const auto& event : loop.restart_events()) {
      if (recorder != nullptr) {
        recorder->record_restart(tick, event.joint, event.joined);
      }
      if (event.joined) {
        for (RestartReport& report : result.restarts) {
          if (report.node == setup.scenario.modules[event.joint].node && !report.joined_tick) {
            report.joined_tick = tick;
          }
        }
      } else {
        result.restarts.push_back({setup.scenario.modules[event.joint].node,
                                   setup.scenario.robot.joints[event.joint].name, tick, std::nullopt});
      }
    }
    if (recorder != nullptr) {
      if (change != nullptr) {
        recorder->record_change(*change);
      }
      recorder->record_tick(loop.sample());
    }
    progress.show(loop.time_s());
  }
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.ticks = loop.tick();
  result.simulated_s = loop.time_s();
  result.displacement_m = loop.plant().displacement();
  result.contacts_mean = loop.plant().mean_contacts();
  result.differences = loop.differences();
  if (const auto& first = loop.first_difference()) {
    result.first_difference = describe(*first, joint_name(setup, first->joint));
  }
  result.failures.assign(loop.failures().begin(), loop.failures().end());
  result.problems.assign(loop.problems().begin(), loop.problems().end());
  result.costliest_tick = modules.costliest_tick();
  result.lost_frames = loop.lost_frames();
  const sim::BusStatistics bus = loop.bus_statistics();
  result.frames = bus.frames;
  result.bit_errors = bus.errors;
  result.bus_load = bus.load();
  result.setup_frames = loop.setup_frames();
  result.setpoint_hash = loop.setpoint_hash().hex();
  result.servo_hash = loop.servo_hash().hex();
  result.measures = {loop.plant().meter().values(), loop.plant().meter().link_duty_factors()};
  return result;
}

void print_json(const Options& options, const ScenarioRun& setup, const HilModules& modules, const Result& result) {
  Json restarts = Json::empty_array();
  for (const RestartReport& restart : result.restarts) {
    restarts.append({{"node", restart.node},
                     {"joint", restart.joint},
                     {"tick", restart.tick},
                     {"joined_tick", restart.joined_tick}});
  }
  Json failures = Json::empty_array();
  for (const auto& failure : result.failures) {
    failures.append({{"node", setup.scenario.modules[failure.joint].node},
                     {"joint", setup.scenario.robot.joints[failure.joint].name},
                     {"tick", failure.tick}});
  }
  Json problems = Json::empty_array();
  for (const auto& problem : result.problems) {
    problems.append({{"node", setup.scenario.modules[problem.joint].node},
                     {"joint", setup.scenario.robot.joints[problem.joint].name},
                     {"tick", problem.tick},
                     {"text", problem.text}});
  }
  const Json object{{"scenario", options.file},
                    {"modules", setup.scenario.modules.size()},
                    {"module_kind", modules.kind()},
                    {"image", modules.any_virtual() ? modules.image().file().string() : ""},
                    {"displacement_m", result.displacement_m},
                    {"simulated_s", result.simulated_s},
                    {"setpoint_hash", result.setpoint_hash},
                    {"servo_hash", result.servo_hash},
                    {"differences", result.differences},
                    {"first_difference", result.first_difference},
                    {"failures", failures},
                    {"problems", problems},
                    {"instructions_per_tick", result.costliest_tick ? result.costliest_tick->cost.to_state_frame : 0},
                    {"lost_frames", result.lost_frames},
                    {"bit_errors", result.bit_errors},
                    {"restarts", restarts},
                    {"frames", result.frames},
                    {"setup_frames", result.setup_frames},
                    {"bus_load", result.bus_load},
                    {"real_time_factor", result.real_time_factor()},
                    {"contacts_mean", result.contacts_mean},
                    {"measures", measures_object(result.measures.values)},
                    {"link_duty_factors", result.measures.link_duty_factors},
                    {"recording", options.record.value_or("")},
                    {"can_log", options.can_log.value_or("")},
                    {"build_id", build_id}};
  std::cout << object.text() << '\n';
}

void print_table(const Options& options, const ScenarioRun& setup, const HilModules& modules, const Result& result) {
  const auto count = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf("modules           %zu %s\n", setup.scenario.modules.size(), modules.kind().c_str());
  std::printf("displacement      %.4f m in %.2f s\n", result.displacement_m, result.simulated_s);
  std::printf("real-time factor  %.1f\n", result.real_time_factor());
  std::printf("bus               %llu frames, %.1f %% load; %llu frames before the start\n", count(result.frames),
              100.0 * result.bus_load, count(result.setup_frames));
  if (options.losses) {
    std::printf("lost frames       %llu\n", count(result.lost_frames));
  }
  if (options.bit_errors) {
    std::printf("bit errors        %llu frames destroyed and sent again\n", count(result.bit_errors));
  }
  for (const RestartReport& restart : result.restarts) {
    std::printf("restart           node %u (%s) at tick %u, %s\n", unsigned{restart.node}, restart.joint.c_str(),
                restart.tick,
                restart.joined_tick ? ("back at tick " + std::to_string(*restart.joined_tick)).c_str() : "not back");
  }
  if (const auto& worst = result.costliest_tick) {
    std::printf("instructions      %llu at most from SYNC to the state frame (node %u, tick %u)\n",
                count(worst->cost.to_state_frame), unsigned{worst->node}, worst->cost.tick);
  }
  for (const auto& failure : result.failures) {
    std::printf("failure           %s was gone at the end of tick %u\n", joint_name(setup, failure.joint).c_str(),
                failure.tick);
  }
  for (const auto& problem : result.problems) {
    std::printf("problem           %s, tick %u: %s\n", joint_name(setup, problem.joint).c_str(), problem.tick,
                problem.text.substr(0, problem.text.find('\n')).c_str());
  }
  std::printf("set-point hash    %s\n", result.setpoint_hash.c_str());
  std::printf("servo hash        %s\n", result.servo_hash.c_str());
  std::printf("differences       %llu against the gait in memory\n", count(result.differences));
  if (options.record) {
    std::printf("recording         %s\n", options.record->c_str());
  }
  if (options.can_log) {
    std::printf("CAN log           %s\n", options.can_log->c_str());
  }
  print_measures(result.measures.values);
}

int hil(const Options& options) {
  const ScenarioRun setup = prepare_run(options);
  if (options.verbose) {
    print_setup(setup.scenario);
  }
  sim::HardwareOptions hardware;
  hardware.losses = &setup.losses;
  hardware.restarts = parse_resets(options, setup);
  hardware.injected = parse_frames(options, setup);
  if (options.bit_errors) {
    hardware.bit_errors = parse_bit_errors(*options.bit_errors);
  }
  hardware.notice = [](const std::string& text) { std::cerr << "proleg hil: " << text << '\n'; };
  std::optional<sim::CandumpLog> log;
  if (options.can_log) {
    if (options.can_log == options.record) {
      throw BadInput(*options.can_log + ": found twice, expected different files for --record and --can-log");
    }
    try {
      log.emplace(*options.can_log);
    } catch (const sim::CandumpLogError& error) {  // nothing has run yet: it is the name that was wrong
      throw BadInput(error.what());
    }
    hardware.trace = [&log](const sim::Transmission& transmission) {
      log->write(transmission.end, transmission.frame);
    };
  }
  HilModules modules(options, setup.scenario, {options.record.value_or(""), options.can_log.value_or("")});
  hardware.make_module = [&modules](const sim::ModuleParts& parts) { return modules.make(parts); };
  const std::unique_ptr<sim::Recorder> recorder = open_recorder(options, setup.scenario, "hil " + modules.kind());
  catch_interrupts();
  std::optional<Result> finished;
  try {
    finished = run(setup, modules, std::move(hardware), recorder.get());
  } catch (const sim::PhysicsError& error) {
    throw std::runtime_error(error.what() + kept_in_recording(options));
  }
  const Result& result = *finished;
  if (log) {
    log->finish();
  }
  if (interrupted()) {
    std::cerr << "proleg hil: interrupted after " << result.simulated_s << " s" << kept_in_recording(options) << '\n';
    return exit_failed;
  }
  if (recorder) {
    std::vector<std::pair<std::string, std::string>> summary{{"displacement_m", exact_text(result.displacement_m)},
                                                             {"simulated_s", exact_text(result.simulated_s)},
                                                             {"contacts_mean", exact_text(result.contacts_mean)},
                                                             {"differences", std::to_string(result.differences)},
                                                             {"lost_frames", std::to_string(result.lost_frames)},
                                                             {"frames", std::to_string(result.frames)},
                                                             {"bus_load", exact_text(result.bus_load)},
                                                             {"setpoint_hash", result.setpoint_hash},
                                                             {"servo_hash", result.servo_hash}};
    append_results(result.measures, setup.scenario.robot, summary);
    recorder->finish(summary);
  }
  if (options.json) {
    print_json(options, setup, modules, result);
  } else {
    print_table(options, setup, modules, result);
  }
  std::cout.flush();
  modules.finish();
  if (result.differences > 0) {
    std::cout.flush();
    std::cerr << "proleg hil: " << result.first_difference << '\n';
    return exit_failed;
  }
  constexpr std::uint32_t time_to_join_ticks = 100;
  for (const RestartReport& restart : result.restarts) {
    if (!restart.joined_tick) {
      const std::uint32_t missing = result.ticks - restart.tick;
      std::cerr << "proleg hil: node " << unsigned{restart.node} << " (" << restart.joint << ") was not back "
                << missing << " ticks after its reset, when the run ended\n";
      if (missing >= time_to_join_ticks) {
        return exit_failed;
      }
    }
  }
  return exit_success;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg hil",
      "Hardware in the loop: the joints' own programs on a simulated CAN bus move the simulated robot. Every set-point "
      "and servo command is compared with the same gait computed in memory; status 1 if one differs.");
  Options options;
  add_scenario_options(command_line, options);
  add_module_options(command_line, options);
  command_line.add_option("--reset", options.resets,
                          "NODE@TICK: restart a module in mid-gait; it rejoins. May be repeated.");
  command_line.add_option(
      "--send", options.frames,
      "ID#DATA@TICK: a frame that somebody sends on the bus right after that SYNC, hexadecimal as cansend "
      "takes it; what comes of it is in --can-log. May be repeated.");
  command_line.add_option(
      "--bit-errors", options.bit_errors,
      "SEED:RATE: frames that are destroyed on the bus and sent again, with this probability (7:1%). Nothing "
      "is lost, so nothing may differ.");
  command_line.add_option("--can-log", options.can_log,
                          "leave all frames of the bus in this file, in candump's log format");
  return command_line.run(argc, argv, [&] { return hil(options); });
}
