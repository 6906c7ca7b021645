#include "sim/optimize/adaptation/labelled_recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/gait/algorithms.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::optimize {
namespace {

/// The caterpillar of the thesis with a selector. rules: --set words.
sim::Scenario selecting(const std::vector<std::string>& rules) {
  sim::Scenario scenario = sim::shipped("travelling_wave/coupled");
  scenario.kernel.slots = {};
  scenario.kernel.slots[0] = {&sensing_module_gait_selector(), JointMask::first(scenario.kernel.joint_count)};
  scenario.settings.clear();
  for (const std::string& word : rules) {
    sim::apply_setting(scenario, word);
  }
  return scenario;
}

void record_run(const sim::Scenario& scenario, std::uint32_t ticks, const std::filesystem::path& path) {
  sim::Simulation simulation(scenario);
  sim::Recorder recorder(path, scenario, "test", "build");
  while (simulation.tick() < ticks) {
    simulation.advance();
    recorder.record_tick(simulation.sample());
  }
  recorder.finish({});
}

std::string refusal_of(const std::string& word) {
  try {
    (void)parse_recording_label(word);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

class LabelledRecording : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  TemporaryFolder folder_;
};

// Six features fit into the rules at once.
TEST_F(LabelledRecording, HasTheFeaturesThatTheModuleComputed) {
  const std::vector<std::vector<std::string>> rules{
      {"feature_2=1", "threshold_2=7", "second_feature_2=2", "second_threshold_2=7", "feature_3=3", "threshold_3=7",
       "second_feature_3=4", "second_threshold_3=7", "feature_4=5", "threshold_4=7", "second_feature_4=6",
       "second_threshold_4=7"},
      {"feature_2=7", "threshold_2=7", "second_feature_2=8", "second_threshold_2=7"}};
  for (std::size_t half = 0; half < rules.size(); ++half) {
    std::vector<std::string> words = rules[half];
    words.insert(words.end(), {"window=300", "amplitude_1=55", "phase_difference_1=80"});
    record_run(selecting(words), 400, file("run.proleg"));
    const LabelledRun run = read_labelled_run(parse_recording_label("1=" + file("run.proleg")), 300);
    ASSERT_EQ(run.features.size(), 400U);
    EXPECT_EQ(run.played, std::vector<std::int32_t>(400, 1));
    EXPECT_EQ(run.first_ticks, 90U);
    EXPECT_EQ(run.readings & JointReadings::inclination, unsigned{JointReadings::inclination});

    const sim::Recording recording(file("run.proleg"));
    std::size_t first = 0;
    while (recording.internal_values()[first].joint != 0 || recording.internal_values()[first].name != "pitch") {
      ++first;
    }
    const std::size_t from = half == 0 ? 0 : 6;
    const std::size_t to = half == 0 ? 6 : 8;
    bool is_moved = false;
    recording.read_ticks(0, 399, [&](const sim::RecordedTick& tick) {
      for (std::size_t feature = from; feature < to; ++feature) {
        // The set-point before the first tick is not in a recording.
        const std::int32_t tolerance =
            feature != GaitFeatures::tracking_error ? 0 : (tick.tick < run.first_ticks ? 1 << 24 : 1 << 12);
        ASSERT_NEAR(run.features[tick.tick][feature], tick.internal_values[first + feature], tolerance)
            << "tick " << tick.tick << ", feature " << feature;
        is_moved = is_moved || tick.internal_values[first + feature] != 0;
      }
    });
    EXPECT_TRUE(is_moved);
  }
}

TEST_F(LabelledRecording, IsTheWholeOneOrAPartOfIt) {
  record_run(selecting({}), 300, file("run@1-2.proleg"));
  const std::string name = file("run@1-2.proleg");
  const LabelledRun whole = read_labelled_run(parse_recording_label("2=" + name), 100);
  const LabelledRun part = read_labelled_run(parse_recording_label("2=" + name + "@1.5-2.25"), 100);
  EXPECT_EQ(whole.features.size(), 300U);
  ASSERT_EQ(part.features.size(), 75U);
  EXPECT_EQ(part.features.front(), whole.features[150]);
  EXPECT_EQ(part.features.back(), whole.features[224]);
  EXPECT_THROW((void)read_labelled_run(parse_recording_label("2=" + name + "@0-0.3"), 100), InputError)
      << "not longer than three windows";
  EXPECT_THROW((void)read_labelled_run(parse_recording_label("2=" + name + "@7-9"), 100), InputError);
}

TEST_F(LabelledRecording, HasNoSecondsBehindItsEnd) {
  record_run(selecting({}), 300, file("run.proleg"));
  const std::string word = "2=" + file("run.proleg");
  EXPECT_EQ(read_labelled_run(parse_recording_label(word + "@0-3"), 100).features.size(), 300U);
  for (const char* times : {"@0-99", "@0-3.5", "@7-9"}) {
    try {
      (void)read_labelled_run(parse_recording_label(word + times), 100);
      ADD_FAILURE() << times;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("expected seconds to 3:"), std::string::npos) << error.what();
    }
  }
}

TEST_F(LabelledRecording, ThatIsThereHasATimeThatIsNamedIfItIsNone) {
  record_run(selecting({}), 5, file("run.proleg"));
  for (const char* time : {"1,5-3", "1.5", "1-", "-3", "1s-3s", ""}) {
    EXPECT_NE(refusal_of("1=" + file("run.proleg") + "@" + time).find("found the time '" + std::string(time) + "'"),
              std::string::npos)
        << refusal_of("1=" + file("run.proleg") + "@" + time);
  }
  EXPECT_NE(refusal_of("1=" + file("run.proleg") + "@5-3").find("5 s to 3 s"), std::string::npos);
}

TEST_F(LabelledRecording, OfAnotherAlgorithmIsRefusedByName) {
  record_run(sim::shipped("travelling_wave/coupled"), 20, file("run.proleg"));
  try {
    (void)read_labelled_run(parse_recording_label("1=" + file("run.proleg")), 10);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("PatternGenerator_coupled_oscillator"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("SensingModule_gait_selector"), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)selector_times(sim::Recording(file("run.proleg"))), InputError);
}

TEST_F(LabelledRecording, HasTheTimesOfItsSelector) {
  record_run(selecting({"window=1234"}), 5, file("run.proleg"));
  const SelectorTimes times = selector_times(sim::Recording(file("run.proleg")));
  EXPECT_EQ(times.window_ms, 1234);
  EXPECT_EQ(times.dwell_ms, 3000) << "the default";
}

TEST(RecordingLabels, AreASetAFileAndOptionallySeconds) {
  const RecordingLabel plain = parse_recording_label("3=a=b.proleg");
  EXPECT_EQ(plain.sets, (std::vector<std::int32_t>{3}));
  EXPECT_EQ(plain.file, "a=b.proleg");
  EXPECT_FALSE(plain.from_s);
  EXPECT_EQ(parse_recording_label("4,1=a").sets, (std::vector<std::int32_t>{4, 1}));
  const RecordingLabel part = parse_recording_label("1=at@home-2.proleg@2.5-10");
  EXPECT_EQ(part.file, "at@home-2.proleg");
  EXPECT_EQ(part.from_s, 2.5);
  EXPECT_EQ(part.to_s, 10.0);
  EXPECT_EQ(parse_recording_label("1=at@home-2.proleg").file, "at@home-2.proleg");
  for (const char* word : {"", "flat.proleg", "0=a", "5=a", "x=a", "=a", "2=", "2=@1-2", "1.5=a", "2=a@5-5", "2=a@7-3",
                           ",1=a", "1,=a", "1,5=a"}) {
    EXPECT_NE(refusal_of(word).find("expected SET=FILE"), std::string::npos) << word << ": " << refusal_of(word);
  }
}

/// Touch follows a square wave: 2 s of 0, then 2 s of 1.
LabelledRun square_wave(std::int32_t set) {
  LabelledRun run;
  run.label.sets = {set};
  run.label.file = "of set " + std::to_string(set);
  run.tick_period_us = 10'000;
  run.joints = 5;
  run.readings = JointReadings::all_sensors;
  run.features.resize(2000);
  run.played.resize(2000, 1);
  for (std::size_t tick = 0; tick < run.features.size(); ++tick) {
    run.features[tick][GaitFeatures::touch] = tick / 200 % 2 == 0 ? 0 : 1 << 28;
  }
  return run;
}

TEST(Decisions, AreThoseOfASelectorWithTheseRules) {
  const LearnedRules touching{.rules = {4, 1 << 27, 0, 0}};  // set 2 where touch is above 0.5
  LabelledRun run = square_wave(2);
  const RunDecisions quick = decide(run, touching, 0);
  EXPECT_EQ(quick.ticks, 2000U);
  EXPECT_NEAR(static_cast<double>(quick.right), 1000, 20) << "but for the ticks in which a decision goes round";
  EXPECT_EQ(quick.changes, 9U);
  EXPECT_DOUBLE_EQ(quick.seconds, 20.0);
  EXPECT_LT(decide(run, touching, 3'000).changes, 6U) << "a decision, then 3 s";
  run.first_ticks = 1000;
  EXPECT_EQ(decide(run, touching, 0).ticks, 1000U);
}

TEST(Decisions, HoldLongerForTheSetThatIsPlayed) {
  LearnedRules touching{.rules = {4, 1 << 27, 0, 0}, .hysteresis = (1 << 27) + 1};
  LabelledRun run = square_wave(2);
  run.played.assign(run.features.size(), 2);
  EXPECT_EQ(decide(run, touching, 0).right, 2000U) << "set 2 holds until touch is below 0";
  touching.hysteresis = 0;
  EXPECT_LT(decide(run, touching, 0).right, 1100U);
}

TEST(Decisions, AreRightWithEachSetOfTheLabelAndWithTheSameGait) {
  const LearnedRules touching{.rules = {4, 1 << 27, 0, 0}};
  LabelledRun run = square_wave(3);
  EXPECT_LE(decide(run, touching, 0).right, 0U);
  run.gait_of_set = {1, 2, 2, 4};
  EXPECT_EQ(run.right_sets(), 0b0110U);
  EXPECT_GT(decide(run, touching, 0).right, 900U) << "sets 2 and 3 have the same gait";
  run.label.sets = {3, 1};
  EXPECT_EQ(decide(run, touching, 0).right, 2000U);
  run.gait_of_set = {1, 1, 3, 4};
  EXPECT_EQ(decide(run, touching, 0).changes, 0U) << "both have one gait";
}

LabelledRun constant_touch(std::int32_t set, double value, const std::string& file) {
  LabelledRun run = square_wave(set);
  run.label.file = file;
  for (FeatureValues& features : run.features) {
    features[GaitFeatures::touch] = static_cast<std::int32_t>(std::ldexp(value, 28));
  }
  return run;
}

TEST(Entries, AreUntriedIfTheSetsOfALabelWerePlayedInAllItsRuns) {
  // On both grounds the robot senses the same; hysteresis would keep set 2 where it was played.
  std::vector<LabelledRun> runs{constant_touch(1, 0.2, "a"), constant_touch(2, 0.2, "b")};
  runs[1].played.assign(runs[1].played.size(), 2);
  const LearnedRules kept{.rules = {4, static_cast<std::int32_t>(0.21 * (1 << 28)), 0, 0}, .hysteresis = 1 << 26};
  EXPECT_EQ(decide(runs[1], kept, 0).right, 2000U);
  EXPECT_EQ(forget_untried_entries(runs), (std::vector<bool>{true, true}));
  EXPECT_EQ(decide(runs[1], kept, 0).right, 0U) << "from another set the robot would not come there";
  EXPECT_EQ(decide(runs[0], kept, 0).right, 2000U);
  for (const RuleExample& example : examples_of({&runs[1]})) {
    EXPECT_EQ(example.played, 0);
  }
}

TEST(Entries, AreTriedInARunThatPlayedAnotherSet) {
  std::vector<LabelledRun> runs{constant_touch(1, 0.2, "a"), constant_touch(2, 0.8, "b"), constant_touch(2, 0.7, "c")};
  runs[1].played.assign(runs[1].played.size(), 2);
  EXPECT_EQ(forget_untried_entries(runs), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(runs[1].played.front(), 2);
}

std::string message_of(const std::vector<LabelledRun>& runs) {
  try {
    check_together(runs);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(LabelledRuns, BelongTogether) {
  const std::vector<LabelledRun> good{constant_touch(1, 0.2, "a"), constant_touch(2, 0.8, "b")};
  EXPECT_EQ(message_of(good), "no error");
  std::vector<LabelledRun> runs = good;
  runs[1].joints = 6;
  EXPECT_EQ(message_of(runs),
            "b: found a robot of 6 joints and a tick of 10 ms, expected a robot of 5 joints and a "
            "tick of 10 ms, as in a");
  runs = good;
  runs[1].joint_group = {false, true};
  EXPECT_NE(message_of(runs).find("b: found a selector on the joints 01"), std::string::npos) << message_of(runs);
  runs = good;
  runs[1].parameters_of_set[1] = {5};
  EXPECT_EQ(message_of(runs), "b: found set 2 with other parameters, expected the same gait in set 2, as in a");
}

TEST(LabelledRuns, HaveEachSecondOfARecordingOnce) {
  std::vector<LabelledRun> runs{constant_touch(1, 0.2, "a"), constant_touch(2, 0.8, "./a")};
  runs[1].label.word = "2=./a";
  EXPECT_NE(message_of(runs).find("found seconds that are also in 2=./a"), std::string::npos) << message_of(runs);
  runs[0].label.to_s = 10;
  runs[1].label.from_s = 10;
  EXPECT_EQ(message_of(runs), "no error");
}

TEST(UnseenRuns, AreDecidedByRulesFromTheOtherFiles) {
  constexpr std::uint32_t touch_only = 1U << GaitFeatures::touch;
  std::vector<LabelledRun> runs{constant_touch(1, 0.1, "a"), constant_touch(1, 0.2, "b"), constant_touch(2, 0.8, "c"),
                                constant_touch(2, 0.9, "d")};
  for (const RunDecisions& each : try_on_unseen(runs, touch_only, 0, 0)) {
    EXPECT_EQ(each.ticks, 2000U);
    EXPECT_GE(each.right, 1980U) << "but for the ticks before the first decision";
  }
  // A recording that is unlike the others of its set is right only where it was learned.
  runs[3] = constant_touch(2, 0.15, "d");
  const std::vector<RunDecisions> odd = try_on_unseen(runs, touch_only, 0, 0);
  EXPECT_EQ(odd[3].right, 0U);
  // The only file of a set cannot be tried, whatever it is called.
  runs[3].label.file = "./c";
  const std::vector<RunDecisions> single = try_on_unseen(runs, touch_only, 0, 0);
  EXPECT_EQ(single[2].ticks, 0U);
  EXPECT_EQ(single[3].ticks, 0U);
}

}  // namespace
}  // namespace proleg::optimize
