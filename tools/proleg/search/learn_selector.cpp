// proleg learn-selector: learns by which rules a robot chooses its gait, from recordings that a person labelled.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/algorithms.hpp"
#include "sim/optimize/adaptation/labelled_recording.hpp"
#include "sim/optimize/report/report.hpp"
#include "sim/record/recorded_scenario.hpp"
#include "sim/scenario/settings.hpp"
#include "tools/proleg/common/build_id.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/common/terminal.hpp"
#include "tools/proleg/search/optimise.hpp"

namespace proleg::tools {
namespace {

using optimize::LabelledRun;
using optimize::LearnedRules;
using optimize::RuleParameters;
using optimize::RunDecisions;

struct LearnOptions {
  std::vector<std::string> recordings;
  std::vector<std::string> features;
  std::optional<std::string> window;
  std::optional<std::string> hysteresis;
  std::optional<std::string> out;
  bool json = false;
};

constexpr std::array<std::string_view, 3> learned_files{"learned.simulation.xml", "learned.actuation.xml",
                                                        "learned.files"};

const Declaration& selector() { return sensing_module_gait_selector().declaration(); }

std::uint8_t parameter_number(std::string_view name) {
  return static_cast<std::uint8_t>(find_parameter(selector(), name));
}

/// position: in RuleParameters.
std::uint8_t rule_parameter(std::size_t position) {
  return static_cast<std::uint8_t>(parameter_number("feature_2") + position);
}

/// feature: as GaitFeatures::Feature.
std::string feature_name(std::size_t feature) {
  const auto first = static_cast<std::size_t>(find_internal_value(selector(), "pitch"));
  return std::string(selector().internal_values[first + feature].name);
}

std::uint32_t named_features(const LearnOptions& options) {
  if (options.features.empty()) {
    return (1U << GaitFeatures::count) - 1;
  }
  std::vector<std::string> known;
  std::string all;
  for (std::size_t feature = 0; feature < GaitFeatures::count; ++feature) {
    known.push_back(feature_name(feature));
    all += (all.empty() ? "" : ", ") + known.back();
  }
  std::uint32_t named = 0;
  for (const std::string& name : options.features) {
    const auto found = std::ranges::find(known, name);
    if (found == known.end()) {
      throw InputError("--feature", 0, in_quotes(name), all);
    }
    named |= 1U << static_cast<unsigned>(found - known.begin());
  }
  return named;
}

/// Those of `features` for which all runs have the readings.
std::uint32_t usable_features(std::uint32_t features, const std::vector<LabelledRun>& runs) {
  std::uint32_t usable = features;
  for (const LabelledRun& run : runs) {
    for (unsigned feature = 0; feature < GaitFeatures::count; ++feature) {
      if ((GaitFeatures::required_readings(1U << feature) & ~run.readings) != 0) {
        usable &= ~(1U << feature);
      }
    }
  }
  if (usable == 0) {
    throw InputError("--feature", 0, "features whose sensors the recordings do not have",
                     "a feature that all recordings have, such as touch");
  }
  return usable;
}

std::int32_t window_of(const LearnOptions& options, const optimize::SelectorTimes& times) {
  if (!options.window) {
    return times.window_ms;
  }
  const std::optional<std::int32_t> window = parse_whole<std::int32_t>(*options.window);
  if (!window || *window < 1 || *window > 600'000) {
    throw InputError("--window", 0, in_quotes(*options.window), "1 to 600000 ms");
  }
  return *window;
}

/// Nothing: it is learned.
std::optional<std::int32_t> hysteresis_of(const LearnOptions& options) {
  if (!options.hysteresis) {
    return std::nullopt;
  }
  const std::optional<double> hysteresis = parse_number(*options.hysteresis);
  if (!hysteresis || *hysteresis < 0.0 || *hysteresis > 1.0) {
    throw InputError("--hysteresis", 0, in_quotes(*options.hysteresis), "0 to 1");
  }
  return static_cast<std::int32_t>(std::lround(*hysteresis * (1U << 28U)));
}

std::vector<LabelledRun> read_runs(const std::vector<optimize::RecordingLabel>& labels, std::int32_t window_ms) {
  RunProgress progress("reading recordings", static_cast<double>(labels.size()));
  std::vector<LabelledRun> runs;
  for (const optimize::RecordingLabel& label : labels) {
    runs.push_back(optimize::read_labelled_run(label, window_ms));
    progress.show(static_cast<double>(runs.size()));
  }
  optimize::check_together(runs);
  return runs;
}

RunDecisions sum_of(const std::vector<RunDecisions>& runs) {
  RunDecisions sum;
  for (const RunDecisions& run : runs) {
    sum.ticks += run.ticks;
    sum.right += run.right;
    sum.changes += run.changes;
    sum.seconds += run.seconds;
  }
  return sum;
}

std::optional<double> share_right(const RunDecisions& decisions) {
  return decisions.ticks == 0
             ? std::nullopt
             : std::optional(static_cast<double>(decisions.right) / static_cast<double>(decisions.ticks));
}

std::optional<double> changes_a_minute(const RunDecisions& decisions) {
  return decisions.ticks == 0 ? std::nullopt
                              : std::optional(static_cast<double>(decisions.changes) * 60 / decisions.seconds);
}

std::string percent_text(const std::optional<double>& share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f %%", share.value_or(0.0) * 100);
  return share ? text.data() : "-";
}

double as_number(std::int32_t ratio) { return ratio / double{1U << 28U}; }

/// "touch below 0.31 and roll above 0.7"; "never".
std::string rule_text(const RuleParameters& rules, std::int32_t set) {
  const std::int32_t* const rule = rules.data() + static_cast<std::size_t>(set - 2) * DecisionList::parameters_of_rule;
  std::string text;
  for (const std::int32_t* condition = rule; condition != rule + DecisionList::parameters_of_rule; condition += 2) {
    if (condition[0] != 0) {
      const std::size_t feature = static_cast<std::size_t>(std::abs(condition[0])) - 1;
      std::array<char, 32> threshold{};
      std::snprintf(threshold.data(), threshold.size(), "%.3g", as_number(condition[1]));
      text += (text.empty() ? "" : " and ") + feature_name(feature) + (condition[0] > 0 ? " above " : " below ") +
              threshold.data();
    }
  }
  return text.empty() ? "never" : text;
}

/// The scenario of a recording with the values with which it began, but these rules and times.
sim::Scenario learned_scenario(const std::string& file, const LearnedRules& learned,
                               const optimize::SelectorTimes& times) {
  const sim::Recording recording(file);
  std::optional<sim::Scenario> scenario = sim::recorded_scenario(recording);
  if (!scenario) {
    throw InputError(file, 0, "a recording whose scenario cannot be read",
                     "a recording with the files of its scenario");
  }
  for (const sim::RecordedSetting& setting : recording.parameters()) {
    const Slot* const slot = setting.slot < max_slots ? &scenario->kernel.slots[setting.slot] : nullptr;
    const int number = slot == nullptr || slot->algorithm == nullptr
                           ? -1
                           : find_parameter(slot->algorithm->declaration(), setting.name);
    if (!setting.commit && number >= 0 && slot->group.contains(setting.joint)) {
      sim::set_start_value(*scenario,
                           {static_cast<std::uint8_t>(setting.slot), static_cast<std::uint8_t>(setting.joint),
                            static_cast<std::uint8_t>(number), false, setting.raw});
    }
  }
  std::vector<std::pair<std::uint8_t, std::int32_t>> values{{parameter_number("window"), times.window_ms},
                                                            {parameter_number("dwell"), times.dwell_ms},
                                                            {parameter_number("hysteresis"), learned.hysteresis}};
  for (std::size_t i = 0; i < learned.rules.size(); ++i) {
    values.emplace_back(rule_parameter(i), learned.rules[i]);
  }
  const auto slot = static_cast<std::uint8_t>(optimize::selector_slot(recording).slot);
  for (const unsigned joint : scenario->kernel.slots[slot].driven_joints()) {
    for (const auto& [number, value] : values) {
      sim::set_start_value(*scenario, {slot, static_cast<std::uint8_t>(joint), number, false, value});
    }
  }
  return *scenario;
}

/// The sets of which no recording tells whether the robot comes to them from another one; empty: none.
std::string untried_sets(const std::vector<LabelledRun>& runs, const std::vector<bool>& is_untried) {
  std::set<std::int32_t> sets;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (is_untried[i]) {
      sets.insert(runs[i].label.sets.begin(), runs[i].label.sets.end());
    }
  }
  std::string text;
  for (const std::int32_t set : sets) {
    text += (text.empty() ? "" : ", ") + std::to_string(set);
  }
  return text;
}

void print(const std::vector<LabelledRun>& runs, const std::vector<bool>& is_untried, const LearnedRules& learned,
           const std::vector<RunDecisions>& decisions, const std::vector<RunDecisions>& unseen,
           const optimize::SelectorTimes& times) {
  std::printf("%-10s played unless a rule holds\n", "set 1");
  for (std::int32_t set = 2; set <= optimize::gait_sets; ++set) {
    std::printf("%-10s %s\n", ("set " + std::to_string(set)).c_str(), rule_text(learned.rules, set).c_str());
  }
  std::printf("%-10s %.2f\n", "hysteresis", as_number(learned.hysteresis));
  std::printf("%-10s window %s ms, dwell %s ms\n", "times", std::to_string(times.window_ms).c_str(),
              std::to_string(times.dwell_ms).c_str());
  std::printf("\n%-5s %-8s %-8s %-12s recording\n", "set", "right", "unseen", "changes/min");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::array<char, 32> changes{};
    std::snprintf(changes.data(), changes.size(), "%.1f", changes_a_minute(decisions[i]).value_or(0.0));
    const std::string& word = runs[i].label.word;
    const std::size_t equals = word.find('=');
    std::printf("%-5s %-8s %-8s %-12s %s\n", word.substr(0, equals).c_str(),
                percent_text(share_right(decisions[i])).c_str(), percent_text(share_right(unseen[i])).c_str(),
                changes.data(), word.substr(equals + 1).c_str());
  }
  const RunDecisions all = sum_of(decisions);
  std::printf("\n%-10s %s of %.0f s, with rules from all recordings\n", "right", percent_text(share_right(all)).c_str(),
              all.seconds);
  const RunDecisions tried = sum_of(unseen);
  if (tried.ticks == 0) {
    std::printf("%-10s not known: that takes two recordings for a gait\n", "unseen");
  } else {
    const auto count = std::ranges::count_if(unseen, [](const RunDecisions& run) { return run.ticks > 0; });
    std::printf("%-10s %s of %.0f s right, with rules from other recordings; %lld of %zu recordings could be tried\n",
                "unseen", percent_text(share_right(tried)).c_str(), tried.seconds, static_cast<long long>(count),
                runs.size());
  }
  std::printf("%-10s %.2f a minute\n", "changes", changes_a_minute(all).value_or(0.0));
  if (const std::string sets = untried_sets(runs, is_untried); !sets.empty()) {
    std::printf(
        "%-10s %s: played in all recordings in which it is right. Whether the robot changes to it there is not "
        "known: hysteresis was left out; also record this ground with another set\n",
        "set", sets.c_str());
  }
}

Json json_of(const std::vector<LabelledRun>& runs, const std::vector<bool>& is_untried, const LearnedRules& learned,
             const std::vector<RunDecisions>& decisions, const std::vector<RunDecisions>& unseen,
             const optimize::SelectorTimes& times) {
  Json parameters = Json::empty_object();
  for (std::size_t i = 0; i < learned.rules.size(); ++i) {
    const Parameter& parameter = selector().parameters[rule_parameter(i)];
    const std::int32_t value = learned.rules[i];
    parameters.add(std::string(parameter.name),
                   parameter.unit == Unit::count ? static_cast<double>(value) : as_number(value));
  }
  parameters.add("hysteresis", as_number(learned.hysteresis));
  parameters.add("window", static_cast<double>(times.window_ms));
  parameters.add("dwell", static_cast<double>(times.dwell_ms));
  Json list = Json::empty_array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Json sets = Json::empty_array();
    for (const std::int32_t set : runs[i].label.sets) {
      sets.append(set);
    }
    list.append(Json{{"recording", runs[i].label.word},
                     {"sets", sets},
                     {"seconds", decisions[i].seconds},
                     {"right", share_right(decisions[i])},
                     {"unseen_right", share_right(unseen[i])},
                     {"changes_per_minute", changes_a_minute(decisions[i])},
                     {"entry_tried", !is_untried[i]}});
  }
  const RunDecisions all = sum_of(decisions);
  return Json{{"algorithm", std::string(selector().name)},
              {"parameters", parameters},
              {"rules", Json{{"2", rule_text(learned.rules, 2)},
                             {"3", rule_text(learned.rules, 3)},
                             {"4", rule_text(learned.rules, 4)}}},
              {"right", share_right(all)},
              {"unseen_right", share_right(sum_of(unseen))},
              {"changes_per_minute", changes_a_minute(all)},
              {"recordings", list},
              {"build_id", build_id}};
}

int learn(const LearnOptions& options) {
  std::vector<optimize::RecordingLabel> labels;
  for (const std::string& word : options.recordings) {
    labels.push_back(optimize::parse_recording_label(word));
  }
  const std::uint32_t named = named_features(options);
  const std::optional<std::int32_t> hysteresis = hysteresis_of(options);
  if (options.out) {
    check_result_folder(*options.out, learned_files);
  }
  // A recording of one set has short times, so that this set is played from the beginning.
  optimize::SelectorTimes times{0, 0};
  for (const optimize::RecordingLabel& label : labels) {
    const optimize::SelectorTimes its = optimize::selector_times(sim::Recording(label.file));
    times = {std::max(times.window_ms, its.window_ms), std::max(times.dwell_ms, its.dwell_ms)};
  }
  times.window_ms = window_of(options, times);
  std::vector<LabelledRun> runs = read_runs(labels, times.window_ms);
  if (std::ranges::all_of(runs,
                          [&](const LabelledRun& run) { return run.right_sets() == runs.front().right_sets(); })) {
    throw InputError(options.recordings.front(), 0, "recordings with one right gait",
                     "recordings in which different gaits are right, such as 1=flat.proleg 2=stairs.proleg");
  }
  const std::uint32_t usable = usable_features(named, runs);
  const std::vector<bool> is_untried = optimize::forget_untried_entries(runs);

  std::vector<const LabelledRun*> all;
  all.reserve(runs.size());
  for (const LabelledRun& run : runs) {
    all.push_back(&run);
  }
  const LearnedRules rules = optimize::learn_rules(optimize::examples_of(all), usable, hysteresis);
  std::vector<RunDecisions> decisions;
  decisions.reserve(runs.size());
  for (const LabelledRun& run : runs) {
    decisions.push_back(optimize::decide(run, rules, times.dwell_ms));
  }
  const std::vector<RunDecisions> unseen = optimize::try_on_unseen(runs, usable, hysteresis, times.dwell_ms);

  std::string written;
  if (options.out) {
    const sim::Scenario scenario = learned_scenario(labels.front().file, rules, times);
    const ResultFolder claim(*options.out, learned_files);
    written = optimize::write_scenario(scenario, "Rules that proleg learn-selector learned.", *options.out, "learned")
                  .string();
  }
  if (options.json) {
    Json object = json_of(runs, is_untried, rules, decisions, unseen, times);
    object.add("written", options.out ? std::optional(written) : std::nullopt);
    std::cout << object.text() << '\n';
  } else {
    print(runs, is_untried, rules, decisions, unseen, times);
    if (options.out) {
      std::printf("%-10s %s\n", "written", written.c_str());
    }
  }
  return exit_success;
}

}  // namespace

int learn_selector_command(int argc, char** argv) {
  CommandLine command_line(
      "proleg learn-selector",
      "Learns by which rules a robot with SensingModule_gait_selector chooses its gait, from recordings of which a "
      "person says which set of parameters is right there.\nPrints how often the rules are right, also on recordings "
      "that they were not learned from.");
  LearnOptions options;
  command_line
      .add_option("RECORDING", options.recordings,
                  "SET=FILE: a recording in which this set, 1 to 4, is right, or each of several (1,3=FILE); "
                  "SET=FILE@FROM-TO: seconds of it. Sets with the same gait count as one.")
      .required()
      .takes_several();
  command_line
      .add_option("--feature", options.features,
                  "a feature that the rules may use; default: all that the recordings have. May be repeated.")
      .value_name("NAME");
  command_line
      .add_option("--window", options.window,
                  "over which time features are averaged; default: the longest of the recordings")
      .value_name("MS");
  command_line.add_option("--hysteresis", options.hysteresis,
                          "how far a feature goes back before the set that is played ends, 0 to 1; default: learned");
  command_line.add_option("--out", options.out,
                          "folder for the first recording's scenario with the rules: learned.simulation.xml");
  command_line.add_flag("--json", options.json, "print one JSON object");
  return command_line.run(argc, argv, [&] { return learn(options); });
}

}  // namespace proleg::tools
