// proleg adapt: finds a gait for a robot that is not as its atlas expects, in a few trials.

#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/adaptation/atlas.hpp"
#include "sim/optimize/adaptation/gait_rating.hpp"
#include "sim/optimize/adaptation/simulated_robot.hpp"
#include "sim/optimize/adaptation/trial_table.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/scenario/damage.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/search/adaptation_run.hpp"
#include "tools/proleg/search/made_trials.hpp"
#include "tools/proleg/search/optimise.hpp"
#include "tools/proleg/search/robot_trials.hpp"
#include "tools/proleg/search/suspects.hpp"

namespace proleg::tools {
namespace {

using optimize::Atlas;
using optimize::MadeTrial;

struct AdaptOptions {
  ScenarioOptions scenario;
  std::string atlas;
  std::vector<std::string> damages;
  std::vector<std::string> suspects;
  TrialOptions robot;
  std::string trials = "12";
  std::string alpha = "0.9";
  std::string kappa = "1";
  std::string length = "0.3";
  std::string noise = "0.03";
  std::optional<std::string> out;
  std::optional<std::string> resume;
};

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
  std::error_code error;
  if (!std::filesystem::is_regular_file(options.atlas, error)) {
    require_map_store("--atlas", options.atlas);
  }
  try {
    return optimize::read_atlas(options.atlas);
  } catch (const optimize::StoreError& refused) {
    throw BadInput(refused.what());
  }
}

void rate_for_trials(Atlas& atlas, double seconds) {
  CountProgress progress("gaits of the atlas rated for trials of this length", atlas.gaits.size());
  const auto show = [&](double share) { progress.show_share(share); };
  try {
    optimize::rate_for_length(atlas, seconds, show, [] { return interrupted(); });
  } catch (const optimize::StoreError& error) {
    throw BadInput(error.what());
  }
}

std::filesystem::path folder_of(const std::filesystem::path& atlas) {
  return std::filesystem::is_regular_file(atlas) ? std::filesystem::absolute(atlas).parent_path() : atlas;
}

/// What decides the outcome of a trial. What a robot has measured holds for every build of this program.
std::string inputs_of(const Atlas& atlas, const sim::Scenario& scenario, const AdaptOptions& options) {
  optimize::Experiment reality = atlas.experiment;
  reality.scenario = scenario;
  std::string text =
      atlas.fingerprint() + ' ' + reality.fingerprint() + ' ' + (options.robot.bus ? optimize::robot_name : result_key);
  text += simulated_robot(options.robot);  // a real one may get another bus
  const sim::OverrideWords words = sim::words_of(scenario.overrides);
  for (const std::optional<std::string>& word : {words.friction, words.at, words.heading}) {
    text += ' ' + word.value_or("-");
  }
  std::set<std::string> damages;
  for (const std::string& damage : options.damages) {
    damages.insert(sim::damage_word(scenario, damage));
  }
  for (const std::string& damage : damages) {
    text += ' ' + damage;
  }
  return sha256_hex(text);
}

AdaptationLabels labels_of(const Atlas& atlas, const sim::Scenario& scenario, const AdaptOptions& options,
                           const std::filesystem::path& folder) {
  std::string maker(options.robot.bus ? optimize::robot_name : sim::name_of(scenario.environment.engine));
  std::string robot = std::filesystem::path(options.scenario.file).filename().string();
  if (options.robot.bus) {
    robot += " on " + *options.robot.bus;
  }
  Json damages = Json::empty_array();
  for (const std::string& damage : options.damages) {
    robot += ", " + damage;
    damages.append(damage);
  }
  const Json head{{"scenario", options.scenario.file}, {"atlas", options.atlas}, {"engine", maker},
                  {"bus", options.robot.bus},          {"damage", damages},      {"seconds", scenario.duration_s}};
  const std::filesystem::path place = std::filesystem::relative(folder_of(options.atlas), folder);
  return {{inputs_of(atlas, scenario, options), place.string(), std::move(robot), {}},
          std::move(maker),
          head,
          options.scenario.json};
}

/// The trials that an earlier run has made.
std::vector<MadeTrial> earlier_trials(const Atlas& atlas, const std::string& inputs,
                                      const std::filesystem::path& folder) {
  const std::filesystem::path table = folder / AdaptationRun::files[0];
  if (const auto found = found_instead_of_file(table)) {
    throw InputError(table.string(), 0, *found, "the trials of an earlier run; there is nothing to resume");
  }
  return optimize::read_trial_table(atlas, inputs, table.string(), read_whole_file(table));
}

/// Throws InputError if a file that will be written again is none: a pipe would wait for a reader.
void require_replaceable(const std::filesystem::path& folder) {
  for (const std::string_view name : std::span(AdaptationRun::files).first(4)) {
    const std::filesystem::path file = folder / name;
    std::error_code error;
    if (std::filesystem::exists(file, error)) {
      if (const auto found = found_instead_of_file(file)) {
        throw InputError(file.string(), 0, *found, "a file of `proleg adapt`");
      }
    }
  }
}

int adapt(AdaptOptions& options) {
  static_cast<void>(settings_of(options));  // errors in them come before the work
  require_bus(options.robot);
  const ScenarioRun setup = prepare_run(options.scenario);
  const std::string name = std::filesystem::path(options.scenario.file).filename().string();
  const std::filesystem::path folder =
      chosen_folder(options.out, options.resume, name.substr(0, name.find('.')) + "_adapt", "run");
  const std::span<const std::string_view> new_files =
      options.resume ? std::span<const std::string_view>() : AdaptationRun::files;
  check_result_folder(folder, new_files);
  if (options.resume) {
    require_replaceable(folder);
  }
  Atlas atlas = atlas_of(options);
  optimize::require_same_robot(atlas, setup.scenario);
  const std::vector<std::string> suspects = suspected_damages(options.suspects, atlas);
  sim::Scenario damaged = setup.scenario;
  std::optional<RobotTrials> robot_trials;
  if (options.robot.bus) {
    refuse_world_options(options.scenario, {{"--damage", !options.damages.empty()}});
    robot_trials.emplace(options.robot, setup.scenario, std::span(atlas.experiment.objectives).first(1), folder,
                         &interrupted);
  } else {
    sim::apply_damage(damaged, options.damages);
    static_cast<void>(sim::Simulation(damaged));  // an engine without the features of the world refuses it now
  }
  print_warnings("proleg adapt", setup.scenario);
  for (const std::string& remark : atlas.remarks) {
    print_warning("proleg adapt", "the atlas: " + remark);
  }
  catch_interrupts();
  std::vector<optimize::Hypothesis> hypotheses;
  const auto add_earlier = [&](MadeTrials& made) {
    if (options.resume) {
      for (const MadeTrial& trial : earlier_trials(atlas, inputs_of(atlas, setup.scenario, options), folder)) {
        made.add(trial);
      }
    }
  };
  try {
    rate_for_trials(atlas, setup.scenario.duration_s);
    if (options.resume) {  // a wrong folder is refused before what takes a minute
      static_cast<void>(earlier_trials(atlas, inputs_of(atlas, setup.scenario, options), folder));
    }
    hypotheses = optimize::hypotheses_of(atlas, suspects, scores_with(atlas, folder_of(options.atlas), suspects));
  } catch (const optimize::SearchEnded&) {
    MadeTrials made(atlas, optimize::hypotheses_of(atlas, {}, {}), {}, settings_of(options));
    add_earlier(made);
    return AdaptationRun(labels_of(atlas, setup.scenario, options, folder), atlas, setup.scenario, folder,
                         std::move(made))
        .end_before_trials();
  }
  const ResultFolder claim(folder, new_files);
  MadeTrials made(atlas, std::move(hypotheses), suspects, settings_of(options));
  add_earlier(made);
  const std::size_t made_before = made.all().size();
  AdaptationRun run(labels_of(atlas, setup.scenario, options, folder), atlas, setup.scenario, folder, std::move(made));
  if (robot_trials) {
    RobotOnBus robot(atlas.experiment, setup.scenario, *robot_trials, made_before);
    run.make_trials(robot);
  } else {
    optimize::SimulatedRobot robot(atlas.experiment, damaged, sim::losses_of_damage(damaged, options.damages),
                                   &interrupted);
    run.make_trials(robot);
  }
  return run.finish();
}

}  // namespace

int adapt_command(int argc, char** argv) {
  CommandLine command_line(
      "proleg adapt",
      "Finds a gait for a robot that is damaged, or in a world that differs, in a few trials. An "
      "atlas (a map of gaits of the intact robot)\nsays what to expect of each gait; each trial "
      "corrects what is expected of similar ones. The trials are simulated, or made by a robot (--bus).");
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
  command_line
      .add_option(
          "--suspect", options.suspects,
          "what may be wrong with the robot, in the forms of --damage, beside the usual: the gaits are simulated "
          "with it before the trials, which tell whether it is true. Usual are " +
              sim::usual_damages_text() + ". May be repeated; \"none\": the usual is not suspected")
      .value_name("DAMAGE");
  add_trial_options(command_line, options.robot);
  command_line.add_option("--seconds", options.scenario.seconds, "time of a trial; default: 10");
  command_line.add_option("--trials", options.trials, "largest number of trials").shows_default();
  command_line
      .add_option("--alpha", options.alpha,
                  "the trials end when the best has this share of the most that any gait promises")
      .shows_default();
  command_line
      .add_option(
          "--kappa", options.kappa,
          "weight of the standard deviation in what a gait promises: what is expected of it, and this times the "
          "deviation. The next trial is the gait that promises most")
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
                  "continue the trials in this folder; scenario, atlas, damages, seconds and robot must be the same")
      .value_name("FOLDER");
  command_line.add_flag("--json", options.scenario.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return adapt(options); });
}

}  // namespace proleg::tools
