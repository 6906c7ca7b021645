#pragma once

// Recordings of robots with SensingModule_gait_selector, of which a person says which set of parameters should have
// been played.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/optimize/adaptation/rule_learner.hpp"
#include "sim/record/recording.hpp"

namespace proleg::optimize {

/// A word of the command line: SETS=FILE or SETS=FILE@FROM-TO, where SETS is a set or several with commas.
struct RecordingLabel {
  std::string word;
  std::vector<std::int32_t> sets;  ///< of which each is right, 1 to gait_sets; at least one
  std::string file;
  std::optional<double> from_s;  ///< part of the recording: seconds from its start
  std::optional<double> to_s;    ///< later than from_s
};

/// Throws InputError with the word as its file.
[[nodiscard]] RecordingLabel parse_recording_label(const std::string& word);

/// Times of a selector.
struct SelectorTimes {
  std::int32_t window_ms = 2'000;
  std::int32_t dwell_ms = 3'000;
};

/// A part of a recording: what the selector's features were, tick by tick.
struct LabelledRun {
  RecordingLabel label;
  std::uint32_t tick_period_us = 0;
  std::uint32_t joints = 0;
  std::vector<bool> joint_group;  ///< joints that the selector drives
  /// The parameters of each set at the start, of all these joints.
  std::array<std::vector<std::int32_t>, gait_sets> parameters_of_set;
  /// Of each set the least one with the same parameters, from 1.
  std::array<std::int32_t, gait_sets> gait_of_set{1, 2, 3, 4};
  std::uint32_t readings = 0;           ///< sensors that the deciding joint had in every tick: JointReadings::Sensor
  std::vector<FeatureValues> features;  ///< of each tick of the part
  /// The set that was played then. 0 from forget_untried_entries(): any other than the right ones.
  std::vector<std::int32_t> played;

  [[nodiscard]] std::int32_t gait(std::int32_t set) const { return gait_of_set[static_cast<std::size_t>(set - 1)]; }
  /// The sets of the label, and others with the same gaits: bit n - 1 for set n.
  [[nodiscard]] std::uint32_t right_sets() const;
  /// Ticks at the beginning of the part in which the features still follow: three windows.
  std::size_t first_ticks = 0;
};

/// The first selector of a recording. Throws InputError if there is none.
[[nodiscard]] const sim::RecordedSlot& selector_slot(const sim::Recording& recording);

/// The times of the selector in a recording, at its start. Throws InputError if there is no selector in it.
[[nodiscard]] SelectorTimes selector_times(const sim::Recording& recording);

/// Computes all features as the module that decides would with this window. Throws InputError if the recording has no
/// selector, a parameter of its sets changes during the recording, or the part is not longer than three windows.
[[nodiscard]] LabelledRun read_labelled_run(const RecordingLabel& label, std::int32_t window_ms);

/// Throws InputError if a run does not belong to the first one: its robot has other joints or another tick, the
/// selector drives other joints, its sets have other parameters, or a second of its recording is also in another run.
void check_together(const std::vector<LabelledRun>& runs);

/// Hysteresis only says when a set ends. If the sets of a label were mostly played in all runs of it, nothing tells
/// whether the robot would choose them while it plays another one. This takes such runs as if none of the right sets
/// were played. Returns for each run whether it did.
std::vector<bool> forget_untried_entries(std::vector<LabelledRun>& runs);

/// What a selector would have chosen in each tick, while the robot played what it played.
struct RunDecisions {
  std::size_t ticks = 0;    ///< after the first_ticks
  std::size_t right = 0;    ///< of these, in which a gait of the label was chosen
  std::size_t changes = 0;  ///< of the gait, in these ticks
  double seconds = 0.0;     ///< that these ticks take
};
/// With hysteresis, and with the dwell time between two decisions.
[[nodiscard]] RunDecisions decide(const LabelledRun& run, const LearnedRules& rules, std::int32_t dwell_ms);

/// What rules decide on recordings that they were not learned from: divides the runs of each label into up to 10 parts,
/// in their order, and decides each with rules that were learned from all others. The runs of one file are in one part,
/// because neighbouring ticks are alike. Returns the decisions in the order of the runs; a run whose gaits are
/// right in no other file has no ticks. usable and hysteresis: as in learn_rules().
[[nodiscard]] std::vector<RunDecisions> try_on_unseen(const std::vector<LabelledRun>& runs, std::uint32_t usable,
                                                      const std::optional<std::int32_t>& hysteresis,
                                                      std::int32_t dwell_ms);

/// Examples from the ticks of runs after their first_ticks: up to so many of each run, evenly spaced.
[[nodiscard]] std::vector<RuleExample> examples_of(const std::vector<const LabelledRun*>& runs);

}  // namespace proleg::optimize
