#include "sim/optimize/adaptation/labelled_recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/algorithms.hpp"
#include "sim/loop/module_readings.hpp"

namespace proleg::optimize {
namespace {

constexpr std::size_t most_examples_of_run = 400;
constexpr std::size_t most_examples = 4'000;  // of all runs
constexpr std::uint32_t most_parts = 10;

[[noreturn]] void refuse_word(const std::string& word, const std::string& found) {
  throw InputError(word, 0, found,
                   "SET=FILE or SET=FILE@FROM-TO: a set of parameters from 1 to 4, or several with commas; a "
                   "recording; seconds of it, as 1.5-3");
}

std::string_view selector_name() { return sensing_module_gait_selector().declaration().name; }

/// The joint that decides.
unsigned first_joint(const sim::RecordedSlot& slot) {
  return static_cast<unsigned>(std::ranges::find(slot.joint_group, true) - slot.joint_group.begin());
}

/// The value of a parameter at the start, on the joint that decides.
std::int32_t start_value(const sim::Recording& recording, const sim::RecordedSlot& slot, const std::string& name) {
  const unsigned joint = first_joint(slot);
  for (const sim::RecordedSetting& setting : recording.parameters()) {
    if (!setting.commit && setting.slot == slot.slot && setting.joint == joint && setting.name == name) {
      return setting.raw;
    }
  }
  throw InputError(recording.path().string(), 0, "no parameter `" + name + "`", "a recording of this version");
}

/// What a set plays: the parameters of all joints, in the recording's order.
void read_gaits(const sim::Recording& recording, const sim::RecordedSlot& slot, LabelledRun& run) {
  for (std::size_t set = 0; set < run.parameters_of_set.size(); ++set) {
    for (const char* name : {"amplitude_", "frequency_", "phase_difference_", "offset_"}) {
      const std::string full_name = name + std::to_string(set + 1);
      for (const sim::RecordedSetting& setting : recording.parameters()) {
        if (setting.slot != slot.slot || setting.name != full_name) {
          continue;
        }
        if (setting.commit) {
          throw InputError(recording.path().string(), 0,
                           "another " + full_name + " from " + number_text(recording.time_s(setting.tick)) + " s on",
                           "a recording in which the parameters of the sets do not change");
        }
        run.parameters_of_set[set].push_back(setting.raw);
      }
    }
    const auto least = std::ranges::find(run.parameters_of_set, run.parameters_of_set[set]);
    run.gait_of_set[set] = static_cast<std::int32_t>(least - run.parameters_of_set.begin()) + 1;
  }
}

/// The deciding joint's internal value `set`, in RecordedTick::internal_values.
std::size_t position_of_set(const sim::Recording& recording, const sim::RecordedSlot& slot) {
  const std::vector<sim::RecordedInternalValue>& values = recording.internal_values();
  const auto found = std::ranges::find_if(values, [&](const sim::RecordedInternalValue& value) {
    return value.slot == slot.slot && value.joint == first_joint(slot) && value.name == "set";
  });
  if (found == values.end()) {
    throw InputError(recording.path().string(), 0, "no internal value `set`", "a recording of this version");
  }
  return static_cast<std::size_t>(found - values.begin());
}

std::uint32_t ticks_of(std::int64_t ms, std::uint32_t tick_period_us) {
  return static_cast<std::uint32_t>((ms * 1'000 + tick_period_us - 1) / tick_period_us);
}

/// The features of one tick after another.
class FeatureReplay {
 public:
  FeatureReplay(const sim::Recording& recording, const sim::RecordedSlot& slot, std::int32_t window_ms)
      : frames_(recording.joints().size()),
        context_{static_cast<std::uint8_t>(first_joint(slot)), static_cast<std::uint8_t>(recording.joints().size()),
                 JointMask::of(first_joint(slot)), recording.tick_period_us()},
        features_(GaitFeatures::make(context_, window_ms, (1U << GaitFeatures::count) - 1)) {}

  /// The features that the tick leads to.
  FeatureValues advance(const sim::RecordedTick& tick) {
    const JointReadings& readings = tick.readings[context_.joint];
    readings_in_all_ &= readings.present;
    const Contacts contacts(frames_);
    const Neighbour none;
    const std::int32_t setpoint = setpoint_.value_or(tick.setpoints[context_.joint]);
    std::array<std::int32_t, GaitFeatures::state_size> next{};
    features_.advance({tick.tick, context_, none, none, contacts, setpoint, readings}, state_.data(), next.data());
    state_ = next;
    // What this tick gives is what the next one starts from.
    setpoint_ = tick.setpoints[context_.joint];
    for (std::size_t joint = 0; joint < frames_.size(); ++joint) {
      frames_[joint].bytes[6] = sim::joint_contacts(tick.latched_contacts, joint);
    }
    FeatureValues values{};
    std::copy_n(state_.begin(), values.size(), values.begin());
    return values;
  }

  [[nodiscard]] std::uint32_t readings_in_all() const { return readings_in_all_; }

 private:
  std::vector<StateFrame> frames_;
  JointContext context_;
  GaitFeatures features_;
  std::array<std::int32_t, GaitFeatures::state_size> state_{};
  std::optional<std::int32_t> setpoint_;
  std::uint32_t readings_in_all_ = JointReadings::all_sensors;
};

/// A recording may be named in several ways.
std::string same_file(const LabelledRun& run) {
  std::error_code error;
  const std::filesystem::path path =
      std::filesystem::weakly_canonical(std::filesystem::absolute(run.label.file), error);
  return error ? run.label.file : path.string();
}

/// The part of each run's file in try_on_unseen().
std::vector<std::uint32_t> parts_of(const std::vector<LabelledRun>& runs) {
  std::map<std::string, std::uint32_t> part_of_file;
  std::map<std::uint32_t, std::uint32_t> files_of_label;
  std::vector<std::uint32_t> parts;
  for (const LabelledRun& run : runs) {
    const auto [place, is_new] = part_of_file.try_emplace(same_file(run), 0);
    if (is_new) {
      place->second = files_of_label[run.right_sets()]++ % most_parts;
    }
    parts.push_back(place->second);
  }
  return parts;
}

}  // namespace

std::uint32_t LabelledRun::right_sets() const {
  std::uint32_t right = 0;
  for (const std::int32_t right_set : label.sets) {
    for (std::int32_t set = 1; set <= gait_sets; ++set) {
      right |= gait(set) == gait(right_set) ? bit_of_set(set) : 0U;
    }
  }
  return right;
}

RecordingLabel parse_recording_label(const std::string& word) {
  RecordingLabel label;
  label.word = word;
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos) {
    refuse_word(word, "no '='");
  }
  std::istringstream sets(word.substr(0, equals) + ',');
  for (std::string text; std::getline(sets, text, ',');) {
    const std::optional<std::int32_t> set = parse_whole<std::int32_t>(text);
    if (!set || *set < 1 || *set > gait_sets) {
      refuse_word(word, "the set " + in_quotes(text));
    }
    label.sets.push_back(*set);
  }
  label.file = word.substr(equals + 1);
  // A file's name may have an '@'.
  const std::size_t at = label.file.rfind('@');
  const std::size_t dash = at == std::string::npos ? at : label.file.find('-', at);
  if (dash != std::string::npos) {
    const std::optional<double> from = parse_number(label.file.substr(at + 1, dash - at - 1));
    const std::optional<double> to = parse_number(label.file.substr(dash + 1));
    if (from && to) {
      if (*from < 0 || *to <= *from) {
        refuse_word(word, "no time from " + number_text(*from) + " s to " + number_text(*to) + " s");
      }
      label.from_s = from;
      label.to_s = to;
      label.file.erase(at);
    }
  }
  // The file that is not there is one with a time that is none.
  std::error_code error;
  if (at != std::string::npos && !label.from_s && !std::filesystem::exists(label.file, error) &&
      std::filesystem::exists(label.file.substr(0, at), error)) {
    refuse_word(word, "the time " + in_quotes(label.file.substr(at + 1)));
  }
  if (label.file.empty()) {
    refuse_word(word, "no file");
  }
  return label;
}

const sim::RecordedSlot& selector_slot(const sim::Recording& recording) {
  for (const sim::RecordedSlot& slot : recording.slots()) {
    if (slot.algorithm == selector_name()) {
      return slot;
    }
  }
  std::string names;
  for (const sim::RecordedSlot& slot : recording.slots()) {
    names += (names.empty() ? "" : ", ") + slot.algorithm;
  }
  throw InputError(recording.path().string(), 0, names.empty() ? "no algorithm" : "a recording of " + names,
                   "a recording of " + std::string(selector_name()) + ": others have no readings of all sensors");
}

SelectorTimes selector_times(const sim::Recording& recording) {
  const sim::RecordedSlot& slot = selector_slot(recording);
  return {start_value(recording, slot, "window"), start_value(recording, slot, "dwell")};
}

LabelledRun read_labelled_run(const RecordingLabel& label, std::int32_t window_ms) {
  const sim::Recording recording(label.file);
  const sim::RecordedSlot& slot = selector_slot(recording);
  const double end_s = recording.time_s(recording.last_tick());
  if (const double last_s = label.to_s.value_or(0.0); last_s > end_s + recording.tick_period_us() / 1e6) {
    throw InputError(label.word, 0, "seconds to " + number_text(last_s),
                     "seconds to " + number_text(end_s) + ": the recording has no more");
  }
  LabelledRun run;
  run.label = label;
  run.tick_period_us = recording.tick_period_us();
  run.joints = static_cast<std::uint32_t>(recording.joints().size());
  run.first_ticks = std::size_t{GaitFeatures::windows_to_follow} * ticks_of(window_ms, run.tick_period_us);
  run.joint_group = slot.joint_group;
  read_gaits(recording, slot, run);
  FeatureReplay replay(recording, slot, window_ms);
  const std::size_t played = position_of_set(recording, slot);
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const sim::RecordedTick& tick) {
    const FeatureValues features = replay.advance(tick);
    const double time_s = recording.time_s(tick.tick);
    if (time_s > label.from_s.value_or(0.0) && time_s <= label.to_s.value_or(time_s)) {
      run.features.push_back(features);
      run.played.push_back(std::clamp(tick.internal_values[played], std::int32_t{1}, gait_sets));
    }
  });
  run.readings = replay.readings_in_all();
  if (run.features.size() <= run.first_ticks) {
    const double tick_s = run.tick_period_us / 1e6;
    throw InputError(label.word, 0,
                     number_text(static_cast<double>(run.features.size()) * tick_s) + " s of a recording",
                     "more than " + number_text(static_cast<double>(run.first_ticks) * tick_s) +
                         " s: features follow what is sensed within three windows");
  }
  return run;
}

void check_together(const std::vector<LabelledRun>& runs) {
  const LabelledRun& first = runs.front();
  const auto refuse = [&first](const LabelledRun& run, const std::string& found, const std::string& expected) {
    throw InputError(run.label.file, 0, found, expected + ", as in " + first.label.file);
  };
  const auto robot_of = [](const LabelledRun& run) {
    return "a robot of " + std::to_string(run.joints) + " joints and a tick of " +
           number_text(run.tick_period_us / 1e3) + " ms";
  };
  const auto group_of = [](const LabelledRun& run) {
    std::string digits;
    for (const bool is_driven : run.joint_group) {
      digits += is_driven ? '1' : '0';
    }
    return "a selector on the joints " + digits;
  };
  for (const LabelledRun& run : runs) {
    if (run.joints != first.joints || run.tick_period_us != first.tick_period_us) {
      refuse(run, robot_of(run), robot_of(first));
    }
    if (run.joint_group != first.joint_group) {
      refuse(run, group_of(run), group_of(first));
    }
    for (std::size_t set = 0; set < run.parameters_of_set.size(); ++set) {
      if (run.parameters_of_set[set] != first.parameters_of_set[set]) {
        const std::string name = "set " + std::to_string(set + 1);
        refuse(run, name + " with other parameters", "the same gait in " + name);
      }
    }
    const auto overlaps = [&run](const LabelledRun& other) {
      const double end = std::numeric_limits<double>::infinity();
      return &other != &run && same_file(other) == same_file(run) &&
             other.label.from_s.value_or(0.0) < run.label.to_s.value_or(end) &&
             run.label.from_s.value_or(0.0) < other.label.to_s.value_or(end);
    };
    if (const auto other = std::ranges::find_if(runs, overlaps); other != runs.end()) {
      throw InputError(run.label.word, 0, "seconds that are also in " + other->label.word,
                       "each second of a recording once; two sets are right as 1,2=FILE");
    }
  }
}

std::vector<bool> forget_untried_entries(std::vector<LabelledRun>& runs) {
  std::set<std::uint32_t> tried;  // labels of which another set was played
  for (const LabelledRun& run : runs) {
    // Each recording begins with set 1, which says nothing of the other sets.
    const auto is_other = [&run](std::int32_t set) { return (run.right_sets() & bit_of_set(set)) == 0; };
    if (2 * static_cast<std::size_t>(std::ranges::count_if(run.played, is_other)) > run.played.size()) {
      tried.insert(run.right_sets());
    }
  }
  std::vector<bool> forgotten;
  for (LabelledRun& run : runs) {
    forgotten.push_back(!tried.contains(run.right_sets()));
    if (forgotten.back()) {
      std::ranges::fill(run.played, 0);
    }
  }
  return forgotten;
}

RunDecisions decide(const LabelledRun& run, const LearnedRules& rules, std::int32_t dwell_ms) {
  const DecisionList list(rules.rules.data(), gait_sets);
  // The decision before has to be known to all joints (SensingModule_gait_selector).
  constexpr std::uint32_t spare_ticks = 8;
  const std::uint32_t wait = std::max(ticks_of(dwell_ms, run.tick_period_us), run.joints + spare_ticks);
  RunDecisions result;
  std::int32_t set = std::max(run.played.front(), std::int32_t{1});
  std::uint32_t since = wait;
  for (std::size_t tick = 0; tick < run.features.size(); ++tick) {
    const std::int32_t before = set;
    if (since >= wait) {
      set = list.choose(run.features[tick].data(), run.played[tick], rules.hysteresis);
    }
    since = set == before ? since + 1 : 0;
    if (tick >= run.first_ticks) {
      ++result.ticks;
      result.right += (run.right_sets() & bit_of_set(set)) != 0 ? 1U : 0U;
      result.changes += run.gait(set) == run.gait(before) ? 0U : 1U;
    }
  }
  result.seconds = static_cast<double>(result.ticks) * run.tick_period_us / 1e6;
  return result;
}

std::vector<RunDecisions> try_on_unseen(const std::vector<LabelledRun>& runs, std::uint32_t usable,
                                        const std::optional<std::int32_t>& hysteresis, std::int32_t dwell_ms) {
  const std::vector<std::uint32_t> parts = parts_of(runs);
  std::vector<RunDecisions> result(runs.size());
  for (std::uint32_t part = 0; part <= std::ranges::max(parts); ++part) {
    std::vector<const LabelledRun*> others;
    std::set<std::uint32_t> learned;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (parts[i] != part) {
        others.push_back(&runs[i]);
        learned.insert(runs[i].right_sets());
      }
    }
    if (learned.size() < 2) {
      continue;
    }
    const LearnedRules rules = learn_rules(examples_of(others), usable, hysteresis);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (parts[i] == part && learned.contains(runs[i].right_sets())) {
        result[i] = decide(runs[i], rules, dwell_ms);
      }
    }
  }
  return result;
}

std::vector<RuleExample> examples_of(const std::vector<const LabelledRun*>& runs) {
  std::vector<RuleExample> examples;
  for (const LabelledRun* run : runs) {
    const std::size_t ticks = run->features.size() - run->first_ticks;
    const std::size_t count = std::min({ticks, most_examples_of_run, most_examples / runs.size() + 1});
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t tick = run->first_ticks + i * ticks / count;
      examples.push_back({run->features[tick], run->right_sets(), run->played[tick]});
    }
  }
  return examples;
}

}  // namespace proleg::optimize
