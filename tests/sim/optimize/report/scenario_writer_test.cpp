#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <random>
#include <set>

#include "made_up.hpp"
#include "memory_files.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/optimize/report/report.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::optimize {
namespace {

namespace fs = std::filesystem;

void describe(std::ostream& out, const sim::Pose& pose) {
  out << "pose " << pose.position.transpose() << " " << pose.orientation.coeffs().transpose() << "\n";
}

void describe(std::ostream& out, const std::vector<sim::Geometry>& geometries) {
  for (const sim::Geometry& geometry : geometries) {
    out << "geometry " << static_cast<int>(geometry.shape) << " " << geometry.extents.transpose() << " "
        << geometry.friction.value_or(-1.0) << " " << (geometry.mesh ? geometry.mesh->triangles.size() : 0) << " ";
    describe(out, geometry.pose);
  }
}

/// All of a scenario, except its sources, in digits that distinguish all doubles.
std::string description_of(const sim::Scenario& scenario) {
  std::ostringstream out;
  out << std::setprecision(17) << "robot " << scenario.robot.name << " " << scenario.robot.servo.gain << " "
      << scenario.robot.servo.period_us << " " << scenario.robot.servo.latency_us << "\n";
  for (const sim::Link& link : scenario.robot.links) {
    out << link.name << " " << link.mass.mass << " " << link.mass.center.transpose() << "\n"
        << link.mass.inertia << "\n";
    describe(out, link.pose);
    describe(out, link.geometries);
  }
  for (const sim::Joint& joint : scenario.robot.joints) {
    out << joint.name << " " << joint.file_index << " " << joint.anchor.transpose() << " " << joint.axis.transpose()
        << " " << joint.lower_limit << " " << joint.upper_limit << " " << joint.max_torque << " " << joint.max_speed
        << "\n";
  }
  out << "gravity " << scenario.environment.gravity.transpose() << " " << scenario.environment.self_collision << "\n";
  describe(out, scenario.environment.robot_pose);
  for (const sim::StaticObject& object : scenario.environment.objects) {
    out << object.name << "\n";
    describe(out, object.pose);
    describe(out, object.geometries);
  }
  for (const sim::MovingObject& object : scenario.environment.moving_objects) {
    out << object.name << " " << object.mass.mass << "\n";
    describe(out, object.pose);
    describe(out, object.geometries);
  }
  out << "rulers " << scenario.environment.rulers.size() << "\n";
  out << "kernel " << +scenario.kernel.joint_count << " " << scenario.kernel.tick_period_us << " "
      << scenario.kernel.seed << "\n";
  for (const Slot& slot : scenario.kernel.slots) {
    out << "slot " << (slot.algorithm == nullptr ? "-" : slot.algorithm->declaration().name) << " ";
    for (unsigned j = 0; j < max_joints; ++j) {
      out << (slot.group.contains(j) ? '1' : '0');
    }
    out << "\n";
  }
  for (const AngleLimits& limits : scenario.joint_limits) {
    out << "limits " << limits.lower << " " << limits.upper << "\n";
  }
  for (const sim::ModulePlace& place : scenario.modules) {
    out << "node " << +place.node << " " << place.serial.value_or(0) << "\n";
  }
  for (const Setting& setting : scenario.settings) {
    out << "setting " << +setting.slot << " " << +setting.joint << " " << +setting.number << " " << setting.internal
        << " " << setting.value << "\n";
  }
  out << "run " << scenario.duration_s << " " << scenario.step_s << " " << static_cast<int>(scenario.solver) << " "
      << scenario.contact_noise << " " << scenario.changes.size() << "\n";
  return out.str();
}

Experiment experiment_of(sim::Scenario scenario) {
  Experiment experiment = distance_experiment();
  experiment.space.dimensions.clear();
  experiment.scenario = std::move(scenario);
  return experiment;
}

/// A dimension for each parameter that `wanted` names (all, if it is empty), on each joint, with a few random values.
void add_dimensions(Experiment& experiment, const std::string& wanted, std::mt19937& random) {
  const sim::Scenario& scenario = experiment.scenario;
  for (std::size_t slot = 0; slot < max_slots; ++slot) {
    if (scenario.kernel.slots[slot].algorithm == nullptr) {
      continue;
    }
    const auto& parameters = scenario.kernel.slots[slot].algorithm->declaration().parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      for (unsigned joint = 0; joint < scenario.kernel.joint_count; ++joint) {
        if (!scenario.kernel.slots[slot].group.contains(joint) || (!wanted.empty() && parameters[p].name != wanted)) {
          continue;
        }
        Dimension dimension;
        dimension.name = std::to_string(experiment.space.dimensions.size());
        dimension.unit = parameters[p].unit;
        dimension.targets.push_back({static_cast<std::uint8_t>(slot), static_cast<std::uint8_t>(joint),
                                     static_cast<std::uint8_t>(p), false, 0});
        std::uniform_int_distribution<std::int32_t> any(parameters[p].minimum, parameters[p].maximum);
        const std::int32_t top = wanted.empty() ? any(random) : raw(Unit::degree, 40);
        std::set<std::int32_t> values{parameters[p].default_value, top, wanted.empty() ? any(random) : top / 2};
        dimension.values.assign(values.begin(), values.end());
        experiment.space.dimensions.push_back(dimension);
      }
    }
  }
}

Candidate random_candidate(const SearchSpace& space, std::mt19937& random) {
  Candidate candidate;
  for (const Dimension& dimension : space.dimensions) {
    candidate.push_back(static_cast<std::uint32_t>(random() % dimension.values.size()));
  }
  return candidate;
}

sim::Scenario read_back(const fs::path& path) {
  sim::DiskFiles files;
  return sim::read_scenario(path, files);
}

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

Evaluation of(const Candidate& candidate) {
  Evaluation evaluation;
  evaluation.candidate = candidate;
  return evaluation;
}

/// The experiment's scenario with a candidate's values. With noise, its seed is that of the search's first trial.
sim::Scenario expected_scenario(const Experiment& experiment, const Candidate& candidate) {
  sim::Scenario scenario = experiment.scenario;
  experiment.space.apply(candidate, scenario);
  if (depends_on_seed(experiment.scenario, experiment.space, {})) {
    scenario.kernel.seed = trial_seed(experiment.seed, 0, 0, 0);
  }
  return scenario;
}

/// Writes a candidate's scenario and looks whether it comes back, from files of that folder alone.
sim::Scenario expect_round_trip(const Experiment& experiment, const Candidate& candidate) {
  const TemporaryFolder folder;
  const fs::path top = write_scenario(experiment, of(candidate), folder.path() / "new" / "folder", "best");
  EXPECT_EQ(top, folder.path() / "new" / "folder" / "best.simulation.xml");
  const sim::Scenario expected = expected_scenario(experiment, candidate);
  sim::Scenario scenario = read_back(top);
  EXPECT_EQ(description_of(scenario), description_of(expected));
  for (const sim::SourceFile& source : scenario.sources) {
    EXPECT_TRUE(source.path.starts_with(folder.path().string())) << source.path;
    EXPECT_EQ(source.text.str().find(".part"), std::string::npos);
  }
  for (const std::string& remark : scenario.remarks) {
    EXPECT_EQ(remark.find("was made for robot"), std::string::npos) << remark;
  }
  return scenario;
}

sim::Scenario shipped(const std::string& name) { return read_back(source_path("/sim/scenarios/") + name); }

const std::vector<std::string> shipped_names{
    "travelling_wave/uniform.simulation.xml", "travelling_wave/tail_fixed.simulation.xml",
    "travelling_wave/coupled.simulation.xml", "obstacle/reflex.simulation.xml", "long_chain/twenty.simulation.xml"};

TEST(WriteScenario, EveryParameterOfShippedScenariosComesBack) {
  const unsigned seed = 11;
  for (const std::string& name : shipped_names) {
    SCOPED_TRACE(name + ", seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Experiment experiment = experiment_of(shipped(name));
    add_dimensions(experiment, "", random);
    for (int round = 0; round < 5; ++round) {
      (void)expect_round_trip(experiment, random_candidate(experiment.space, random));
    }
  }
}

TEST(WriteScenario, AScenarioThatNothingWasChosenForComesBack) {
  for (const std::string& name : shipped_names) {
    SCOPED_TRACE(name);
    (void)expect_round_trip(experiment_of(shipped(name)), {});
  }
}

std::pair<std::string, double> run(const sim::Scenario& scenario, double seconds) {
  sim::Simulation simulation(scenario);
  while (simulation.time_s() < seconds) {
    simulation.advance();
  }
  return {simulation.setpoint_hash().hex(), simulation.plant().displacement()};
}

TEST(WriteScenario, WhatComesBackMovesTheSame) {
  std::mt19937 random(3);
  for (const std::string& name : shipped_names) {
    SCOPED_TRACE(name);
    Experiment experiment = experiment_of(shipped(name));
    add_dimensions(experiment, "amplitude", random);
    const Candidate candidate = random_candidate(experiment.space, random);
    const sim::Scenario written = expect_round_trip(experiment, candidate);
    const sim::Scenario expected = expected_scenario(experiment, candidate);
    EXPECT_EQ(run(written, 0.5), run(expected, 0.5));
  }
}

TEST(WriteScenario, MeshesHeightsAndObjectsThatMoveComeBack) {
  const sim::Scenario written =
      expect_round_trip(experiment_of(shipped("robots/mesh_world/mesh_world.simulation.xml")), {});
  const sim::Geometry& ridge = written.environment.objects.back().geometries.at(0);
  EXPECT_FALSE(ridge.mesh->colours.empty()) << "the file of its materials, too";
}

TEST(WriteScenario, MeshesAndHeightsWhoseNamesHaveBlanksComeBack) {
  const TemporaryFolder folder;
  fs::copy(source_path("/sim/scenarios/robots"), folder.path(), fs::copy_options::recursive);
  const fs::path world = folder.path() / "mesh_world";
  fs::rename(world / "hills.txt", world / "hills 2.txt");
  fs::rename(world / "ridge.obj", world / "a ridge.obj");
  std::string text = file_contents(world / "hills.environment.xml");
  text.replace(text.find("hills.txt"), 9, "hills 2.txt");
  text.replace(text.find("ridge.obj"), 9, "'a ridge.obj' 1");
  std::ofstream(world / "hills.environment.xml") << text;
  (void)expect_round_trip(experiment_of(read_back(world / "mesh_world.simulation.xml")), {});
}

TEST(WriteScenario, TheThesissFilesComeBack) {
  std::mt19937 random(5);
  Experiment experiment = experiment_of(read_back(source_path("/tests/sim/scenario/thesis/MFIdemo.simulation.xml")));
  add_dimensions(experiment, "", random);
  (void)expect_round_trip(experiment, random_candidate(experiment.space, random));
}

/// The small scenario with its files elsewhere. Each place is a path, and how its includer or the top names it.
struct Layout {
  std::string top = "top.xml";
  std::string robot = "robot.xml";
  std::string robot_name = "robot.xml";
  std::string end = "end.xml";
  std::string end_name = "end.xml";
  std::string environment = "environment.xml";
  std::string environment_name = "environment.xml";
};

sim::Scenario laid_out(const Layout& layout) {
  sim::MemoryFiles files = sim::small_scenario();
  files.replace("top.xml", "<robot>robot.xml", "<robot>" + layout.robot_name)
      .replace("top.xml", "<environment>environment.xml", "<environment>" + layout.environment_name)
      .replace("robot.xml", "file=\"end.xml\"", "FILE=\" " + layout.end_name + " \"");
  const auto move = [&](const std::string& from, const std::string& to) {
    std::string text = files.texts.at(from);
    files.texts.erase(from);
    files.texts[fs::path(to).lexically_normal().string()] = std::move(text);
  };
  move("actuation.xml", (fs::path(layout.top).parent_path() / "actuation.xml").string());
  move("robot.xml", layout.robot);
  move("end.xml", layout.end);
  move("environment.xml", layout.environment);
  move("top.xml", layout.top);
  return sim::read_scenario(layout.top, files);
}

TEST(WriteScenario, FilesInDifferentFoldersFindEachOther) {
  const std::vector<Layout> layouts{
      {},
      {"a/b/top.xml", "a/r/robot.xml", "../r/robot.xml", "a/r/parts/end.xml", "parts/end.xml", "c/environment.xml",
       "../../c/environment.xml"},
      // Above the working folder.
      {"top.xml", "../../up/robot.xml", "../../up/robot.xml", "../../other/end.xml", "../x/../other/end.xml",
       "environment.xml", "./environment.xml"},
      // Absolute.
      {"/one/top.xml", "/two/robot.xml", "/two/robot.xml", "/three/deep/end.xml", "/three/deep/end.xml",
       "/one/environment.xml", "/one/environment.xml"},
      // Looked for from the folder of the top-level file.
      {"s/top.xml", "s/robots/robot.xml", "robots/robot.xml", "s/parts/end.xml", "parts/end.xml", "s/environment.xml",
       "environment.xml"},
      // One name, three files.
      {"s/top.xml", "s/r/same.xml", "r/same.xml", "s/r/parts/same.xml", "parts/same.xml", "s/same.xml", "same.xml"},
      // Characters that XML writes differently, and blanks.
      {"top.xml", "a & b/the \xc3\xb6 robot's.xml", "a &amp; b/the \xc3\xb6 robot's.xml", "a & b/p q/<end>.xml",
       "p q/&lt;end&gt;.xml", "environment.xml", "environment.xml"},
  };
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.robot);
    const Experiment experiment = experiment_of(laid_out(layout));
    (void)expect_round_trip(experiment, {});
  }
}

TEST(WriteScenario, CopiesFilesByteByByteWhereItCan) {
  const TemporaryFolder folder;
  const Experiment experiment = experiment_of(shipped("obstacle/reflex.simulation.xml"));
  write_scenario(experiment, of({}), folder.path(), "best");
  const fs::path files = folder.path() / "best.files";
  for (const char* name : {"travelling_wave/caterpillar.robot.xml", "travelling_wave/modules/segment.kinbody.xml",
                           "obstacle/terrace.environment.xml"}) {
    EXPECT_EQ(text_of(files / name), text_of(fs::path(source_path("/sim/scenarios")) / name)) << name;
  }
  EXPECT_FALSE(fs::exists(files / "obstacle/reflex.actuation.xml"));
  EXPECT_FALSE(fs::exists(files / "obstacle/reflex.simulation.xml"));
}

TEST(WriteScenario, KeepsWhatTheSimulationPropertiesSay) {
  sim::MemoryFiles files = sim::small_scenario();
  files.replace("top.xml", "<duration>2</duration>", "<duration>0.1234567890123</duration>")
      .replace("top.xml", "<tick unit=\"ms\">10</tick>", "<tick unit=\"ms\">12.345</tick>")
      .replace("top.xml", "<seed>7</seed>", "<seed>18446744073709551615</seed>")
      .replace("top.xml", "<solver>direct", "<solver>iterative")
      .replace("top.xml", "<stepWidth>0.001", "<stepWidth>0.002469");
  const sim::Scenario scenario = expect_round_trip(experiment_of(files.scenario()), {});
  EXPECT_EQ(scenario.kernel.seed, 18446744073709551615ULL);
  EXPECT_EQ(scenario.kernel.tick_period_us, 12'345U);
}

TEST(WriteScenario, WithNoiseHasTheSeedOfTheFirstTrial) {
  sim::MemoryFiles files = sim::small_scenario();
  files.replace("top.xml", "<seed>7</seed>", "<seed>7</seed><contactNoise>0.0625</contactNoise>");
  Experiment experiment = experiment_of(files.scenario());
  experiment.seed = 5;
  for (const RandomNumbers numbers : {RandomNumbers::common, RandomNumbers::fresh}) {
    experiment.trials.random_numbers = numbers;
    const TemporaryFolder folder;
    Evaluation evaluation = of({});
    evaluation.run = 2;
    evaluation.number = 11;
    const sim::Scenario scenario = read_back(write_scenario(experiment, evaluation, folder.path(), "best"));
    EXPECT_EQ(scenario.contact_noise, 0.0625);
    EXPECT_EQ(scenario.kernel.seed, trial_seed(5, 2, numbers == RandomNumbers::fresh ? 11 : 0, 0));
  }
}

TEST(WriteScenario, HasTheJudgingEngineWhateverTheSearchHad) {
  sim::MemoryFiles files = sim::small_scenario();
  for (const sim::PhysicsEngine engine : {sim::PhysicsEngine::reduced, sim::PhysicsEngine::ode}) {
    Experiment experiment = experiment_of(files.scenario());
    experiment.scenario.overrides.engine = engine;
    sim::apply_overrides(experiment.scenario.overrides, experiment.scenario.environment);
    const TemporaryFolder folder;
    const sim::Scenario scenario = read_back(write_scenario(experiment, of({}), folder.path(), "best"));
    EXPECT_EQ(scenario.environment.engine, judging_engine);
    EXPECT_EQ(scenario.environment.gravity, experiment.scenario.environment.gravity);
  }
}

TEST(WriteScenario, StatesTheOriginalWorldWhereTrialsVaryIt) {
  Experiment experiment = experiment_of(shipped("travelling_wave/uniform.simulation.xml"));
  experiment.trials.spread.friction = 0.5;
  experiment.trials.spread.mass = 0.5;
  experiment.trials.spread.contact_noise = 0.1;
  const TemporaryFolder folder;
  const sim::Scenario scenario = read_back(write_scenario(experiment, of({}), folder.path(), "best"));
  EXPECT_EQ(scenario.environment.unspecified_friction, experiment.scenario.environment.unspecified_friction);
  EXPECT_EQ(scenario.robot.links[0].mass.mass, experiment.scenario.robot.links[0].mass.mass);
  EXPECT_EQ(scenario.contact_noise, 0.0);
}

TEST(WriteScenario, ReplacesTheOneThatWasThere) {
  const TemporaryFolder folder;
  std::mt19937 random(2);
  Experiment experiment = experiment_of(shipped("travelling_wave/uniform.simulation.xml"));
  add_dimensions(experiment, "amplitude", random);
  for (int round = 0; round < 3; ++round) {
    const Candidate candidate = random_candidate(experiment.space, random);
    const sim::Scenario expected = expected_scenario(experiment, candidate);
    const fs::path top = write_scenario(experiment, of(candidate), folder.path(), "best");
    EXPECT_EQ(description_of(read_back(top)), description_of(expected));
  }
}

TEST(WriteScenario, IsReadableWhateverTheExperimentIsCalled) {
  Experiment experiment = experiment_of(shipped("travelling_wave/uniform.simulation.xml"));
  experiment.path = "x/---<&>\xff\x01--.optimise.xml-";
  experiment.method.emplace<PagmoSettings>().algorithm = "a--b-";
  (void)expect_round_trip(experiment, {});
}

TEST(WriteScenario, SaysWhatCannotBeWritten) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "in the way";
  const Experiment experiment = experiment_of(shipped("travelling_wave/uniform.simulation.xml"));
  EXPECT_THROW(write_scenario(experiment, of({}), folder.path() / "file", "best"), FileError);
  Experiment unread = experiment;
  unread.scenario.sources.clear();
  EXPECT_THROW(write_scenario(unread, of({}), folder.path() / "other", "best"), FileError);
}

}  // namespace
}  // namespace proleg::optimize
