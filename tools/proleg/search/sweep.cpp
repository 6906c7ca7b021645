// proleg sweep: runs a scenario with all combinations of some values.

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/experiment/trials.hpp"
#include "sim/optimize/sweep/sweep.hpp"
#include "sim/scenario/overrides.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/search/sweep_claim.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
using optimize::Sweep;
using optimize::SweepGroup;
using optimize::SweepRun;
using optimize::SweptQuantity;

struct SweepOptions {
  ScenarioOptions scenario;
  std::vector<std::string> over;
  std::string measure = "distance";
  std::optional<std::string> workers;
  std::optional<std::string> out;
  std::optional<std::string> resume;
  bool json = false;
};

struct SweepResult {
  std::vector<SweepRun> runs;
  std::vector<SweepGroup> groups;
  std::vector<std::filesystem::path> files;
  std::uint64_t failed = 0;
  const SweepRun* first_failure = nullptr;  ///< first failed run, in the order of the combinations
  std::uint64_t limited = 0;                ///< runs whose servos cannot follow the gait
  const SweepRun* worst_limited = nullptr;  ///< run with the largest difference between an angle and that of its pulse
  std::uint64_t resumed = 0;                ///< runs of the interrupted sweep
  std::uint32_t workers = 0;
  double wall_s = 0.0;
  bool is_stopped = false;  ///< by Control-C or by another program
};

sim::Measure read_measure(const std::string& name) {
  if (const auto measure = sim::find_measure(name)) {
    return *measure;
  }
  throw InputError("--measure", 0, in_quotes(name), "one of " + listed(sim::measure_names()));
}

constexpr std::array<std::string_view, 3> result_files{optimize::sweep_table_name, "summary.tsv", "sweep.svg"};

/// The table of all runs. It gets a line when a run ends, so a process that is killed loses no other run.
class GrowingTable {
 public:
  /// exists: the file has a head and these runs; else it is created with the first run.
  GrowingTable(const Sweep& sweep, std::filesystem::path path, bool exists, std::size_t runs)
      : sweep_(sweep), path_(std::move(path)), has_head_(exists), written_(runs) {}

  /// runs: all, the new ones last.
  void add(std::span<const SweepRun> runs) {
    for (; written_ < runs.size(); ++written_) {
      append((has_head_ ? std::string() : optimize::sweep_head(sweep_, result_key)) +
             optimize::sweep_line(sweep_, runs[written_]));
      has_head_ = true;
    }
  }

 private:
  void append(const std::string& text) const {
    std::ofstream stream(path_, std::ios::binary | std::ios::app);
    if (!(stream << text << std::flush)) {
      throw FileError(path_, std::string("cannot be written: ") + std::strerror(errno) +
                                 "; all runs until now are kept, `--resume` goes on");
    }
  }

  const Sweep& sweep_;
  std::filesystem::path path_;
  bool has_head_;
  std::size_t written_;
};

/// The folder of the results.
std::filesystem::path result_folder(const SweepOptions& options) {
  const std::string file = std::filesystem::path(options.scenario.file).filename().string();
  std::filesystem::path folder =
      chosen_folder(options.out, options.resume, file.substr(0, file.find('.')) + "_sweep", "sweep");
  check_result_folder(folder, {});
  return folder;
}

/// Refuses the files of an earlier sweep.
void require_no_results(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder / result_files[0])) {
    throw BadInput((folder / result_files[0]).string() +
                   ": found an existing file, expected none; --out FOLDER names another folder, --resume " +
                   folder.string() + " continues a sweep that was interrupted");
  }
  check_result_folder(folder, result_files);
}

/// The runs of the sweep that is resumed. Removes the line that was being written.
std::vector<SweepRun> interrupted_runs(const Sweep& sweep, const std::filesystem::path& table) {
  if (const auto found = found_instead_of_file(table)) {
    throw InputError(table.string(), 0, *found, "the table of an interrupted sweep; there is nothing to resume");
  }
  const std::string text = read_whole_file(table);
  std::vector<SweepRun> runs = optimize::read_sweep_table(sweep, result_key, table.string(), text);
  std::filesystem::resize_file(table, text.rfind('\n') + 1);
  return runs;
}

/// Warns if several seeds give equal runs because the gait has no noise.
void warn_of_equal_runs(const Sweep& sweep) {
  for (const SweptQuantity& quantity : sweep.quantities) {
    if (quantity.name.find("noise") != std::string::npos) {
      return;
    }
  }
  for (const SweptQuantity& quantity : sweep.quantities) {
    if (quantity.kind == SweptQuantity::Kind::seed && quantity.values.size() > 1 &&
        !optimize::depends_on_seed(sweep.scenario, {}, {})) {
      print_warning(
          "proleg sweep",
          "all seeds give the same run, because neither the start state of an algorithm nor the touch sensors "
          "have noise");
    }
  }
}

/// Whether any run has a value of the measure.
bool has_values(const SweepResult& result) {
  return std::ranges::any_of(result.groups, [](const SweepGroup& group) { return !group.values.empty(); });
}

/// Counts the runs that failed and those whose servos cannot follow.
void count_runs(SweepResult& result) {
  constexpr sim::Measure error = sim::Measure::max_tracking_error;
  for (const SweepRun& done : result.runs) {
    if (!done.result.failure.empty()) {
      ++result.failed;
      result.first_failure = result.first_failure == nullptr ? &done : result.first_failure;
    }
    if (done.result.limited_joints > 0) {
      ++result.limited;
      if (result.worst_limited == nullptr ||
          done.result.measures[error] > result.worst_limited->result.measures[error]) {
        result.worst_limited = &done;
      }
    }
  }
}

/// The request in the folder of the results, from which `--resume` and the page go on.
optimize::SweepRequest request_of(const SweepOptions& options, const Sweep& sweep,
                                  const std::filesystem::path& folder) {
  const std::filesystem::path here = std::filesystem::current_path();
  const std::filesystem::path place = here.lexically_relative(std::filesystem::weakly_canonical(folder));
  const bool is_inside = !place.empty() && *place.begin() != "..";
  optimize::SweepRequest request{optimize::universal_time(),
                                 is_inside ? place.string() : here.string(),
                                 options.scenario.file,
                                 options.measure,
                                 options.over,
                                 {},
                                 options.scenario.settings,
                                 options.scenario.seconds,
                                 options.scenario.overrides};
  for (const SweptQuantity& quantity : sweep.quantities) {
    request.units.push_back(quantity.unit);
  }
  return request;
}

SweepResult run(const Sweep& sweep, std::uint32_t worker_count, std::vector<SweepRun> earlier, GrowingTable& table,
                const SweepClaim& claim) {
  optimize::Experiment experiment;  // the workers take their time limit from it
  experiment.scenario.duration_s = sweep.scenario.duration_s;
  optimize::LocalWorkers workers(
      experiment, worker_count,
      [&sweep](const optimize::Experiment& /*experiment*/, std::span<const optimize::Task> tasks) {
        return optimize::run_combinations(sweep, tasks);
      });
  CountProgress progress("runs", sweep.size());
  const auto show = [&](std::span<const SweepRun> runs) {
    table.add(runs);
    for (const std::string& message : workers.messages()) {
      progress.erase();
      print_warning("proleg sweep", message);
    }
    progress.show(runs.size());
  };
  SweepResult result;
  const auto stops = [&] {
    result.is_stopped = result.is_stopped || interrupted() || claim.is_stop_requested();
    return result.is_stopped;
  };
  result.resumed = earlier.size();
  const auto start = std::chrono::steady_clock::now();
  result.runs = optimize::run_sweep(sweep, workers, std::move(earlier), stops, show);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.workers = workers.count();
  count_runs(result);
  return result;
}

void write_results(const Sweep& sweep, sim::Measure measure, const std::filesystem::path& folder, SweepResult& result) {
  const auto write = [&](const char* name, const std::string& text) {
    result.files.push_back(folder / name);
    write_file(result.files.back(), text);
  };
  std::string table = optimize::sweep_head(sweep, result_key);
  for (const SweepRun& run : result.runs) {
    table += optimize::sweep_line(sweep, run);
  }
  write("sweep.tsv", table);
  write("summary.tsv", optimize::sweep_summary(sweep, result.groups, measure));
  if (const std::string picture = optimize::draw_sweep(sweep, result.groups, measure); !picture.empty()) {
    write("sweep.svg", picture);
  }
}

/// Text of a combination: "amplitude 10, seed 1".
std::string values_text(const Sweep& sweep, const optimize::Candidate& combination, bool with_seed) {
  std::string text;
  for (std::size_t i = 0; i < sweep.quantities.size(); ++i) {
    const SweptQuantity& quantity = sweep.quantities[i];
    if (with_seed || quantity.kind != SweptQuantity::Kind::seed) {
      text += (text.empty() ? "" : ", ") + quantity.name + ' ' + quantity.values[combination[i]];
    }
  }
  return text;
}

std::string description(const Sweep& sweep, const SweepGroup& group) {
  const std::string text = values_text(sweep, group.combination, false);
  return text.empty() ? "all runs" : text;
}

std::string description(const Sweep& sweep, const SweepRun& run) {
  return values_text(sweep, sweep.combination(run.number), true);
}

/// Text of the first failure: "amplitude 10, seed 1: the robot fell".
std::string first_failure(const Sweep& sweep, const SweepResult& result) {
  return description(sweep, *result.first_failure) + ": " + one_line(result.first_failure->result.failure);
}

std::string figure(double value) { return std::isfinite(value) ? number_text(value) : "-"; }

void print_table(const Sweep& sweep, sim::Measure measure, const SweepResult& result) {
  const sim::MeasureDeclaration& declaration = sim::declaration_of(measure);
  const std::string unit(declaration.unit);
  std::printf("%s%s: mean, standard deviation, number of values\n", std::string(declaration.name).c_str(),
              unit.empty() ? "" : (" (" + unit + ")").c_str());
  constexpr std::size_t max_lines = 60;
  for (std::size_t i = 0; i < result.groups.size() && i < max_lines; ++i) {
    const SweepGroup& group = result.groups[i];
    std::printf("  %-40s %10s %10s %6zu\n", description(sweep, group).c_str(), figure(group.mean()).c_str(),
                figure(group.deviation()).c_str(), group.values.size());
  }
  if (result.groups.size() > max_lines) {
    std::printf("  ... and %zu more lines in summary.tsv\n", result.groups.size() - max_lines);
  }
  std::printf("%-10s %zu of %llu, %llu of them failed; engine %s, %u workers, %.1f s\n", "runs", result.runs.size(),
              static_cast<unsigned long long>(sweep.size()), static_cast<unsigned long long>(result.failed),
              std::string(sim::name_of(sweep.scenario.environment.engine)).c_str(), result.workers, result.wall_s);
  if (result.resumed > 0) {
    std::printf("%-10s %llu runs were there already\n", "resumed", static_cast<unsigned long long>(result.resumed));
  }
  if (result.failed > 0) {
    std::printf("%-10s the first at %s\n", "failed", first_failure(sweep, result).c_str());
  }
  for (const std::filesystem::path& file : result.files) {
    std::printf("%-10s %s\n", "written", file.c_str());
  }
}

void print_json(const SweepOptions& options, const Sweep& sweep, const std::filesystem::path& folder,
                const SweepResult& result) {
  Json groups = Json::empty_array();
  for (const SweepGroup& group : result.groups) {
    Json values = Json::empty_object();
    for (std::size_t i = 0; i < sweep.quantities.size(); ++i) {
      if (sweep.quantities[i].kind != SweptQuantity::Kind::seed) {
        values.add(sweep.quantities[i].name, parse_number(sweep.quantities[i].values[group.combination[i]]));
      }
    }
    groups.append({{"at", values},
                   {"mean", group.mean()},
                   {"standard_deviation", group.deviation()},
                   {"values", group.values.size()}});
  }
  const Json object{{"scenario", options.scenario.file},
                    {"engine", std::string(sim::name_of(sweep.scenario.environment.engine))},
                    {"measure", options.measure},
                    {"combinations", sweep.size()},
                    {"runs", result.runs.size()},
                    {"resumed", result.resumed},
                    {"failed", result.failed},
                    {"first_failure", result.failed > 0 ? Json(first_failure(sweep, result)) : Json()},
                    {"servos_cannot_follow", result.limited},
                    {"groups", groups},
                    {"overrides", overrides_object(sweep.scenario.overrides)},
                    {"workers", result.workers},
                    {"wall_s", result.wall_s},
                    {"out", folder.string()},
                    {"build_id", build_id}};
  std::cout << object.text() << '\n';
}

void warn_of_limited_servos(const Sweep& sweep, const SweepResult& result) {
  if (result.limited > 0) {
    const optimize::TrialResult& worst = result.worst_limited->result;
    std::fprintf(
        stderr,
        "proleg sweep: warning: the servos cannot follow the gait in %llu of %zu runs; worst at %s: %u of %zu joints, "
        "angles differ from it by up to %.1f deg\n",
        static_cast<unsigned long long>(result.limited), result.runs.size(),
        description(sweep, *result.worst_limited).c_str(), worst.limited_joints, sweep.scenario.robot.joints.size(),
        worst.measures[sim::Measure::max_tracking_error]);
  }
}

/// Text with the reason why no run has a value of the measure.
std::string why_without_values(const Sweep& sweep, const SweepOptions& options, const SweepResult& result) {
  const std::string runs = std::to_string(result.runs.size());
  if (result.failed == result.runs.size()) {
    return "all " + runs + " runs failed; the first at " + first_failure(sweep, result);
  }
  const std::string text = "none of " + runs + " runs defines " + options.measure;
  return result.failed == 0
             ? text
             : text + "; " + std::to_string(result.failed) + " failed, the first at " + first_failure(sweep, result);
}

int sweep(const SweepOptions& options) {
  const sim::Measure measure = read_measure(options.measure);
  ScenarioRun setup = prepare_run(options.scenario);
  const Sweep sweep = optimize::read_sweep(std::move(setup.scenario), options.over, options.scenario.settings);
  const std::uint32_t worker_count = parse_workers(options.workers);
  const std::filesystem::path folder = result_folder(options);
  static_cast<void>(sim::Simulation(sweep.scenario));  // an engine without the features of the world refuses it now
  catch_interrupts();
  const ResultFolder result_claim(folder, {});
  std::vector<SweepRun> earlier;
  if (options.resume) {
    earlier = interrupted_runs(sweep, folder / result_files[0]);
  } else {
    require_no_results(folder);
  }
  const SweepClaim claim(folder, request_of(options, sweep, folder), options.resume.has_value());
  GrowingTable table(sweep, folder / result_files[0], options.resume.has_value(), earlier.size());
  print_warnings("proleg sweep", sweep.scenario);
  warn_of_equal_runs(sweep);
  SweepResult result = run(sweep, worker_count, std::move(earlier), table, claim);
  if (result.runs.empty()) {
    std::cerr << "proleg sweep: interrupted before the first run of " << sweep.size()
              << " ended; nothing was written\n";
    return exit_failed;
  }
  result.groups = optimize::group_runs(sweep, result.runs, measure);
  write_results(sweep, measure, folder, result);
  const bool has_result = has_values(result);
  if (!has_result) {
    std::cerr << "proleg sweep: " << why_without_values(sweep, options, result) << '\n';
  } else if (options.json) {
    print_json(options, sweep, folder, result);
  } else {
    print_table(sweep, measure, result);
  }
  warn_of_limited_servos(sweep, result);
  if (result.is_stopped) {
    std::cerr << "proleg sweep: interrupted after " << result.runs.size() << " of " << sweep.size()
              << " runs; they are in " << (folder / "sweep.tsv").string() << "; the same command with --resume "
              << folder.string() << " continues it\n";
    return exit_failed;
  }
  return has_result ? exit_success : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg sweep",
                           "Runs a scenario with all combinations of some values, several runs at a time. Writes "
                           "sweep.tsv (all measures of every run),\nsummary.tsv (mean and standard deviation over the "
                           "seeds) and sweep.svg (if one or two quantities vary besides the seed).");
  SweepOptions options;
  add_start_options(command_line, options.scenario);
  command_line
      .add_option("--over", options.over,
                  "NAME=FIRST:LAST:STEP (step 1 if it is omitted): the values of a parameter, named as in --set, or "
                  "of seed, friction or heading as in the options, or of x or y of the start position. Several --over "
                  "give all combinations, at most 100000.")
      .required();
  command_line.add_option("--measure", options.measure, "measure of summary and picture (docs/gait-measures.md)")
      .value_name("NAME")
      .shows_default();
  command_line.add_option("--workers", options.workers,
                          "number of simulations at the same time; default: number of processors");
  command_line.add_option("--out", options.out,
                          "folder for tables and picture; default: the name of FILE up to its first dot, and _sweep");
  command_line
      .add_option("--resume", options.resume,
                  "continue the sweep whose sweep.tsv is in this folder; the other options must be the same")
      .value_name("FOLDER");
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return sweep(options); });
}
