// proleg adapt: finds a gait for a robot that is not as its atlas expects, in a few trials.

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/adaptation/adaptation.hpp"
#include "sim/optimize/adaptation/atlas.hpp"
#include "sim/optimize/adaptation/simulated_robot.hpp"
#include "sim/optimize/adaptation/trial_table.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/optimize/report/scores.hpp"
#include "sim/scenario/damage.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/search/map_result.hpp"
#include "tools/proleg/search/optimise.hpp"

namespace proleg::tools {
namespace {

using optimize::Adaptation;
using optimize::Atlas;
using optimize::AtlasGait;
using optimize::MadeTrial;

struct AdaptOptions {
  ScenarioOptions scenario;
  std::string atlas;
  std::vector<std::string> damages;
  std::string trials = "12";
  std::string alpha = "0.9";
  std::string kappa = "0.05";
  std::string length = "0.3";
  std::string noise = "0.03";
  std::optional<std::string> out;
  std::optional<std::string> resume;
};

constexpr std::array<std::string_view, 5> result_files{"trials.tsv", "trials.svg", "adapted.simulation.xml",
                                                       "adapted.actuation.xml", "adapted.files"};

double number_of(const std::string& option, const std::string& word, double lowest, double highest) {
  const std::optional<double> number = parse_number(word);
  if (!number || *number < lowest || *number > highest) {
    throw InputError(option, 0, in_quotes(word), number_text(lowest) + " to " + number_text(highest));
  }
  return *number;
}

optimize::AdaptationSettings settings_of(const AdaptOptions& options) {
  optimize::AdaptationSettings settings;
  settings.alpha = number_of("--alpha", options.alpha, 0.0, 1.0);
  settings.kappa = number_of("--kappa", options.kappa, 0.0, 100.0);
  settings.length = number_of("--length", options.length, 0.001, 1000.0);
  settings.noise = number_of("--noise", options.noise, 0.0, 10.0);
  const std::optional<std::uint32_t> trials = parse_whole<std::uint32_t>(options.trials);
  if (!trials || *trials < 1 || *trials > 1000) {
    throw InputError("--trials", 0, in_quotes(options.trials), "1 to 1000");
  }
  settings.trials = *trials;
  return settings;
}

Atlas atlas_of(const AdaptOptions& options) {
  try {
    return optimize::read_atlas(options.atlas);
  } catch (const optimize::StoreError& error) {
    throw BadInput(error.what());
  }
}

void rate_for_trials(Atlas& atlas, double seconds) {
  RunProgress progress("rating the gaits of the atlas for trials of this length", 1.0);
  try {
    optimize::rate_for_length(atlas, seconds, [&](double share) {
      progress.show(share);
      if (interrupted()) {
        throw optimize::SearchEnded();
      }
    });
  } catch (const optimize::StoreError& error) {
    throw BadInput(error.what());
  }
}

/// What decides the outcome of a trial.
std::string inputs_of(const Atlas& atlas, const sim::Scenario& scenario, const std::vector<std::string>& damages) {
  optimize::Experiment reality = atlas.experiment;
  reality.scenario = scenario;
  std::string text = atlas.fingerprint() + ' ' + reality.fingerprint() + ' ' + result_key;
  const sim::OverrideWords words = sim::words_of(scenario.overrides);
  for (const std::optional<std::string>& word : {words.friction, words.at, words.heading}) {
    text += ' ' + word.value_or("-");
  }
  for (const std::string& damage : damages) {
    text += ' ' + damage;
  }
  return sha256_hex(text);
}

std::string with_unit_text(double value, std::string_view unit) {
  return optimize::rounded_text(value) + (unit.empty() ? "" : ' ' + std::string(unit));
}

/// The trials of a robot, with their files.
class Run {
 public:
  Run(const AdaptOptions& options, const Atlas& atlas, const sim::Scenario& intact, std::filesystem::path folder)
      : options_(options),
        atlas_(atlas),
        map_(atlas.experiment),
        objective_(atlas.experiment.objectives.front()),
        intact_(intact),
        folder_(std::move(folder)),
        inputs_(inputs_of(atlas, intact, options.damages)),
        adaptation_(atlas.cells(), settings_of(options)) {}

  /// Reads the trials that were made before.
  void resume() {
    const std::filesystem::path table = folder_ / result_files[0];
    if (const auto found = found_instead_of_file(table)) {
      throw InputError(table.string(), 0, *found, "the trials of an earlier run; there is nothing to resume");
    }
    std::ifstream stream(table, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    made_ = optimize::read_trial_table(atlas_, inputs_, table.string(), text);
    for (const MadeTrial& trial : made_) {
      adaptation_.tell(trial.gait, value_of(trial.measured));
    }
    resumed_ = made_.size();
  }

  /// Makes trials until they end, or the user stops them.
  void make_trials(optimize::TrialRobot& robot) {
    try {
      while (const std::optional<std::size_t> gait = adaptation_.next()) {
        const optimize::Estimate expected = adaptation_.expected()[*gait];
        const optimize::TrialOutcome outcome = robot.try_gait(atlas_.gaits[*gait].candidate);
        adaptation_.tell(*gait, value_of(outcome.score));
        made_.push_back({*gait, score_of(expected.mean), expected.deviation, outcome.score, outcome.failure});
        write_file(folder_ / result_files[0], optimize::trial_table(atlas_, inputs_, made_));
        if (!options_.scenario.json) {
          std::cout << line_of(made_.size() - 1) << std::endl;  // a trial takes seconds: each is shown at once
        }
      }
    } catch (const optimize::SearchEnded&) {
      is_stopped_ = true;
    }
  }

  /// Writes picture and scenario, prints the result, and returns the exit status.
  int finish() {
    if (made_.empty()) {
      std::cerr << "proleg adapt: interrupted before the end of the first trial; nothing was written\n";
      return exit_failed;
    }
    const MadeTrial* const best = best_trial();
    write_picture();
    if (best != nullptr) {
      write_adapted(*best);
    }
    if (options_.scenario.json) {
      std::cout << json(best).text() << '\n';
    } else {
      print(best);
    }
    if (is_stopped_) {
      std::cerr << "proleg adapt: interrupted after " << made_.size() << " trials; the same command with --resume "
                << shell_argument(folder_.string()) << " continues\n";
    } else if (best == nullptr) {
      std::cerr << "proleg adapt: no trial has a score; the first failure: " << made_.front().failure << '\n';
    }
    return best != nullptr && !is_stopped_ ? exit_success : exit_failed;
  }

 private:
  [[nodiscard]] double value_of(double score) const { return -objective_.cost(score); }
  [[nodiscard]] double score_of(double value) const { return objective_.cost(-value); }

  /// Of those with a score of their own; null if there is none.
  [[nodiscard]] const MadeTrial* best_trial() const {
    const MadeTrial* best = nullptr;
    for (const MadeTrial& trial : made_) {
      if (trial.failure.empty() && (best == nullptr || objective_.better(trial.measured, best->measured))) {
        best = &trial;
      }
    }
    return best;
  }

  [[nodiscard]] std::size_t number_of_trial(const MadeTrial& trial) const {
    return static_cast<std::size_t>(&trial - made_.data()) + 1;
  }

  [[nodiscard]] std::string descriptor_text(const AtlasGait& gait) const {
    std::string text;
    for (std::size_t axis = 0; axis < gait.point.size(); ++axis) {
      const optimize::Objective& measure = atlas_.experiment.objectives[1 + axis];
      text +=
          (axis == 0 ? "" : ", ") + measure.name + ' ' + with_unit_text(atlas_.descriptor(gait, axis), measure.unit());
    }
    return text;
  }

  [[nodiscard]] std::string line_of(std::size_t position) const {
    const MadeTrial& trial = made_[position];
    const AtlasGait& gait = atlas_.gaits[trial.gait];
    return "trial " + std::to_string(position + 1) + "  cell " + map_.place_text(gait.cell) + " (" +
           descriptor_text(gait) + "): expected " + with_unit_text(trial.expected, objective_.unit()) + ", measured " +
           with_unit_text(trial.measured, objective_.unit()) +
           (trial.failure.empty() ? "" : ", failed: " + one_line(trial.failure));
  }

  void write_picture() {
    std::vector<optimize::GaitMap::Elite> cells;
    for (std::size_t i = 0; i < atlas_.gaits.size(); ++i) {
      cells.push_back({atlas_.gaits[i].cell, i, score_of(adaptation_.expected()[i].mean)});
    }
    std::vector<std::size_t> tried;
    for (const MadeTrial& trial : made_) {
      tried.push_back(atlas_.gaits[trial.gait].cell);
    }
    const MadeTrial* const best = best_trial();
    write_file(folder_ / result_files[1],
               optimize::draw_map_with_trials(atlas_.experiment, cells, tried,
                                              best == nullptr ? tried.size() : number_of_trial(*best) - 1,
                                              "what is expected of each cell after " + std::to_string(made_.size()) +
                                                  " trials, whose numbers are on their cells; the best has a ring"));
  }

  /// The scenario is that of FILE with the gait: damages by options are not in it.
  void write_adapted(const MadeTrial& best) const {
    sim::Scenario adapted = intact_;
    atlas_.experiment.space.apply(atlas_.gaits[best.gait].candidate, adapted);
    optimize::write_scenario(adapted,
                             "The best gait of " + std::to_string(made_.size()) +
                                 " trials. Damages and friction of the command line are not in these files.",
                             folder_, "adapted");
  }

  [[nodiscard]] std::string ending() const {
    return is_stopped_ ? "interrupted" : std::string(optimize::text_of(adaptation_.ending()));
  }

  [[nodiscard]] double best_expected() const {
    return score_of(std::ranges::max_element(adaptation_.expected(), {}, &optimize::Estimate::mean)->mean);
  }

  void print(const MadeTrial* best) const {
    if (resumed_ > 0) {
      std::printf("%-10s %zu trials were there already\n", "resumed", resumed_);
    }
    if (best != nullptr) {
      std::printf("%-10s trial %zu, %s (%s); the best that is expected of any cell: %s\n", "best",
                  number_of_trial(*best), with_unit_text(best->measured, objective_.unit()).c_str(),
                  objective_.name.c_str(), with_unit_text(best_expected(), objective_.unit()).c_str());
    }
    std::printf("%-10s %s after %zu trials of %s s, engine %s\n", "ended", ending().c_str(), made_.size(),
                number_text(intact_.duration_s).c_str(), std::string(sim::name_of(intact_.environment.engine)).c_str());
    for (const std::string_view file : result_files) {
      if (std::filesystem::is_regular_file(folder_ / file)) {
        std::printf("%-10s %s\n", "written", (folder_ / file).c_str());
      }
    }
  }

  [[nodiscard]] Json gait_object(const AtlasGait& gait) const {
    Json descriptor = Json::empty_object();
    for (std::size_t axis = 0; axis < gait.point.size(); ++axis) {
      descriptor.add(atlas_.experiment.objectives[1 + axis].name, atlas_.descriptor(gait, axis));
    }
    Json values = Json::empty_object();
    for (std::size_t d = 0; d < gait.candidate.size(); ++d) {
      values.add(atlas_.experiment.space.dimensions[d].name, atlas_.experiment.space.value(gait.candidate, d));
    }
    return {{"cell", place_object(map_, gait.cell)}, {"descriptor", descriptor}, {"values", values}};
  }

  [[nodiscard]] Json json(const MadeTrial* best) const {
    Json trials = Json::empty_array();
    for (const MadeTrial& trial : made_) {
      Json object = gait_object(atlas_.gaits[trial.gait]);
      object.add("expected", trial.expected);
      object.add("deviation", trial.deviation);
      object.add("measured", trial.measured);
      object.add("failure", trial.failure.empty() ? Json() : Json(one_line(trial.failure)));
      trials.append(object);
    }
    Json damages = Json::empty_array();
    for (const std::string& damage : options_.damages) {
      damages.append(damage);
    }
    return {{"scenario", options_.scenario.file},
            {"atlas", options_.atlas},
            {"gaits", atlas_.gaits.size()},
            {"objective", objective_.name},
            {"unit", objective_.unit()},
            {"engine", sim::name_of(intact_.environment.engine)},
            {"damage", damages},
            {"seconds", intact_.duration_s},
            {"trials", trials},
            {"resumed", resumed_},
            {"best_trial", best == nullptr ? Json() : Json(number_of_trial(*best))},
            {"best", best == nullptr ? Json() : Json(best->measured)},
            {"best_expected", best_expected()},
            {"ended", ending()},
            {"out", folder_.string()},
            {"build_id", build_id}};
  }

  const AdaptOptions& options_;
  const Atlas& atlas_;
  const optimize::GaitMap map_;  ///< for the places of its cells
  const optimize::Objective& objective_;
  const sim::Scenario& intact_;  ///< without the damages of the command line
  std::filesystem::path folder_;
  std::string inputs_;
  Adaptation adaptation_;
  std::vector<MadeTrial> made_;
  std::size_t resumed_ = 0;
  bool is_stopped_ = false;
};

int adapt(AdaptOptions& options) {
  static_cast<void>(settings_of(options));  // errors in them come before the work
  const ScenarioRun setup = prepare_run(options.scenario);
  sim::Scenario damaged = setup.scenario;
  sim::apply_damage(damaged, options.damages);
  const std::string name = std::filesystem::path(options.scenario.file).filename().string();
  const std::filesystem::path folder =
      chosen_folder(options.out, options.resume, name.substr(0, name.find('.')) + "_adapt", "run");
  check_result_folder(folder, options.resume ? std::span<const std::string_view>() : result_files);
  Atlas atlas = atlas_of(options);
  optimize::require_same_robot(atlas, setup.scenario);
  static_cast<void>(sim::Simulation(damaged));  // an engine without the features of the world refuses it now
  print_warnings("proleg adapt", setup.scenario);
  catch_interrupts();
  try {
    rate_for_trials(atlas, setup.scenario.duration_s);
  } catch (const optimize::SearchEnded&) {
    std::cerr << "proleg adapt: interrupted before the first trial; nothing was written\n";
    return exit_failed;
  }
  const ResultFolder claim(folder, options.resume ? std::span<const std::string_view>() : result_files);
  Run run(options, atlas, setup.scenario, folder);
  if (options.resume) {
    run.resume();
  }
  optimize::SimulatedRobot robot(atlas.experiment, damaged, sim::losses_of_damage(damaged, options.damages),
                                 &interrupted);
  run.make_trials(robot);
  return run.finish();
}

}  // namespace

int adapt_command(int argc, char** argv) {
  CommandLine command_line("proleg adapt",
                           "Finds a gait for a robot that is damaged, or in a world that differs, in a few trials. An "
                           "atlas (a map of gaits of the intact robot)\nsays what to expect of each gait; each trial "
                           "corrects what is expected of similar ones. Until now the trials are simulated.");
  AdaptOptions options;
  options.scenario.seconds = "10";
  add_scenario(command_line, options.scenario.file, "scenario of the robot as it is now, and of its world").required();
  command_line.add_option("--atlas", options.atlas, "map of gaits of the intact robot: the folder of `proleg atlas`")
      .value_name("FOLDER")
      .required();
  command_line
      .add_option("--damage", options.damages,
                  "what is wrong with the robot beside what FILE says: " + sim::damage_forms() + ". May be repeated.")
      .value_name("DAMAGE");
  command_line.add_option("--seconds", options.scenario.seconds, "simulated time of a trial; default: 10");
  command_line.add_option("--trials", options.trials, "largest number of trials").shows_default();
  command_line
      .add_option("--alpha", options.alpha,
                  "the trials end when the best has this share of the best score that is expected of any cell")
      .shows_default();
  command_line.add_option("--kappa", options.kappa, "weight of the uncertainty in the choice of the next cell")
      .shows_default();
  command_line
      .add_option("--length", options.length,
                  "distance over which a trial says much about other gaits, where each axis of the map and each value "
                  "of a gait is "
                  "0 to 1")
      .shows_default();
  command_line
      .add_option("--noise", options.noise, "standard deviation of a trial, as a share of the atlas's best score")
      .shows_default();
  add_override_options(command_line, options.scenario);
  command_line.add_option("--out", options.out,
                          "folder for trials, picture and the best gait; default: the name of FILE up to its first "
                          "dot, and _adapt");
  command_line
      .add_option("--resume", options.resume,
                  "continue the trials in this folder; scenario, atlas, damages and seconds must be the same")
      .value_name("FOLDER");
  command_line.add_flag("--json", options.scenario.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return adapt(options); });
}

}  // namespace proleg::tools
