#include "sim/optimize/adaptation/atlas.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "shipped_atlas.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/adaptation/simulated_robot.hpp"
#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/scenario/damage.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::optimize {
namespace {

void fill_store(const std::filesystem::path& path, const Experiment& experiment,
                const std::vector<Evaluation>& evaluations) {
  Store store(path, experiment, "key", Store::Opening::fresh);
  for (const Evaluation& evaluation : evaluations) {
    store.save(evaluation);
  }
}

std::string message_of(const Atlas& atlas, const sim::Scenario& scenario) {
  try {
    require_same_robot(atlas, scenario);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Atlas, HasTheBestGaitOfEachFilledCell) {
  const TemporaryFolder folder;
  const Experiment experiment = shipped_map();
  fill_store(folder.path() / "store.sqlite", experiment,
             {made_up_evaluation(experiment, 0, 100, 0.8, 0.0491, 0.399),
              made_up_evaluation(experiment, 1, 10, 0.5, 0.001, 0.201),
              made_up_evaluation(experiment, 2, 20, 0.6, 0.001, 0.201)});
  for (const std::filesystem::path& path : {folder.path(), folder.path() / "store.sqlite"}) {
    const Atlas atlas = read_atlas(path, 0);
    ASSERT_EQ(atlas.gaits.size(), 2U);
    EXPECT_EQ(atlas.gaits[0].cell, 0U);
    EXPECT_EQ(atlas.gaits[0].candidate, Candidate(5, 20));
    EXPECT_EQ(atlas.gaits[1].cell, 499U);
    EXPECT_EQ(atlas.gaits[1].score, 0.8);
    EXPECT_EQ(atlas.points()[0], (std::vector<double>{0.02, 0.025, 0.125, 0.125, 0.125, 0.125, 0.125}))
        << "the middle of the cell, and 5 of 40 degrees for each joint";
    const std::vector<double> middle = GaitMap(atlas.experiment).middle(atlas.gaits[1].cell);
    EXPECT_NEAR(middle[0], 0.049, 1e-12) << "the middle of the cell, in m";
    EXPECT_NEAR(middle[1], 0.395, 1e-12);
  }
}

TEST(Atlas, HasBesideTheseWhatTheSearchHasTriedThatIsUnlikeAllBefore) {
  const TemporaryFolder folder;
  const Experiment experiment = shipped_map();
  const auto tried = [&](std::uint64_t number, std::uint32_t amplitude, double distance) {
    return made_up_evaluation(experiment, number, amplitude, distance, 0.001, 0.201);  // all in one cell
  };
  std::vector<Evaluation> evaluations{tried(0, 80, 0.9), tried(1, 10, 0.1), tried(2, 160, 0.2), tried(3, 84, 0.3),
                                      tried(4, 150, 0.4)};
  evaluations.push_back(tried(5, 0, 0.0));
  evaluations.back().scores = {experiment.objectives.front().failed, 0.001, 0.201};
  fill_store(folder.path() / "store.sqlite", experiment, evaluations);
  const auto amplitudes = [&](std::size_t most_others) {
    std::vector<std::uint32_t> found;
    for (const AtlasGait& gait : read_atlas(folder.path(), most_others).gaits) {
      found.push_back(gait.candidate.front());
    }
    return found;
  };
  EXPECT_EQ(amplitudes(0), (std::vector<std::uint32_t>{80}));
  EXPECT_EQ(amplitudes(1), (std::vector<std::uint32_t>{80, 160})) << "80 away; 10 is only 70 away";
  EXPECT_EQ(amplitudes(3), (std::vector<std::uint32_t>{80, 160, 10, 150}));
  EXPECT_EQ(amplitudes(100), (std::vector<std::uint32_t>{80, 160, 10, 150, 84})) << "no run that failed";
  const Atlas atlas = read_atlas(folder.path());
  EXPECT_EQ(atlas.gaits[1].score, 0.2);
  EXPECT_EQ(atlas.gaits[1].cell, atlas.gaits[0].cell);
}

TEST(Atlas, HasAnotherFingerprintWithAnotherGait) {
  Atlas atlas = small_atlas();
  const std::string before = atlas.fingerprint();
  EXPECT_EQ(small_atlas().fingerprint(), before);
  atlas.gaits[1].candidate[2] += 1;
  EXPECT_NE(atlas.fingerprint(), before);
}

TEST(Atlas, IsRefusedWithoutAMapOrAGait) {
  const TemporaryFolder folder;
  const auto message = [&] {
    try {
      static_cast<void>(read_atlas(folder.path()));
    } catch (const StoreError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(message().find("store.sqlite"), std::string::npos) << "there is none";
  fill_store(folder.path() / "store.sqlite", shipped_map(), {});
  EXPECT_NE(message().find("found no gait yet"), std::string::npos);
  std::filesystem::remove(folder.path() / "store.sqlite");
  sim::DiskFiles files;
  fill_store(folder.path() / "store.sqlite",
             read_experiment(source_path("/sim/scenarios/travelling_wave/great_deluge.optimise.xml"), files), {});
  EXPECT_NE(message().find("found a search without a map"), std::string::npos);
}

TEST(Atlas, OfFilesThatSomebodyHasChangedIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path store = folder.path() / "store.sqlite";
  const Experiment experiment = shipped_map();
  fill_store(store, experiment, {made_up_evaluation(experiment, 0, 100, 0.8, 0.0491, 0.399)});
  const auto message = [&] {
    try {
      static_cast<void>(read_atlas(store));
    } catch (const StoreError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const auto change = [&](const std::string& statement) {
    Database database(store, SQLITE_OPEN_READWRITE);
    database.execute(statement.c_str());
  };
  change("UPDATE source SET text = replace(text, 'cells=\"25\"', 'cells=\"24\"')");
  EXPECT_NE(message().find("is the store of another experiment, with fingerprint"), std::string::npos) << message();
  EXPECT_NE(message().find("differences: map"), std::string::npos) << message();
  change("UPDATE source SET text = replace(text, 'cells=\"24\"', 'cells=\"25\"')");
  EXPECT_EQ(message(), "no error");
  change("UPDATE evaluation SET candidate = 'a b c d e'");
  EXPECT_NE(message(), "no error") << "a candidate that is none";
}

TEST(Atlas, RefusesAnotherRobotInOneLine) {
  const Atlas atlas = small_atlas();
  const sim::Scenario same = shipped_map().scenario;
  EXPECT_EQ(message_of(atlas, same), "no error");

  sim::Scenario damaged = same;
  sim::apply_damage(damaged, {"jammed:J2", "torque:J3=40", "friction=50", "mass:Head=115"});
  damaged.environment.engine = sim::PhysicsEngine::mujoco;
  EXPECT_EQ(message_of(atlas, damaged), "no error") << "the same robot in another state and world";

  sim::Scenario shorter = same;
  shorter.robot.joints.pop_back();
  EXPECT_NE(message_of(atlas, shorter).find("found 4 joints, expected 5 joints"), std::string::npos);
  sim::Scenario named = same;
  named.robot.joints[1].name = "knee";
  EXPECT_NE(message_of(atlas, named).find("found joint 'knee', expected 'J4'"), std::string::npos);
  sim::Scenario turned = same;
  turned.robot.joints[2].axis = {0.0, 0.0, 1.0};
  EXPECT_NE(message_of(atlas, turned).find("another axis of joint J3"), std::string::npos);
  sim::Scenario without = same;
  without.kernel.slots[0] = {};
  EXPECT_NE(message_of(atlas, without).find("found no actuation module 1"), std::string::npos);
  sim::Scenario faster = same;
  sim::apply_setting(faster, "frequency:J3=1.5");
  EXPECT_NE(message_of(atlas, faster).find("found another frequency of J3"), std::string::npos);
  sim::Scenario chosen = same;
  sim::apply_setting(chosen, "amplitude:J3=11");
  EXPECT_EQ(message_of(atlas, chosen), "no error") << "the gait sets it";
}

TEST(SimulatedRobot, StopsWhenTheUserDoes) {
  const Atlas atlas = small_atlas();
  SimulatedRobot robot(atlas.experiment, atlas.experiment.scenario, {}, [] { return true; });
  EXPECT_THROW(static_cast<void>(robot.try_gait(Candidate(5, 40))), SearchEnded);
}

TEST(SimulatedRobot, SaysWhyATrialHasNoScore) {
  Atlas atlas = small_atlas();
  sim::Scenario scenario = atlas.experiment.scenario;
  scenario.duration_s = 0.1;  // no stride: the stride length is not defined
  atlas.experiment.objectives.front() = {"stride_length", {{sim::Measure::stride_length, 1.0}}, Goal::maximise, -5.0};
  SimulatedRobot robot(atlas.experiment, scenario, {}, [] { return false; });
  const TrialOutcome outcome = robot.try_gait(Candidate(5, 40));
  EXPECT_EQ(outcome.score, -5.0);
  EXPECT_NE(outcome.failure.find("stride_length"), std::string::npos);
}

}  // namespace
}  // namespace proleg::optimize
