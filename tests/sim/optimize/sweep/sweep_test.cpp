#include "sim/optimize/sweep/sweep.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "memory_files.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/optimize/sweep/sweep_request.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::optimize {
namespace {

/// settings: words of --set.
Sweep sweep_over(const std::vector<std::string>& words, const std::vector<std::string>& settings = {}) {
  sim::Scenario scenario = sim::small_scenario().scenario();
  for (const std::string& setting : settings) {
    sim::apply_setting(scenario, setting);
  }
  return read_sweep(std::move(scenario), words, settings);
}

std::vector<std::string> values(const std::string& word) { return sweep_over({word}).quantities.at(0).values; }

std::string refusal(const std::vector<std::string>& words, const std::vector<std::string>& settings = {}) {
  return message_of<InputError>([&] { static_cast<void>(sweep_over(words, settings)); });
}

TEST(Sweep, ValuesGoFromFirstToLastInSteps) {
  EXPECT_EQ(values("amplitude=10:50:20"), (std::vector<std::string>{"10", "30", "50"}));
  EXPECT_EQ(values("amplitude=10:45:20"), (std::vector<std::string>{"10", "30"})) << "no step ends at 45";
  EXPECT_EQ(values("seed=8:11"), (std::vector<std::string>{"8", "9", "10", "11"})) << "the step is 1";
  EXPECT_EQ(values("amplitude=7"), std::vector<std::string>{"7"});
  EXPECT_EQ(values("offset=-1:1:0.5"), (std::vector<std::string>{"-1", "-0.5", "0", "0.5", "1"}));
}

TEST(Sweep, StepsOfATenthAddUpWithoutRounding) {
  const std::vector<std::string> tenths = values("friction=0:1:0.1");
  ASSERT_EQ(tenths.size(), 11U);
  EXPECT_EQ(tenths[3], "0.3");
  EXPECT_EQ(tenths[10], "1");
  EXPECT_EQ(values("friction=0.05:0.2:0.05"), (std::vector<std::string>{"0.05", "0.1", "0.15", "0.2"}));
}

TEST(Sweep, TheLastQuantityVariesFastest) {
  const Sweep sweep = sweep_over({"amplitude=1:2", "seed=5:7"});
  ASSERT_EQ(sweep.size(), 6U);
  EXPECT_EQ(sweep.combination(0), (Candidate{0, 0}));
  EXPECT_EQ(sweep.combination(2), (Candidate{0, 2}));
  EXPECT_EQ(sweep.combination(3), (Candidate{1, 0}));
}

TEST(Sweep, ACombinationSetsParameterSeedAndFriction) {
  const Sweep sweep = sweep_over({"frequency=2:3", "seed=5:7", "friction=0.5:0.7:0.2"});
  const sim::Scenario scenario = sweep.scenario_of({1, 2, 1});
  EXPECT_EQ(scenario.kernel.seed, 7U);
  EXPECT_EQ(scenario.environment.objects.at(0).geometries.at(0).friction, 0.7);
  sim::Scenario expected = sim::small_scenario().scenario();
  sim::apply_setting(expected, "frequency=3");
  ASSERT_EQ(scenario.settings.size(), expected.settings.size());
  for (std::size_t i = 0; i < expected.settings.size(); ++i) {
    EXPECT_EQ(scenario.settings[i].value, expected.settings[i].value);
  }
}

sim::Scenario read_with(const sim::OverrideWords& words) {
  auto files = sim::small_scenario();
  return sim::read_scenario("top.xml", files, sim::read_overrides(words));
}

TEST(Sweep, ACombinationStartsWhereTheOptionsPutTheRobot) {
  const Sweep sweep = sweep_over({"y=-0.5:0.5:0.25", "heading=0:90:45", "x=2"});
  sim::OverrideWords words;
  words.at = "2,-0.25";
  words.heading = "90";
  const sim::Pose expected = read_with(words).environment.robot_pose;
  const sim::Pose start = sweep.scenario_of({1, 2, 0}).environment.robot_pose;
  EXPECT_EQ(start.position, expected.position);
  EXPECT_EQ(start.orientation.coeffs(), expected.orientation.coeffs());
  EXPECT_EQ(sweep.quantities[0].unit, "m");
  EXPECT_EQ(sweep.quantities[1].unit, "deg");
}

TEST(Sweep, RefusesWordsThatAreNoRange) {
  for (const char* word : {"amplitude", "=1:2", "amplitude=", "amplitude=1:2:3:4", "amplitude=1:x", "amplitude=1e3",
                           "amplitude=1:2:", "amplitude=1234567890123456"}) {
    EXPECT_TRUE(refusal({word}).starts_with(std::string("--over ") + word + ": found ")) << refusal({word});
  }
  EXPECT_NE(refusal({"amplitude=3:1"}).find("an ascending range"), std::string::npos);
  EXPECT_NE(refusal({"amplitude=1:3:0"}).find("a step that is not above 0"), std::string::npos);
  EXPECT_NE(refusal({"amplitude=1:3:-1"}).find("a step that is not above 0"), std::string::npos);
  EXPECT_NE(refusal({"amplitude=0.00000000001:900000000000000"}).find("similar size"), std::string::npos);
  EXPECT_NE(refusal({"seed=1:2", "seed=3:4"}).find("'seed' twice"), std::string::npos);
  EXPECT_NE(refusal({}).find("--over"), std::string::npos);
}

TEST(Sweep, RefusesValuesThatTheScenarioRejects) {
  EXPECT_EQ(refusal({"amplitud=1:2"}).substr(0, 12), "amplitud=1: ");
  EXPECT_NE(refusal({"amplitude=80:100:10"}).find("amplitude=100: found"), std::string::npos);
  EXPECT_NE(refusal({"amplitude:J9=1:2"}).find("'J9'"), std::string::npos);
  EXPECT_NE(refusal({"seed=-1:2"}).find("'-1'"), std::string::npos);
  EXPECT_NE(refusal({"seed=1:2:0.5"}).find("'1.5'"), std::string::npos);
  EXPECT_NE(refusal({"friction=-1:2"}).find("0 to 1000"), std::string::npos);
}

TEST(Sweep, RefusesMoreThanAHundredThousandRuns) {
  EXPECT_EQ(refusal({"seed=1:100000"}), "");
  EXPECT_NE(refusal({"seed=1:100001"}).find("at most 100000 runs"), std::string::npos);
  EXPECT_EQ(refusal({"seed=1:1000", "frequency=0.1:10:0.1"}), "");
  EXPECT_NE(refusal({"seed=1:1001", "frequency=0.1:10:0.1"}).find("at most 100000 runs"), std::string::npos);
}

TEST(Sweep, RefusesAValueThatIsStatedTwice) {
  const auto second = [](const std::string& over, const std::string& setting) { return refusal({over}, {setting}); };
  EXPECT_EQ(second("amplitude=10:20", "amplitude=30"),
            "--over amplitude=10:20: found --set amplitude=30 as well, expected one of the two");
  EXPECT_NE(second("1.amplitude=10:20", "amplitude:J2=30"), "") << "the setting has no effect";
  EXPECT_NE(second("amplitude:J2=10:20", "amplitude=30@0"), "") << "the swept value has no effect";
  EXPECT_NE(refusal({"amplitude:J2=10:20", "amplitude=30:40"}).find("found --over amplitude:J2=10:20 as well"),
            std::string::npos);
}

TEST(Sweep, AcceptsASecondValueThatHasAnEffectBesideIt) {
  EXPECT_EQ(refusal({"amplitude:J2=10:20"}, {"amplitude=30"}), "") << "of the other joints";
  EXPECT_EQ(refusal({"amplitude=10:20"}, {"amplitude=30@5"}), "") << "later in the run";
  EXPECT_EQ(refusal({"amplitude=10:20"}, {"frequency=2"}), "");
  EXPECT_EQ(refusal({"amplitude=10:20", "amplitude:J2=30:40"}), "") << "first all joints, then one";
}

TEST(Sweep, RefusesAnOverrideOfWhatItSweeps) {
  sim::Scenario scenario = sim::small_scenario().scenario();
  scenario.overrides.seed = 7;
  scenario.overrides.friction = 0.25;
  scenario.overrides.at.emplace(1.0, 2.0);
  scenario.overrides.heading_deg = 30.0;
  const auto refusal_of = [&](const std::string& word) {
    const std::vector<std::string> words{word};
    return message_of<InputError>([&] { static_cast<void>(read_sweep(scenario, words)); });
  };
  EXPECT_EQ(refusal_of("seed=1:2"), "--over seed=1:2: found --seed 7 as well, expected one of the two");
  EXPECT_EQ(refusal_of("friction=0:1"), "--over friction=0:1: found --friction 0.25 as well, expected one of the two");
  EXPECT_EQ(refusal_of("y=0:1"), "--over y=0:1: found --at 1,2 as well, expected one of the two");
  EXPECT_EQ(refusal_of("heading=0:1"), "--over heading=0:1: found --heading 30 as well, expected one of the two");
  EXPECT_EQ(refusal_of("amplitude=1:2"), "");
}

TEST(Sweep, StatesTheCommandThatRepeatsIt) {
  Sweep sweep = sweep_over({"amplitude=10:20:5", "friction=0.1:0.2:0.1"}, {"frequency=2", "phase_difference=3@5"});
  EXPECT_EQ(fixed_options(sweep), "--set frequency=2 --set phase_difference=3@5 --seconds 2");
  sweep.scenario.overrides = {sim::PhysicsEngine::reduced, 7, 0.25, Eigen::Vector2d(1.0, -2.5), 0.5, -30.0};
  EXPECT_EQ(command_of(sweep),
            "proleg sweep top.xml --over amplitude=10:20:5 --over friction=0.1:0.2:0.1 --set frequency=2 --set "
            "phase_difference=3@5 --seconds 2 --engine reduced --seed 7 --friction 0.25 --at 1,-2.5,0.5 --heading -30");
}

/// Answers in the opposite order of the tasks, two at a time.
class BackwardWorkers final : public Workers {
 public:
  [[nodiscard]] std::uint32_t count() const override { return 2; }
  [[nodiscard]] std::uint32_t idle() const override {
    return 2 - std::min(2U, static_cast<std::uint32_t>(tasks_.size()));
  }
  void start(std::span<const TicketedTask> batch) override { tasks_.insert(tasks_.end(), batch.begin(), batch.end()); }
  [[nodiscard]] std::optional<Done> wait(std::chrono::milliseconds /*timeout*/) override {
    const auto [ticket, task] = tasks_.back();
    tasks_.pop_back();
    TrialResult result;
    result.measures[sim::Measure::distance] = task.candidate[0] * 10.0 + task.candidate[1];
    return Done{ticket, result, 0};
  }
  [[nodiscard]] std::vector<std::string> messages() override { return {}; }

 private:
  std::vector<TicketedTask> tasks_;
};

TEST(Sweep, ResultsAreInTheOrderOfTheCombinations) {
  const Sweep sweep = sweep_over({"amplitude=1:3", "seed=1:4"});
  BackwardWorkers workers;
  const std::vector<SweepRun> runs = run_sweep(
      sweep, workers, {}, [] { return false; }, [](std::span<const SweepRun>) {});
  ASSERT_EQ(runs.size(), 12U);
  for (std::uint64_t i = 0; i < runs.size(); ++i) {
    EXPECT_EQ(runs[i].number, i);
    EXPECT_EQ(runs[i].result.measures[sim::Measure::distance], static_cast<double>(i / 4 * 10 + i % 4));
  }
}

TEST(Sweep, AnInterruptionLeavesWhatIsDone) {
  const Sweep sweep = sweep_over({"amplitude=1:3", "seed=1:4"});
  BackwardWorkers workers;
  std::vector<SweepRun> done;
  const std::vector<SweepRun> runs = run_sweep(
      sweep, workers, {}, [&] { return done.size() == 5; },
      [&](std::span<const SweepRun> so_far) { done.assign(so_far.begin(), so_far.end()); });
  EXPECT_EQ(runs.size(), 5U);
  EXPECT_TRUE(std::ranges::is_sorted(runs, {}, &SweepRun::number));

  BackwardWorkers others;
  std::size_t calls = 0;
  const std::vector<SweepRun> all = run_sweep(
      sweep, others, done, [] { return false; }, [&](std::span<const SweepRun>) { ++calls; });
  EXPECT_EQ(calls, 7U) << "no run is simulated again";
  ASSERT_EQ(all.size(), 12U);
  for (std::uint64_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].number, i);
  }
}

TrialResult run_combination(const Sweep& sweep, const Candidate& combination) {
  const Task task{0, 0, 0, combination, {}};
  return run_combinations(sweep, {&task, 1}).front();
}

TEST(Sweep, ACombinationIsSimulatedUpToItsEnd) {
  const TrialResult result = run_combination(sweep_over({"amplitude=20"}), {0});
  EXPECT_EQ(result.failure, "");
  EXPECT_DOUBLE_EQ(result.simulated_s, 2.0);
  EXPECT_TRUE(std::isfinite(result.measures[sim::Measure::distance]));
  EXPECT_EQ(result.limited_joints, 0U);
}

TEST(Sweep, GivesABatchTheResultsOfSingleRuns) {
  sim::DiskFiles files;
  sim::Scenario scenario = sim::read_scenario(
      std::filesystem::path(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml")), files);
  scenario.duration_s = 0.5;
  scenario.environment.engine = sim::PhysicsEngine::reduced;
  const Sweep sweep =
      read_sweep(std::move(scenario), std::vector<std::string>{"amplitude=10:40:10", "friction=0.2:0.3:0.1"});
  std::vector<Task> tasks;
  for (std::uint64_t i = 0; i < sweep.size(); ++i) {
    tasks.push_back({0, i, 0, sweep.combination(i), {}});
  }
  const std::vector<TrialResult> together = run_combinations(sweep, tasks);
  ASSERT_EQ(together.size(), 8U);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    EXPECT_EQ(together[i].measures[sim::Measure::distance],
              run_combination(sweep, tasks[i].candidate).measures[sim::Measure::distance]);
  }
  EXPECT_NE(together[0].measures[sim::Measure::distance], together[2].measures[sim::Measure::distance]);
}

TEST(Sweep, CountsTheJointsWhoseServosCannotFollow) {
  const Sweep sweep = sweep_over({"amplitude=80"}, {"frequency=8"});  // 80 degrees at 8 Hz are 70 rad/s
  EXPECT_EQ(run_combination(sweep, {0}).limited_joints, sweep.scenario.robot.joints.size());
}

TEST(Sweep, AFailedSimulationNamesItsReason) {
  sim::MemoryFiles files = sim::small_scenario();
  files.replace("environment.xml", "0 0 0.1,", "0 0 -20,").replace("environment.xml", "0 0 -0.5", "100 0 -0.5");
  const std::vector<std::string> words{"amplitude=20"};
  const TrialResult result = run_combination(read_sweep(files.scenario(), words), {0});
  EXPECT_NE(result.failure, "");
  EXPECT_TRUE(std::isnan(result.measures[sim::Measure::distance]));
}

SweepRun run_with(std::uint64_t number, double distance) {
  SweepRun run;
  run.number = number;
  run.result.measures[sim::Measure::distance] = distance;
  return run;
}

TEST(SweepSummary, HasMeanAndStandardDeviationOverTheSeeds) {
  const Sweep sweep = sweep_over({"seed=1:4", "amplitude=10:20:10"});  // the seed varies more slowly
  const std::vector<SweepRun> runs{run_with(0, 2.0), run_with(1, 1.0), run_with(2, 4.0),
                                   run_with(3, NAN), run_with(4, 4.0), run_with(6, 6.0)};
  const std::vector<SweepGroup> groups = group_runs(sweep, runs, sim::Measure::distance);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].values, (std::vector<double>{2.0, 4.0, 4.0, 6.0}));
  EXPECT_DOUBLE_EQ(groups[0].mean(), 4.0);
  EXPECT_DOUBLE_EQ(groups[0].deviation(), std::sqrt(8.0 / 3.0));
  EXPECT_EQ(groups[1].values, std::vector<double>{1.0}) << "a value that is undefined does not count";
  EXPECT_TRUE(std::isnan(groups[1].deviation()));
  EXPECT_TRUE(std::isnan(SweepGroup{}.mean()));
}

TEST(SweepSummary, IsATableWithoutTheSeed) {
  const Sweep sweep = sweep_over({"amplitude=10:20:10", "seed=1:2"});
  const std::vector<SweepRun> runs{run_with(0, 1.0), run_with(1, 3.0), run_with(2, 5.0)};
  const std::string table =
      sweep_summary(sweep, group_runs(sweep, runs, sim::Measure::distance), sim::Measure::distance);
  EXPECT_TRUE(
      table.starts_with("# proleg sweep top.xml --over amplitude=10:20:10 --over seed=1:2 --seconds 2\n"
                        "amplitude (deg)\truns\tmean of distance (m)\t"))
      << table;
  EXPECT_NE(table.find("\n10\t2\t2\t1.4142135623730951\t1\t3\n"), std::string::npos) << table;
  EXPECT_TRUE(table.ends_with("\n20\t1\t5\t\t5\t5\n")) << table;
}

TEST(SweepTable, HasALineForEachRunWithItsValues) {
  const Sweep sweep = sweep_over({"amplitude=10:20:10", "seed=3:4"});
  std::vector<SweepRun> runs{run_with(0, 1.5), run_with(3, NAN)};
  runs[1].result.failure = "the robot\nfell";
  const std::string table = sweep_head(sweep, "key") + sweep_line(sweep, runs[0]) + sweep_line(sweep, runs[1]);
  EXPECT_TRUE(
      table.starts_with("# proleg sweep top.xml --over amplitude=10:20:10 --over seed=3:4 --seconds 2\n"
                        "# files and program "))
      << table;
  EXPECT_NE(table.find("\namplitude (deg)\tseed\tdistance (m)\t"), std::string::npos) << table;
  EXPECT_NE(table.find("\n10\t3\t1.5\t"), std::string::npos) << table;
  EXPECT_NE(table.find("\n20\t4\t\t"), std::string::npos) << table;
  EXPECT_TRUE(table.ends_with("\tthe robot fell\n")) << table;
  EXPECT_EQ(std::ranges::count(table, '\n'), 5);
}

TEST(SweepTable, IsReadAgainWithoutALoss) {
  const Sweep sweep = sweep_over({"amplitude=10:20:10", "seed=3:4"});
  std::vector<SweepRun> runs{run_with(3, NAN), run_with(0, 1.0 / 3.0), run_with(1, -1e-300)};
  runs[0].result.failure = "the robot fell";
  runs[1].result.limited_joints = 4;
  std::string table = sweep_head(sweep, "key");
  for (const SweepRun& run : runs) {
    table += sweep_line(sweep, run);
  }
  const std::vector<SweepRun> read = read_sweep_table(sweep, "key", "t.tsv", table + "10\t3\t1.");
  ASSERT_EQ(read.size(), 3U) << "a line without its end was being written";
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].number, runs[i].number);
    EXPECT_EQ(sweep_line(sweep, read[i]), sweep_line(sweep, runs[i]));
  }
}

TEST(SweepTable, OfAnotherSweepOrADamagedOneIsRefused) {
  const Sweep sweep = sweep_over({"amplitude=10:20:10", "seed=3:4"});
  const std::string head = sweep_head(sweep, "key");
  const std::string line = sweep_line(sweep, run_with(0, 1.5));
  const auto table_refusal = [&](const std::string& text) {
    return message_of<InputError>([&] { static_cast<void>(read_sweep_table(sweep, "key", "t.tsv", text)); });
  };
  EXPECT_EQ(table_refusal(head + line), "");
  EXPECT_EQ(table_refusal(""),
            "t.tsv:1: found the end of the table, expected the head of a table that this command has written");
  EXPECT_EQ(table_refusal(sweep_head(sweep_over({"amplitude=10:20:10", "seed=3:5"}), "key") + line).substr(0, 16),
            "t.tsv:1: found '");
  EXPECT_EQ(table_refusal(sweep_head(sweep, "other key") + line),
            "t.tsv:2: found results of other files or of another program, expected those of the scenario and the "
            "program of the interrupted sweep");
  const std::string damaged = "t.tsv:5: found a line that this command has not written, expected one line for each run";
  EXPECT_EQ(table_refusal(head + line + line), damaged) << "a run twice";
  EXPECT_EQ(table_refusal(head + line + "10\t4\n"), damaged);
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::string other = line;
    other[i] = 'x';
    const std::string message = table_refusal(head + line + other);
    EXPECT_TRUE(message.starts_with("t.tsv:5: found ") || i + 1 == line.size()) << i;
  }
}

TEST(SweepTable, IsReadBackFromEditorsAndSpreadsheetsOrNamesTheColumn) {
  const Sweep sweep = sweep_over({"amplitude=10:20:10", "seed=3:4"});
  const std::string table =
      sweep_head(sweep, "key") + sweep_line(sweep, run_with(0, 1.5)) + sweep_line(sweep, run_with(1, 2.5));
  const auto with_line_ends = [&](const std::string& end) {
    std::string text;
    for (const char c : table) {
      text += c == '\n' ? end : std::string(1, c);
    }
    return text;
  };
  std::string stripped = table;
  for (std::size_t at = stripped.find("\t\n"); at != std::string::npos; at = stripped.find("\t\n")) {
    stripped.erase(at, 1);
  }
  ASSERT_NE(stripped, table);
  for (const std::string& text : {stripped, with_line_ends("\r\n"), with_line_ends("\t\t\n"), "\xEF\xBB\xBF" + table}) {
    const std::vector<SweepRun> read = read_sweep_table(sweep, "key", "t.tsv", text);
    ASSERT_EQ(read.size(), 2U) << text;
    EXPECT_EQ(sweep_line(sweep, read[1]), sweep_line(sweep, run_with(1, 2.5)));
  }
  std::string with_comma = table;
  with_comma.replace(with_comma.find("2.5"), 3, "2,5");
  EXPECT_EQ(message_of<InputError>([&] {
              static_cast<void>(read_sweep_table(sweep, "key", "t.tsv", with_comma));
            }).substr(0, 35),
            "t.tsv:5: found '2,5' in the column ");
}

TEST(SweepTable, CanBeLookedAtWithoutItsScenario) {
  const Sweep sweep = sweep_over({"amplitude=10:20:10", "seed=3:4"});
  const std::string head = sweep_head(sweep, "key");
  const std::string line = sweep_line(sweep, run_with(2, 1.5));
  SweepRequest request;
  request.over = {"amplitude=10:20:10", "seed=3:4"};
  request.units = {sweep.quantities[0].unit, ""};
  const Sweep outline = sweep_without_scenario(request);
  EXPECT_EQ(outline.size(), 4U);
  const SweepTable table = look_at_sweep_table(outline, "t.tsv", head + line + "10\t3");
  EXPECT_EQ(table.inputs, sweep_inputs(sweep, "key"));
  ASSERT_EQ(table.runs.size(), 1U);
  EXPECT_EQ(sweep_line(outline, table.runs[0]), line);
  EXPECT_TRUE(look_at_sweep_table(outline, "t.tsv", "").runs.empty());
  EXPECT_TRUE(look_at_sweep_table(outline, "t.tsv", head.substr(0, head.size() - 1)).runs.empty())
      << "the head is being written";
  const auto look_refusal = [&](const std::string& text) {
    return message_of<InputError>([&] { static_cast<void>(look_at_sweep_table(outline, "t.tsv", text)); });
  };
  EXPECT_EQ(look_refusal("x" + head).substr(0, 16), "t.tsv:1: found '");
  EXPECT_EQ(look_refusal(sweep_head(sweep_over({"frequency=1", "seed=3:4"}), "key")).substr(0, 16), "t.tsv:3: found '");
  EXPECT_EQ(look_refusal(head + line + line),
            "t.tsv:5: found a line that this command has not written, expected one line for each run");
}

TEST(SweepRequest, IsReadAsItWasWritten) {
  SweepRequest request;
  request.started = "2026-11-28T10:40:00Z";
  request.folder = "/home/me/a b";
  request.scenario = "x.simulation.xml";
  request.measure = "speed";
  request.over = {"amplitude=10:20:10", "seed=1:2"};
  request.units = {"deg", ""};
  request.settings = {"frequency=1"};
  request.seconds = "2";
  request.overrides.engine = "reduced";
  const std::string text = sweep_request_text(request);
  const SweepRequest read = read_sweep_request("options.tsv", text);
  EXPECT_EQ(sweep_request_text(read), text);
  EXPECT_EQ(words_of(read), (std::vector<std::string>{"x.simulation.xml", "--measure", "speed", "--over",
                                                      "amplitude=10:20:10", "--over", "seed=1:2", "--set",
                                                      "frequency=1", "--seconds", "2", "--engine", "reduced"}));
}

TEST(SweepRequest, OfAnotherVersionOrADamagedOneIsRefused) {
  SweepRequest request;
  request.scenario = "x.simulation.xml";
  request.measure = "speed";
  request.over = {"amplitude=10:20:10"};
  request.units = {"deg"};
  const std::string text = sweep_request_text(request);
  const auto request_refusal = [](const std::string& changed) {
    return message_of<InputError>([&] { static_cast<void>(read_sweep_request("options.tsv", changed)); });
  };
  EXPECT_EQ(request_refusal(text), "");
  EXPECT_NE(request_refusal(""), "");
  EXPECT_EQ(request_refusal("format\tproleg sweep 2\n").substr(0, 22), "options.tsv:1: found '");
  EXPECT_NE(request_refusal(text + "other\t1\n"), "");
  for (std::size_t size = 0; size < text.size(); ++size) {
    EXPECT_NE(request_refusal(text.substr(0, size)), "") << size;
  }
}

/// Number of elements of that name in a group of the picture.
int count_in_group(const std::string& picture, const std::string& group, const char* element) {
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.Parse(picture.c_str()), tinyxml2::XML_SUCCESS);
  int count = 0;
  const auto* svg = document.RootElement();
  for (const auto* g = svg == nullptr ? nullptr : svg->FirstChildElement("g"); g != nullptr;
       g = g->NextSiblingElement("g")) {
    if (g->Attribute("class", group.c_str()) != nullptr) {
      for (const auto* child = g->FirstChildElement(element); child != nullptr;
           child = child->NextSiblingElement(element)) {
        ++count;
      }
    }
  }
  return count;
}

/// distances: by combination.
std::string picture_of(const Sweep& sweep, const std::vector<double>& distances) {
  std::vector<SweepRun> runs;
  for (std::uint64_t i = 0; i < sweep.size(); ++i) {
    runs.push_back(run_with(i, distances[i]));
  }
  return draw_sweep(sweep, group_runs(sweep, runs, sim::Measure::distance), sim::Measure::distance);
}

std::string picture_of(const std::vector<std::string>& words) {
  const Sweep sweep = sweep_over(words);
  std::vector<double> distances(sweep.size());
  std::iota(distances.begin(), distances.end(), 1.0);
  return picture_of(sweep, distances);
}

/// Red, green and blue of a cell of a map with three cells of these values.
std::array<int, 3> colour_of_cell(const std::vector<double>& values, int cell) {
  const std::string picture = picture_of(sweep_over({"amplitude=1:3", "friction=0:1"}),
                                         {values[0], values[0], values[1], values[1], values[2], values[2]});
  std::size_t place = picture.find("class=\"map\"");
  for (int i = 0; i <= 2 * cell; ++i) {
    place = picture.find("fill=\"#", picture.find("<rect", place + 1));
  }
  std::array<int, 3> colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    colour[i] = std::stoi(picture.substr(place + 7 + 2 * i, 2), nullptr, 16);
  }
  return colour;
}

int brightness(const std::array<int, 3>& colour) { return colour[0] + colour[1] + colour[2]; }
bool is_blue(const std::array<int, 3>& colour) { return colour[2] > colour[0]; }
bool is_orange(const std::array<int, 3>& colour) { return colour[0] > colour[2]; }

TEST(SweepFigure, OneQuantityIsALineWithItsSpread) {
  const std::string picture = picture_of({"amplitude=10:50:10", "seed=1:3"});
  EXPECT_EQ(count_in_group(picture, "mean", "polyline"), 3) << "mean, and a standard deviation below and above";
  EXPECT_EQ(count_in_group(picture, "runs", "path"), 1);
}

TEST(SweepFigure, TwoQuantitiesAreAMapWithACellForEachMean) {
  EXPECT_EQ(count_in_group(picture_of({"amplitude=10:50:10", "seed=1:3", "friction=0.1:0.3:0.1"}), "map", "rect"), 15);
}

TEST(SweepFigure, PositiveMeansAreBlueAndDarkForTheHighest) {
  const std::vector<double> values{1.0, 2.0, 4.0};
  EXPECT_TRUE(is_blue(colour_of_cell(values, 1)));
  EXPECT_GT(brightness(colour_of_cell(values, 0)), brightness(colour_of_cell(values, 1)));
  EXPECT_GT(brightness(colour_of_cell(values, 1)), brightness(colour_of_cell(values, 2)));
}

TEST(SweepFigure, NegativeMeansAreOrangeAndDarkForTheLowest) {
  const std::vector<double> values{-4.0, -2.0, -1.0};
  EXPECT_TRUE(is_orange(colour_of_cell(values, 0)));
  EXPECT_TRUE(is_orange(colour_of_cell(values, 1)));
  EXPECT_LT(brightness(colour_of_cell(values, 0)), brightness(colour_of_cell(values, 1)));
  EXPECT_LT(brightness(colour_of_cell(values, 1)), brightness(colour_of_cell(values, 2)));
}

TEST(SweepFigure, MeansOfBothSignsHaveAPaleZero) {
  const std::vector<double> values{-1.0, 0.0, 4.0};
  EXPECT_TRUE(is_orange(colour_of_cell(values, 0)));
  const std::array<int, 3> zero = colour_of_cell(values, 1);
  EXPECT_TRUE(zero[0] == zero[1] && zero[1] == zero[2]);
  EXPECT_TRUE(is_blue(colour_of_cell(values, 2)));
  EXPECT_LT(brightness(colour_of_cell(values, 2)), brightness(colour_of_cell(values, 0))) << "4 is farther from 0";
  const std::string picture = picture_of(sweep_over({"amplitude=1:3", "friction=0:1"}), {-1, -1, 0, 0, 4, 4});
  EXPECT_NE(picture.find(">mean: -4<"), std::string::npos) << "the legend states what the colours mean";
  EXPECT_NE(picture.find(">4<"), std::string::npos);
}

TEST(SweepFigure, AGapIsWhereNoRunHasAValue) {
  const Sweep line = sweep_over({"amplitude=1:5", "seed=1:2"});
  const std::string picture = picture_of(line, {1, 2, 3, NAN, NAN, NAN, 4, 5, 6, 7});
  EXPECT_EQ(count_in_group(picture, "mean", "polyline"), 6) << "two sections, each with its spread";
  EXPECT_EQ(count_in_group(picture, "gaps", "path"), 1);
  EXPECT_NE(picture.find("no value"), std::string::npos);
  const std::string map = picture_of(sweep_over({"amplitude=1:2", "friction=0:1"}), {1, 2, NAN, 3});
  EXPECT_EQ(count_in_group(map, "map", "rect"), 3);
  EXPECT_EQ(count_in_group(map, "gaps", "path"), 1);
  EXPECT_EQ(count_in_group(picture_of({"amplitude=1:2"}), "gaps", "path"), 0);
}

TEST(SweepFigure, ThereIsNoneWithoutAValue) {
  EXPECT_EQ(picture_of(sweep_over({"amplitude=1:2"}), {NAN, NAN}), "");
  EXPECT_EQ(picture_of(sweep_over({"amplitude=1:2", "friction=0:1"}), {NAN, NAN, NAN, NAN}), "");
}

TEST(SweepFigure, StatesUnitsScenarioAndOptions) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"amplitude=10:20"}, {"amplitude=10:20", "phase_difference=0:5"}}) {
    const Sweep sweep = sweep_over(words, {"frequency=2"});
    const std::string picture = picture_of(sweep, std::vector<double>(sweep.size(), 1.5));
    EXPECT_NE(picture.find(">amplitude (deg)<"), std::string::npos);
    EXPECT_NE(picture.find(">top.xml: amplitude 10 to 20 deg"), std::string::npos);
    EXPECT_NE(picture.find(">--set frequency=2 --seconds 2<"), std::string::npos);
  }
}

TEST(SweepFigure, ThereIsNoneForNoOrThreeQuantities) {
  EXPECT_EQ(picture_of({"seed=1:3"}), "");
  EXPECT_EQ(picture_of({"amplitude=10:20:10", "friction=0.1:0.2:0.1", "frequency=1:2"}), "");
}

}  // namespace
}  // namespace proleg::optimize
