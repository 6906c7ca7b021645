#include "tools/proleg/ui/draft_session.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "mesh_shapes.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/ui/project_files.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"
#include "tools/proleg/ui/simulated_session.hpp"
#include "viewers.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

class DraftSessionTest : public ::testing::Test {
 protected:
  /// A copy of a shipped scenario, as a user has it.
  DraftSessionTest() {
    const sim::Scenario shipped = sim::shipped("travelling_wave/uniform");
    file_ = copy_sources(shipped.sources, folder_ / "mine").at(shipped.sources.front().path);
    open();
  }
  void open(bool has_file = true) {
    session_.reset();
    requests_.emplace();
    session_.emplace(
        sim::read_scenario(file_, disk_),
        DraftSessionOptions{
            folder_ / "", has_file, [this](const std::string& file) { return project_.has(file); }, {}, &meshes_},
        *requests_, present_, viewers_);
  }

  Viewers::Answer ask(const std::string& name, json arguments = json::object()) {
    const bool has_positions = name.starts_with("world.") || name.starts_with("robot.") ||
                               name.starts_with("behaviour.") || name == "draft.copy";
    if (has_positions && !arguments.contains("layout")) {
      arguments["layout"] = viewers_.document("draft")["layout"];
    }
    requests_->operate({++request_, name, std::move(arguments), 1, "a test"});
    return viewers_.answer(request_);
  }
  json must(const std::string& name, json arguments = json::object()) {
    const Viewers::Answer answer = ask(name, std::move(arguments));
    EXPECT_TRUE(answer.is_done) << name << ": " << answer.text;
    return answer.is_done ? json::parse(answer.text) : json();
  }
  /// The draft of a revision, or a later one.
  json draft(std::uint64_t revision) {
    return viewers_.document_when("draft", [&](const json& document) {
      return document.contains("revision") && document["revision"] >= revision;
    });
  }
  /// Where the robot of a revision will be.
  json path_of_revision(std::uint64_t revision) {
    return viewers_.document_when("foresight", [&](const json& document) {
      return document.contains("revision") && document["revision"] == revision && document["is_complete"] == true;
    });
  }
  json add_box() {
    const json answer = must("world.add", {{"item", "box"}, {"values", {{"height", 0.05}}}, {"position", {0, 1, 0}}});
    return draft(answer["revision"]);
  }
  /// A closed box of 200 x 400 x 600 units.
  static std::string box_stl() {
    std::string stl(80, '\0');
    const sim::TriangleMesh box = sim::box_mesh({100, 200, 300});
    const auto append = [&stl](const auto& value) { stl.append(reinterpret_cast<const char*>(&value), sizeof value); };
    append(static_cast<std::uint32_t>(box.triangles.size()));
    for (const auto& triangle : box.triangles) {
      stl.append(12, '\0');
      for (const std::uint32_t corner : triangle) {
        for (const double coordinate : box.vertices[corner]) {
          append(static_cast<float>(coordinate));
        }
      }
      stl.append(2, '\0');
    }
    return stl;
  }
  /// The mesh 1 of viewers.
  void send_box() {
    meshes_.set(1, std::make_shared<const sim::OwnMesh>(sim::read_own_mesh({{"box.stl", box_stl()}})));
  }
  static json mesh_words() {
    return {{"mesh", 1},
            {"factor", 0.001},
            {"quarters", {1, 0, 0}},
            {"colour", {1, 0, 0}},
            {"sheet", false},
            {"position", {0, 1, 0}},
            {"turn", 0}};
  }
  static json module_words() {
    return {{"mesh", 1},       {"factor", 0.0001}, {"quarters", {1, 0, 0}}, {"colour", {1, 0, 0}},
            {"name", "shell"}, {"length", 0.08},   {"mass", 0.15},          {"links", json::array()}};
  }
  [[nodiscard]] std::string world_file() const { return folder_ / "mine/flat.environment.xml"; }

  TemporaryFolder folder_;
  ProjectFiles project_{folder_ / "", source_path("/sim/scenarios"), RecentFiles(std::nullopt)};
  std::string file_;
  sim::DiskFiles disk_;
  Viewers viewers_;
  PresentDraft present_;
  SentMeshes meshes_;
  std::optional<SessionRequests> requests_;
  std::optional<DraftSession> session_;
  std::uint64_t request_ = 0;
};

TEST_F(DraftSessionTest, ShowsTheWorldOfTheScenario) {
  const json document = draft(0);
  EXPECT_EQ(document["file"], file_);
  EXPECT_EQ(document["changed"], json::array());
  EXPECT_EQ(document["undo"], json());
  ASSERT_EQ(document["world"]["objects"].size(), 1U);
  EXPECT_EQ(document["world"]["objects"][0]["name"], "floor");
  EXPECT_EQ(document["world"]["start"]["position"], json({0.0, 0.0, 0.026}));
  EXPECT_EQ(viewers_.document("draft_robot")["terrain"].size(), 1U);
  EXPECT_GE(viewers_.document("library").size(), 7U);
}

/// A scenario that names an algorithm that the program does not have.
class MissingAlgorithmTest : public DraftSessionTest {
 protected:
  [[nodiscard]] std::string gait_file() const { return folder_ / "mine/uniform.actuation.xml"; }
  [[nodiscard]] static std::string replaced(std::string text, const std::string& part, const std::string& by) {
    const std::size_t at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return text.replace(at, part.size(), by);
  }
  void name_algorithm(const std::string& name) {
    const std::string text = replaced(file_contents(gait_file()), "PatternGenerator_sinusoidal", name);
    std::ofstream(gait_file()) << text;
  }
  void write_algorithm(const std::string& name) {
    std::filesystem::create_directory(folder_ / name);
    std::ofstream(folder_ / name / "CMakeLists.txt") << "proleg_algorithm_project()\n";
    std::ofstream(folder_ / name / (name + ".cpp")) << "\n";
  }
};

TEST_F(MissingAlgorithmTest, OpeningNamesItAndItsSourceInTheProject) {
  name_algorithm("my_wave");
  const Viewers::Answer refused = ask("draft.open", {{"file", file_}});
  EXPECT_FALSE(refused.is_done);
  json missing = viewers_.document("missing_algorithms");
  EXPECT_EQ(missing["file"], file_);
  EXPECT_EQ(missing["action"], "open");
  EXPECT_EQ(missing["error"], refused.text);
  EXPECT_EQ(missing["algorithms"], json({{{"name", "my_wave"}, {"folder", nullptr}, {"library", nullptr}}}));

  write_algorithm("my_wave");
  EXPECT_FALSE(ask("draft.open", {{"file", file_}}).is_done);
  missing = viewers_.document("missing_algorithms");
  EXPECT_EQ(missing["algorithms"][0]["folder"], "my_wave");
  EXPECT_EQ(missing["algorithms"][0]["library"],
            (std::filesystem::canonical(folder_ / "my_wave") / "build/my_wave.so").string());
  EXPECT_EQ(draft(0)["behaviour"]["modules"][0]["algorithm"], "PatternGenerator_sinusoidal") << "the draft stays";

  must("draft.open", {{"file", source_path("/sim/scenarios/travelling_wave/coupled.simulation.xml")}});
  EXPECT_TRUE(viewers_.document("missing_algorithms").is_null());
}

TEST_F(MissingAlgorithmTest, RestoringKeepsTheChangesUntilItIsThere) {
  const std::string before = file_contents(gait_file());
  const std::string journal = folder_ / "mine/.uniform.simulation.xml.unsaved";
  add_box();
  session_.reset();
  json kept = json::parse(file_contents(journal));
  kept["process"] = "";  // of a program that has ended
  kept["files"] = {
      {gait_file(),
       {{"base", sha256_hex(before)}, {"text", replaced(before, "PatternGenerator_sinusoidal", "my_wave")}}}};
  std::ofstream(journal) << kept.dump();
  open();
  ASSERT_TRUE(viewers_.document("draft")["unsaved"].is_object());
  EXPECT_FALSE(ask("draft.restore").is_done);
  EXPECT_EQ(viewers_.document("missing_algorithms")["action"], "restore");
  EXPECT_EQ(viewers_.document("missing_algorithms")["algorithms"][0]["name"], "my_wave");
  EXPECT_TRUE(std::filesystem::exists(journal));
  EXPECT_TRUE(viewers_.document("draft")["unsaved"].is_object()) << "it can be tried again";
  must("draft.discard");
  EXPECT_TRUE(viewers_.document("missing_algorithms").is_null());
}

TEST_F(MissingAlgorithmTest, AProgramWithoutARobotBeginsWithIt) {
  write_algorithm("my_wave");
  session_.reset();
  requests_.emplace();
  session_.emplace(
      std::nullopt,
      DraftSessionOptions{folder_ / "", true, {}, {}, nullptr, MissingAlgorithms{file_, "start", "why", {"my_wave"}}},
      *requests_, present_, viewers_);
  const json missing = viewers_.document("missing_algorithms");
  EXPECT_EQ(missing["action"], "start");
  EXPECT_EQ(missing["algorithms"][0]["folder"], "my_wave");
}

TEST_F(DraftSessionTest, AnObjectIsAddedMovedAndTakenBack) {
  json document = add_box();
  ASSERT_EQ(document["world"]["objects"].size(), 2U);
  EXPECT_EQ(document["undo"], "add box");
  EXPECT_EQ(document["changed"], json({world_file()}));
  EXPECT_EQ(viewers_.document("draft_robot")["terrain"].size(), 2U);
  for (const double x : {0.1, 0.2, 0.3}) {
    must("world.place", {{"object", 1}, {"pose", {x, 1, 0.025, 1, 0, 0, 0}}, {"gesture", 7}});
  }
  document = draft(4);
  EXPECT_EQ(document["undo"], "move box");
  EXPECT_EQ(document["world"]["objects"][1]["pose"][0], 0.3);
  must("draft.undo");
  document = draft(5);
  EXPECT_EQ(document["world"]["objects"][1]["pose"][0], 0.0) << "a drag is one entry";
  EXPECT_EQ(document["redo"], "move box");
  must("draft.undo");
  EXPECT_EQ(draft(6)["changed"], json::array());
  EXPECT_EQ(ask("draft.undo").text, "there is nothing to undo");
}

TEST_F(DraftSessionTest, TheRunIsChangedValueByValue) {
  const json run = draft(0)["run"];
  EXPECT_EQ(run["engine"], "ode");
  EXPECT_EQ(run["tick"], 10.0);
  const std::vector<std::pair<const char*, json>> values{
      {"duration", 12.5},       {"seed", "18446744073709551615"}, {"tick", 20.0},        {"step", 0.5},
      {"solver", "direct"},     {"contact_noise", 0.25},          {"engine", "reduced"}, {"gravity", {0.0, 0.0, -1.62}},
      {"self_collision", false}};
  for (const auto& [name, value] : values) {
    const json answer = must("draft.run", {{"name", name}, {"value", value}});
    EXPECT_EQ(draft(answer["revision"])["run"][name], value) << name;
  }
  for (const json& bad : std::vector<json>{{{"name", "colour"}, {"value", 1}},
                                           {{"value", 1}},
                                           {{"name", "duration"}},
                                           {{"name", "duration"}, {"value", -1}},
                                           {{"name", "duration"}, {"value", "long"}},
                                           {{"name", "seed"}, {"value", 5}},
                                           {{"name", "seed"}, {"value", "-5"}},
                                           {{"name", "engine"}, {"value", "fast"}},
                                           {{"name", "solver"}, {"value", ""}},
                                           {{"name", "gravity"}, {"value", {1, 2}}},
                                           {{"name", "self_collision"}, {"value", 1}}}) {
    EXPECT_FALSE(ask("draft.run", bad).is_done) << bad;
  }
}

TEST_F(DraftSessionTest, SavesWhatHasChangedAndNothingElse) {
  const std::string before = file_contents(world_file());
  add_box();
  EXPECT_EQ(file_contents(world_file()), before);
  const json diff = must("draft.diff");
  ASSERT_EQ(diff["files"].size(), 1U);
  EXPECT_EQ(diff["files"][0]["old"], before);
  EXPECT_EQ(must("draft.save")["written"], 1);
  EXPECT_EQ(file_contents(world_file()), diff["files"][0]["new"]);
  EXPECT_EQ(viewers_.document_when("draft", [](const json& document) { return document["changed"].empty(); })["undo"],
            "add box");
  must("draft.undo");
  EXPECT_EQ(draft(2)["changed"], json({world_file()})) << "undo goes back behind Save";
}

TEST_F(DraftSessionTest, NeverOverwritesAFileThatHasChangedMeanwhile) {
  add_box();
  std::ofstream(world_file(), std::ios::app) << "<!-- by hand -->\n";
  const std::string by_hand = file_contents(world_file());
  EXPECT_NE(ask("draft.save").text.find("has changed since this program read it"), std::string::npos);
  EXPECT_EQ(file_contents(world_file()), by_hand);
  EXPECT_TRUE(ask("draft.save_as", {{"folder", "other"}}).is_done);
  EXPECT_NE(file_contents(folder_ / "other/flat.environment.xml").find("name=\"box\""), std::string::npos);
  EXPECT_EQ(file_contents(world_file()), by_hand);
}

TEST_F(DraftSessionTest, SaveAsMakesACompleteCopyAndGoesOnThere) {
  add_box();
  EXPECT_FALSE(ask("draft.save_as", {{"folder", "mine"}}).is_done) << "it exists";
  EXPECT_FALSE(ask("draft.save_as", {{"folder", "../out"}}).is_done);
  EXPECT_FALSE(ask("draft.save_as", {{"folder", ""}}).is_done);
  EXPECT_FALSE(ask("draft.save_as").is_done);
  const std::string copy = must("draft.save_as", {{"folder", "copy"}})["file"];
  EXPECT_EQ(sim::read_scenario(copy, disk_).environment.objects.size(), 2U);
  must("draft.undo");
  must("draft.save");
  EXPECT_EQ(sim::read_scenario(copy, disk_).environment.objects.size(), 1U);
}

TEST_F(DraftSessionTest, AScenarioWithoutFilesIsSavedAsACopy) {
  open(false);
  add_box();
  EXPECT_NE(ask("draft.save").text.find("no files yet"), std::string::npos);
  must("draft.save_as", {{"folder", "new"}});
  must("draft.save");
}

TEST_F(DraftSessionTest, AnOperationForAnotherListOfObjectsIsRefused) {
  const json before = draft(0);
  add_box();
  const Viewers::Answer answer = ask("world.remove", {{"objects", {0}}, {"layout", before["layout"]}});
  EXPECT_FALSE(answer.is_done);
  EXPECT_NE(answer.text.find("have changed meanwhile"), std::string::npos);
}

TEST_F(DraftSessionTest, BadArgumentsAreRefusedWithTheirReason) {
  add_box();
  struct Row {
    const char* name;
    json arguments;
    const char* reason;
  };
  const json place = {0, 0, 0, 1, 0, 0, 0};
  for (const Row& row :
       std::vector<Row>{{"world.fly", {}, "one of world.add"},
                        {"draft.fly", {}, "one of draft.copy"},
                        {"world.place", {{"pose", place}}, "object: found none"},
                        {"world.place", {{"object", -1}, {"pose", place}}, "object: found -1"},
                        {"world.place", {{"object", 9}, {"pose", place}}, "object: found 9"},
                        {"world.place", {{"object", 1}}, "pose: found 0 numbers"},
                        {"world.place", {{"object", 1}, {"pose", {0, 0, 0, 0, 0, 0, 0}}}, "quaternion"},
                        {"world.place", {{"object", 1}, {"pose", {0, 0, 1e300, 1, 0, 0, 0}}}, "flat.environment.xml"},
                        {"world.place", {{"object", 1}, {"pose", "there"}}, "pose"},
                        {"world.resize", {{"object", 1}, {"shape", 0}, {"size", {1, 2}}}, "2 numbers"},
                        {"world.friction", {{"object", 1}, {"value", "ice"}}, "value"},
                        {"world.mass", {{"object", 1}, {"value", 1}}, "does not move"},
                        {"world.rename", {{"object", 1}, {"name", 5}}, "name"},
                        {"world.add", {{"item", "castle"}, {"position", {0, 0, 0}}}, "an item of the library"},
                        {"world.add", {{"item", "box"}, {"position", {0, 0}}}, "2 numbers"},
                        {"world.add", {{"item", "box"}, {"position", {0, 0, 0}}, {"values", {1, 2}}}, "values"},
                        {"world.duplicate", {{"objects", {1}}, {"step", {1, 0, 0}}, {"count", 1000000}}, "1 to 200"},
                        {"world.duplicate", {{"step", {1, 0, 0}}}, "objects: found none"},
                        {"world.remove", {{"objects", {1, 9}}}, "object: found 9"},
                        {"world.paste", {{"text", 5}, {"step", {1, 0, 0}}}, "text"},
                        {"world.paste", {{"text", "hello"}, {"step", {1, 0, 0}}}, "found 'hello', expected objects"},
                        {"world.paste", {{"text", "<KinBody/>"}, {"step", {0, 0, 0}}}, "step"},
                        {"draft.copy", {{"objects", {77}}}, "object: found 77"},
                        {"robot.table", {{"joints", 5}}, "joints: found no list"},
                        {"robot.table", {{"joints", {5}}}, "an object for each joint"},
                        {"robot.table", {{"joints", {{{"joint", 0}, {"limits", {1}}}}}}, "two numbers"},
                        {"robot.table", {{"joints", {{{"joint", 0}, {"torque", -1}}}}}, "torque of J5: found '-1'"},
                        {"world.start", {{"position", {0, 0, 0}}}, "degrees"},
                        {"world.ruler", {{"ruler", 3}, {"from", {0, 0, 0}}, {"to", {0, 1, 0}}}, "ruler: found 3"}}) {
    const Viewers::Answer answer = ask(row.name, row.arguments);
    EXPECT_FALSE(answer.is_done) << row.name;
    EXPECT_NE(answer.text.find(row.reason), std::string::npos) << row.name << ": " << answer.text;
    EXPECT_EQ(answer.text.find('\n'), std::string::npos);
  }
  EXPECT_EQ(draft(0)["revision"], 1) << "nothing has changed";
}

// What the path says is what a simulation then does, to the bit of the reduced engine.
TEST_F(DraftSessionTest, ForesightIsThePathThatTheSimulationTakes) {
  must("world.friction", {{"object", 0}, {"value", 0.3}});
  const json foresight = path_of_revision(1);
  ASSERT_EQ(foresight["failure"], json()) << foresight;
  EXPECT_EQ(foresight["engine"], "reduced");
  must("draft.save");
  sim::Scenario scenario = sim::read_scenario(file_, disk_);
  scenario.environment.engine = sim::PhysicsEngine::reduced;
  sim::Simulation simulation(scenario);
  const json& path = foresight["path"];
  ASSERT_EQ(path.size(), 301U);
  for (std::size_t point = 1; point < path.size(); ++point) {
    for (int tick = 0; tick < 10; ++tick) {
      simulation.advance();
    }
    const Eigen::Vector3d& head = simulation.plant().link_poses().front().position;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(path[point][static_cast<std::size_t>(axis)], std::round(head[axis] * 1e4) / 1e4);
    }
  }
  EXPECT_EQ(foresight["distance"], simulation.measures()[sim::Measure::distance]);
}

// A path takes seconds of a core, and a robot that is only driven needs none.
TEST_F(DraftSessionTest, NoPathIsComputedBeforeSomebodyAsksAboutTheDraft) {
  draft(0);
  for (int wait = 0; wait < 100; ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_EQ(viewers_.document("foresight"), json());
  }
  must("draft.refresh");
  EXPECT_EQ(path_of_revision(0)["failure"], json());
}

TEST_F(DraftSessionTest, AWorldThatTheReducedEngineLacksIsForeseenByOde) {
  must("world.add", {{"item", "sphere"}, {"position", {0, 2, 0}}});
  const json foresight = path_of_revision(1);
  EXPECT_EQ(foresight["engine"], "ode");
  EXPECT_EQ(foresight["failure"], json());
}

// A sheet of 60,000 triangles, and the same with another scale.
TEST_F(DraftSessionTest, TheMeshesOfADraftHaveALimitTogether) {
  constexpr std::uint32_t cells = 173;
  const sim::TriangleMesh mesh = sim::sheet(cells, 1.0);
  std::ostringstream off;
  off << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    off << vertex.x() << ' ' << vertex.y() << ' ' << vertex.z() << '\n';
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    off << "3 " << a << ' ' << b << ' ' << c << '\n';
  }
  meshes_.set(2, std::make_shared<const sim::OwnMesh>(sim::read_own_mesh({{"sheet.off", std::move(off).str()}})));
  const auto add = [this](double factor) {
    return ask("world.add_mesh", {{"mesh", 2},
                                  {"factor", factor},
                                  {"quarters", {0, 0, 0}},
                                  {"sheet", true},
                                  {"colour", {0.6, 0.5, 0.4}},
                                  {"position", {0, 2, 0}},
                                  {"turn", 0}});
  };
  ASSERT_TRUE(add(1.0).is_done);
  EXPECT_TRUE(add(1.0).is_done) << "both share the mesh";
  const Viewers::Answer answer = add(0.5);
  EXPECT_FALSE(answer.is_done);
  EXPECT_NE(answer.text.find("meshes of 119716 triangles in all, expected at most 80000"), std::string::npos)
      << answer.text;
  EXPECT_EQ(must("draft.diff")["files"].size(), 2) << "the world and one mesh";
  must("world.friction", {{"object", 0}, {"value", 0.3}});
}

TEST_F(DraftSessionTest, ItsSimulationIsTheOneOfItsFiles) {
  add_box();
  Viewers robot_viewers;
  SessionRequests robot_requests;
  const auto options = [&] {
    SimulatedSessionOptions result{
        folder_ / "", "proleg simulate", [](const std::string& file) { return "simulate " + file; }, true, "test",
        true};
    result.draft = &present_;
    return result;
  };
  SimulatedSession robot(nullptr, options(), robot_requests, robot_viewers);
  robot_requests.operate({1, "load_draft", json::object(), 1, "a test"});
  ASSERT_TRUE(robot_viewers.answer(1).is_done);
  EXPECT_EQ(robot_viewers.document("robot")["terrain"].size(), 2U);
  robot_requests.operate({2, "command_line", json::object(), 1, "a test"});
  EXPECT_NE(robot_viewers.answer(2).text.find("not saved"), std::string::npos);
  must("draft.save");
  static_cast<void>(viewers_.document_when("draft", [](const json& document) { return document["changed"].empty(); }));
  robot_requests.operate({3, "load_draft", json::object(), 1, "a test"});
  ASSERT_TRUE(robot_viewers.answer(3).is_done);
  robot_requests.operate({4, "command_line", json::object(), 1, "a test"});
  EXPECT_NE(robot_viewers.answer(4).text.find("simulate " + file_), std::string::npos) << robot_viewers.answer(4).text;
}

TEST_F(DraftSessionTest, UnsavedChangesOutliveTheProgram) {
  const std::string journal = folder_ / "mine/.uniform.simulation.xml.unsaved";
  EXPECT_EQ(draft(0)["unsaved"], json());
  const json before = add_box();
  open();  // the program ends and begins again
  EXPECT_TRUE(std::filesystem::exists(journal));
  json document = draft(0);
  ASSERT_EQ(document["revision"], 0);
  EXPECT_EQ(document["unsaved"]["files"], json({world_file()}));
  must("draft.restore");
  document = draft(1);
  EXPECT_EQ(document["world"], before["world"]);
  EXPECT_EQ(document["unsaved"], json());
  must("draft.undo");
  EXPECT_EQ(draft(2)["world"]["objects"].size(), 1U) << "undo goes back to the files";
  must("draft.redo");
  must("draft.save");
  open();
  EXPECT_FALSE(std::filesystem::exists(journal)) << "all is saved";
  EXPECT_EQ(draft(0)["unsaved"], json());
}

TEST_F(DraftSessionTest, AMeshIsAddedSavedAndCopiedAsItCame) {
  send_box();
  must("world.add_mesh", mesh_words());
  const json document = draft(1);
  EXPECT_EQ(document["undo"], "add box.stl");
  const std::string file = folder_ / "mine/meshes/box.stl";
  EXPECT_EQ(document["changed"], json({world_file(), file}));
  EXPECT_EQ(document["world"]["objects"][1]["name"], "box");
  EXPECT_EQ(document["world"]["objects"][1]["shapes"][0]["size"].size(), 3U);
  EXPECT_EQ(viewers_.document("draft_meshes").size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "mine/meshes")) << "nothing on disk changes before Save";
  const json diff = must("draft.diff")["files"];
  EXPECT_EQ(diff[1]["bytes"], box_stl().size());
  EXPECT_EQ(diff[1]["new"], json());
  EXPECT_EQ(must("draft.save")["written"], 2);
  EXPECT_EQ(file_contents(file), box_stl());
  EXPECT_EQ(must("draft.save")["written"], 0);
  must("draft.save_as", {{"folder", "copy"}});
  EXPECT_EQ(file_contents(folder_ / "copy/meshes/box.stl"), box_stl());
  must("draft.undo");
  EXPECT_EQ(draft(2)["world"]["objects"].size(), 1U) << "undo goes back behind Save";
}

TEST_F(DraftSessionTest, AMeshThatIsDeletedBeforeSaveIsNotSaved) {
  send_box();
  must("world.add_mesh", mesh_words());
  must("world.remove", {{"objects", {1}}, {"group", true}});
  EXPECT_EQ(draft(2)["changed"], json::array());
  EXPECT_EQ(must("draft.save")["written"], 0);
  must("draft.undo");
  must("draft.save");
  EXPECT_EQ(file_contents(folder_ / "mine/meshes/box.stl"), box_stl());
}

TEST_F(DraftSessionTest, AMeshThatIsNotSavedOutlivesTheProgram) {
  send_box();
  must("world.add_mesh", mesh_words());
  must("robot.own_module", module_words());
  const json before = draft(2);
  open();
  EXPECT_EQ(draft(0)["unsaved"]["files"].size(), before["changed"].size());
  must("draft.restore");
  EXPECT_EQ(draft(1)["world"], before["world"]);
  EXPECT_EQ(draft(1)["robot"], before["robot"]);
  must("draft.save");
  EXPECT_EQ(file_contents(folder_ / "mine/meshes/box.stl"), box_stl());
  EXPECT_EQ(file_contents(folder_ / "mine/modules_shell/box.stl"), box_stl());
}

TEST_F(DraftSessionTest, AMeshBecomesAModuleOfSomeLinksOrAll) {
  send_box();
  json words = module_words();
  words["links"] = json({0, 2});
  must("robot.own_module", words);
  json robot = draft(1)["robot"];
  EXPECT_EQ(robot["kinds"], json({{{"name", "shell"}, {"length", 0.08}}}));
  EXPECT_EQ(robot["links"][0]["mass"], 0.15);
  EXPECT_NE(robot["links"][1]["mass"], 0.15);
  EXPECT_EQ(robot["links"][2]["mass"], 0.15);
  must("robot.kind", {{"kind", "shell"}, {"link", nullptr}});
  robot = draft(2)["robot"];
  for (const json& link : robot["links"]) {
    EXPECT_EQ(link["mass"], 0.15);
  }
  must("robot.mass", {{"link", 1}, {"value", 0.3}});
  EXPECT_EQ(draft(3)["robot"]["links"][1]["mass"], 0.3);
  EXPECT_FALSE(ask("robot.own_module", module_words()).is_done) << "there is a kind of this name";
  must("draft.save");
  open();
  EXPECT_EQ(draft(0)["robot"]["kinds"][0]["name"], "shell");
}

TEST_F(DraftSessionTest, OperationsWithAMeshAreRefusedInOneLine) {
  send_box();
  const std::vector<json> values{
      json(), -1, 0, 2, 1e99, "a", json::array(), json({1, 2}), json({9, 0, 0}), json::object(), true, 4294967295U};
  for (const auto& [name, good] :
       {std::pair("world.add_mesh", mesh_words()), std::pair("robot.own_module", module_words())}) {
    for (const auto& [member, value] : good.items()) {
      for (const json& bad : values) {
        json words = good;
        words[member] = bad;
        const Viewers::Answer answer = ask(name, words);
        EXPECT_EQ(answer.text.find('\n'), std::string::npos);
        if (answer.is_done) {
          must("draft.undo");
        }
      }
    }
  }
  EXPECT_EQ(must("draft.refresh")["changed"], false);
  EXPECT_EQ(viewers_.document_when("draft", [](const json& document) { return document["changed"].empty(); })["undo"],
            json());
}

TEST_F(DraftSessionTest, UnsavedChangesCanBeDiscarded) {
  add_box();
  open();
  must("draft.discard");
  EXPECT_EQ(
      viewers_.document_when("draft", [](const json& document) { return document["unsaved"].is_null(); })["changed"],
      json::array());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "mine/.uniform.simulation.xml.unsaved"));
  EXPECT_FALSE(ask("draft.restore").is_done);
}

TEST_F(DraftSessionTest, UnsavedChangesAboutWhichNobodyDecidesAreKeptAside) {
  const std::string journal = folder_ / "mine/.uniform.simulation.xml.unsaved";
  add_box();
  open();
  must("world.friction", {{"object", 0}, {"value", 0.25}});
  must("draft.undo");
  session_.reset();
  EXPECT_NE(file_contents(journal + ".old").find("box"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(journal));
}

TEST_F(DraftSessionTest, UnsavedChangesOfOtherFilesAreNotRestored) {
  const std::string journal = folder_ / "mine/.uniform.simulation.xml.unsaved";
  add_box();
  session_.reset();
  std::ofstream(world_file(), std::ios::app) << "<!-- by hand -->\n";
  open();
  EXPECT_EQ(draft(0)["unsaved"], json());
  EXPECT_NE(viewers_.notices().find("has changed since"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(journal + ".old")) << "nothing is lost";
  session_.reset();
  for (const char* damage : {"", "{}", "no JSON", R"({"format":1,"process":1e99})", R"({"format":2})",
                             R"({"format":1,"process":0,"time_ms":1,"files":{"a":{"base":null,"text":5}}})"}) {
    std::ofstream(journal) << damage;
    open();
    EXPECT_EQ(draft(0)["unsaved"], json()) << damage;
    session_.reset();
  }
}

TEST_F(DraftSessionTest, UnsavedChangesOfAProgramThatStillRunsAreLeftToIt) {
  const std::string journal = folder_ / "mine/.uniform.simulation.xml.unsaved";
  add_box();
  session_.reset();
  json document = json::parse(file_contents(journal));
  const std::string parent = process_identity(getppid());
  ASSERT_NE(parent, "");
  document["process"] = parent;
  std::ofstream(journal) << document;
  open();
  EXPECT_EQ(draft(0)["unsaved"], json());
  add_box();
  session_.reset();
  EXPECT_EQ(json::parse(file_contents(journal)), document) << "it is that program's";
  // The number of a process that has ended may belong to another one today.
  document["process"] = std::to_string(getppid()) + " 1 another boot";
  std::ofstream(journal) << document;
  open();
  EXPECT_EQ(draft(0)["unsaved"]["files"], json({world_file()}));
  EXPECT_EQ(process_identity(-1), "");
}

TEST_F(DraftSessionTest, ASaveThatFailedInTheMiddleCanBeRepeated) {
  add_box();
  std::ofstream(world_file()) << must("draft.diff")["files"][0]["new"].get<std::string>();
  EXPECT_EQ(must("draft.save")["written"], 1);
}

TEST_F(DraftSessionTest, AFullDiskAtSaveLosesNothing) {
  add_box();
  const std::string before = file_contents(world_file());
  // As a full disk does, this limit ends a write in the middle.
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{100, limit.rlim_max};
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Viewers::Answer answer = ask("draft.save");
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  EXPECT_FALSE(answer.is_done);
  EXPECT_NE(answer.text.find("flat.environment.xml"), std::string::npos) << answer.text;
  EXPECT_EQ(viewers_.document("draft")["changed"], json({world_file()}));
  EXPECT_EQ(file_contents(world_file()), before) << "the file is as it was";
  EXPECT_EQ(must("draft.save")["written"], 1);
  std::signal(SIGXFSZ, old_handler);
}

TEST_F(DraftSessionTest, AWorldOfFiveHundredObjectsCanBeChangedAndSimulated) {
  add_box();
  for (const int count : {200, 200, 98}) {
    must("world.duplicate", {{"objects", {1}}, {"group", true}, {"step", {0.0, 0.5, 0.0}}, {"count", count}});
  }
  const json document = draft(4);
  ASSERT_EQ(document["world"]["objects"].size(), 500U);
  must("world.friction", {{"object", 499}, {"value", 0.25}});
  const sim::Scenario scenario = *present_.get().scenario;
  sim::Simulation simulation(scenario);
  for (int tick = 0; tick < 10; ++tick) {
    simulation.advance();
  }
  EXPECT_EQ(scenario.environment.objects.size(), 500U);
}

// A module of another kind was added, saved, and taken back; then it came again.
TEST_F(DraftSessionTest, FilesThatWereSavedAndTakenBackAreRestored) {
  must("robot.kind", {{"kind", "snake"}, {"link", json()}});
  must("draft.save");
  must("draft.undo");
  must("draft.save");
  must("draft.redo");
  must("robot.rename", {{"name", "viper"}});
  const json wanted = draft(4)["robot"];
  open();
  EXPECT_NE(viewers_.document("draft")["unsaved"], json()) << viewers_.notices();
  must("draft.restore");
  EXPECT_EQ(draft(1)["robot"], wanted);
  must("draft.save");
}

TEST_F(DraftSessionTest, AJournalRestoresNoFileOutsideOfTheFoldersOfTheScenario) {
  add_box();
  const std::string journal = folder_ / "mine/.uniform.simulation.xml.unsaved";
  session_.reset();
  const json written = json::parse(file_contents(journal));
  for (const std::string& outside :
       {std::string(folder_ / "other.xml"), std::string(folder_ / "mine/../other.xml"), std::string("other.xml")}) {
    json document = written;
    document["files"][outside] = {{"base", json()}, {"text", "<a/>"}};
    std::ofstream(journal) << document;
    open();
    EXPECT_EQ(viewers_.document("draft")["unsaved"], json()) << outside;
    EXPECT_NE(viewers_.notices().find("not beside the scenario"), std::string::npos) << viewers_.notices();
    session_.reset();
  }
}

TEST_F(DraftSessionTest, AJournalThatCannotBeWrittenIsSaidOnce) {
  session_.reset();
  std::filesystem::create_directory(folder_ / "mine/.uniform.simulation.xml.unsaved");  // nothing can be written there
  open();
  add_box();
  must("world.friction", {{"object", 1}, {"value", 0.25}});
  session_.reset();
  const std::string notices = viewers_.notices();
  const std::size_t first = notices.find("unsaved changes are lost");
  EXPECT_NE(first, std::string::npos);
  EXPECT_EQ(notices.find("unsaved changes are lost", first + 1), std::string::npos);
}

TEST_F(DraftSessionTest, TheRobotIsChangedPartByPart) {
  const json robot = draft(0)["robot"];
  ASSERT_EQ(robot["joints"].size(), 5U);
  EXPECT_EQ(robot["joints"][0]["name"], "J5") << "from the head";
  EXPECT_EQ(robot["links"][1]["same"], 4);
  EXPECT_EQ(robot["obstacle"], json());
  must("robot.axis", {{"joints", {0, 2}}, {"value", {0, 0, 1}}});
  must("robot.limits", {{"joints", {0}}, {"lower", -30}, {"upper", 45}});
  must("robot.servo", {{"name", "latency"}, {"value", 4}});
  must("robot.duplicate", {{"joint", 4}});
  must("robot.add_sensor", {{"kind", "Inclinometer"}, {"part", 0}});
  const json now = draft(must("robot.rename", {{"name", "worm"}})["revision"])["robot"];
  EXPECT_EQ(now["name"], "worm");
  EXPECT_EQ(now["joints"].size(), 6U);
  EXPECT_EQ(now["joints"][0]["limits"], json({-30.0, 45.0}));
  EXPECT_EQ(now["joints"][2]["axis"], json({0.0, 0.0, 1.0}));
  EXPECT_EQ(now["servo"]["latency"], 4.0);
  EXPECT_EQ(now["sensors"][0]["part_name"], "Head");
  EXPECT_EQ(viewers_.document("draft_robot")["links"].size(), 7U);
  EXPECT_EQ(viewers_.document("draft")["behaviour"]["modules"][0]["joints"].size(), 6U) << "its gait has grown with it";
}

TEST_F(DraftSessionTest, ATableOfJointsIsOneChange) {
  must("robot.table", {{"joints", {{{"joint", 0}, {"name", "neck"}}, {{"joint", 4}, {"torque", 0.25}}}}});
  const json longer = must("robot.table", {{"joints", {{{"joint", 0}, {"limits", {-30, 30}}}}}, {"count", 7}});
  const json now = draft(longer["revision"])["robot"];
  ASSERT_EQ(now["joints"].size(), 7U);
  EXPECT_EQ(now["joints"][0]["limits"], json({-30.0, 30.0}));
  EXPECT_EQ(now["joints"][6]["torque"], 0.25);
  const json back = draft(must("draft.undo")["revision"])["robot"];
  ASSERT_EQ(back["joints"].size(), 5U);
  EXPECT_EQ(back["joints"][0]["name"], "neck");
}

TEST_F(DraftSessionTest, ObjectsAreCopiedIntoAScenarioThatIsOpenedLater) {
  add_box();
  const std::string text = must("draft.copy", {{"objects", {1}}})["text"];
  must("world.paste", {{"text", text}, {"step", {0.5, 0, 0}}});
  const json objects = viewers_.document("draft")["world"]["objects"];
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_NEAR(objects[2]["pose"][0].get<double>() - objects[1]["pose"][0].get<double>(), 0.5, 1e-6);
  must("draft.save");
  must("draft.new", {{"kind", "snake"}});
  const std::size_t before = viewers_.document("draft")["world"]["objects"].size();
  must("world.paste", {{"text", text}, {"step", {0.5, 0, 0}}});
  const json pasted = viewers_.document("draft")["world"]["objects"];
  ASSERT_EQ(pasted.size(), before + 1);
  EXPECT_EQ(pasted[before]["pose"], objects[1]["pose"]) << "where it stood";
}

TEST_F(DraftSessionTest, TheBehaviourIsModulesOfJoints) {
  const json before = draft(0)["behaviour"];
  ASSERT_EQ(before["modules"].size(), 1U);
  const auto raw = [](double degrees) { return std::lround(degrees / 90.0 * quarter_turn); };
  EXPECT_EQ(before["modules"][0]["values"]["amplitude"][0], raw(40));
  must("behaviour.add", {{"algorithm", "DirectJointAccess"}, {"joints", {0}}});
  must("behaviour.set", {{"module", 1}, {"parameter", "angle"}, {"joints", {0}}, {"value", "-12.5"}});
  must("behaviour.joints", {{"module", 0}, {"joints", {1, 2, 3, 4}}});
  const json answer = must("behaviour.algorithm", {{"module", 0}, {"algorithm", "PatternGenerator_serpenoid"}});
  const json now = draft(answer["revision"])["behaviour"];
  EXPECT_EQ(now["modules"][0]["algorithm"], "PatternGenerator_serpenoid");
  EXPECT_EQ(now["modules"][0]["joints"], json({1, 2, 3, 4}));
  EXPECT_EQ(now["modules"][1]["values"]["angle"], json::array({raw(-12.5)}));
  for (const auto& [name, bad] : std::vector<std::pair<const char*, json>>{
           {"behaviour.add", {{"algorithm", "nothing"}, {"joints", {0}}}},
           {"behaviour.add", {{"algorithm", 7}, {"joints", {0}}}},
           {"behaviour.joints", {{"module", 0}, {"joints", {99}}}},
           {"behaviour.joints", {{"module", 0}, {"joints", {-1}}}},
           {"behaviour.set", {{"module", 0}, {"parameter", "amplitude"}, {"joints", {1}}, {"value", "much"}}},
           {"behaviour.set", {{"module", 9}, {"parameter", "amplitude"}, {"joints", {1}}, {"value", "1"}}},
           {"behaviour.fly", json::object()}}) {
    EXPECT_FALSE(ask(name, bad).is_done) << name << bad;
  }
}

TEST_F(DraftSessionTest, APositionThatMeansAnotherPartIsRefused) {
  must("robot.axis", {{"joints", {0}}, {"value", {0, 0, 1}}});
  const json layout = draft(1)["layout"];
  const json order = json::array({1, 0, 2, 3, 4});
  must("robot.order", {{"order", order}});
  EXPECT_NE(ask("robot.axis", {{"joints", {0}}, {"value", {1, 0, 1}}, {"layout", layout}}).text.find("meanwhile"),
            std::string::npos);
  const json later = draft(2)["layout"];
  must("draft.undo");
  EXPECT_NE(ask("robot.axis", {{"joints", {0}}, {"value", {1, 0, 1}}, {"layout", later}}).text.find("meanwhile"),
            std::string::npos)
      << "undo has exchanged them again";
}

TEST_F(DraftSessionTest, ANewScenarioIsWhatItsArgumentsSay) {
  const json answer = must("draft.new", {{"kind", "cubo"},
                                         {"axes", "pypy"},
                                         {"name", "worm"},
                                         {"algorithm", "PatternGenerator_serpenoid"},
                                         {"item", "stairs"},
                                         {"friction", 0.5}});
  json document = draft(answer["revision"]);
  EXPECT_FALSE(document["has_file"]);
  EXPECT_EQ(document["robot"]["name"], "worm");
  EXPECT_EQ(document["robot"]["joints"].size(), 4U);
  ASSERT_EQ(document["behaviour"]["modules"].size(), 1U);
  EXPECT_EQ(document["behaviour"]["modules"][0]["algorithm"], "PatternGenerator_serpenoid");
  EXPECT_EQ(document["behaviour"]["modules"][0]["joints"].size(), 4U);
  EXPECT_EQ(document["world"]["objects"][0]["shapes"][0]["friction"], 0.5);
  EXPECT_GT(document["world"]["objects"].size(), 2U);
  EXPECT_EQ(document["undo"], json());
  EXPECT_FALSE(ask("draft.save").is_done) << "it has no files yet";
  const std::string file = must("draft.save_as", {{"folder", "worm"}})["file"];
  const sim::Scenario saved = sim::read_scenario(file, disk_);
  EXPECT_EQ(saved.robot.joints.size(), 4U);
  must("world.remove", {{"objects", {1}}, {"group", true}});
  EXPECT_EQ(must("draft.save")["written"], 1) << "Save goes on where Save as has written";
}

TEST_F(DraftSessionTest, ANewScenarioOfEachKindHasItsUsualForm) {
  std::uint64_t revision = 0;
  const json parts = viewers_.document("parts");
  for (const json& kind : parts["kinds"]) {
    const json answer = must("draft.new", {{"kind", kind["name"]}});
    EXPECT_GT(answer["revision"], revision) << "a count that never goes back";
    revision = answer["revision"];
    EXPECT_EQ(draft(revision)["robot"]["joints"].size(), kind["joints"]) << kind;
  }
  for (const json& bad : std::vector<json>{{{"kind", "whale"}},
                                           {{"axes", ""}},
                                           {{"axes", "pxp"}},
                                           {{"axes", std::string(65, 'p')}},
                                           {{"axes", 5}},
                                           {{"algorithm", "nothing"}},
                                           {{"item", "volcano"}},
                                           {{"friction", -1}},
                                           {{"name", std::string(100, 'x')}}}) {
    const json before = viewers_.document("draft")["revision"];
    EXPECT_FALSE(ask("draft.new", bad).is_done) << bad;
    EXPECT_EQ(viewers_.document("draft")["revision"], before) << "the draft stays as it was";
  }
}

TEST_F(DraftSessionTest, ChangesOfAScenarioWithoutFilesAreNotDroppedUnasked) {
  must("draft.new", {{"kind", "snake"}});
  must("draft.new", {{"kind", "cubo"}});
  must("robot.rename", {{"name", "mine"}});
  EXPECT_NE(ask("draft.new").text.find("not saved"), std::string::npos);
  EXPECT_NE(ask("draft.open", {{"file", file_}}).text.find("not saved"), std::string::npos);
  EXPECT_EQ(viewers_.document("draft")["robot"]["name"], "mine");
  must("draft.new", {{"discard", true}});
}

TEST_F(DraftSessionTest, OpensScenariosOfItsFolderAndShippedOnes) {
  const std::string shipped = source_path("/sim/scenarios/robots/snake/robot.simulation.xml");
  json document = draft(must("draft.open", {{"file", shipped}})["revision"]);
  EXPECT_EQ(document["robot"]["joints"].size(), 8U);
  EXPECT_TRUE(document["is_shipped"]);
  document = draft(must("draft.open", {{"file", file_}})["revision"]);
  EXPECT_EQ(document["file"], file_);
  std::filesystem::create_symlink(source_path("/tests/sim/scenario/thesis"), folder_ / "out");
  for (const std::filesystem::path& bad : std::vector<std::filesystem::path>{
           "/etc/passwd", "", folder_ / "mine/../../nothing.simulation.xml", folder_ / "out/MFIdemo.simulation.xml",
           folder_ / "mine/caterpillar.robot.xml", source_path("/tests/sim/scenario/thesis/MFIdemo.simulation.xml")}) {
    EXPECT_FALSE(ask("draft.open", {{"file", bad.string()}}).is_done) << bad;
  }
}

TEST_F(DraftSessionTest, APartOfAnotherScenarioCanBeTaken) {
  const std::string stairs = source_path("/sim/scenarios/obstacle/plain.simulation.xml");
  const std::size_t objects = sim::read_scenario(stairs, disk_).environment.objects.size();
  const std::string before = file_contents(file_);
  json document = draft(must("draft.take", {{"file", stairs}, {"parts", {"environment"}}})["revision"]);
  EXPECT_EQ(document["world"]["objects"].size(), objects);
  EXPECT_EQ(document["robot"]["joints"].size(), 5U);
  EXPECT_EQ(document["undo"], "environment of plain.simulation.xml");
  const std::string snake = source_path("/sim/scenarios/robots/snake/robot.simulation.xml");
  EXPECT_NE(ask("draft.take", {{"file", snake}, {"parts", {"robot"}}}).text.find("8 characters"), std::string::npos)
      << "the gait is made for five joints";
  document = draft(must("draft.take", {{"file", snake}, {"parts", {"robot", "actuation"}}})["revision"]);
  EXPECT_EQ(document["robot"]["joints"].size(), 8U);
  EXPECT_EQ(document["world"]["objects"].size(), objects);
  const std::string copy = must("draft.save_as", {{"folder", "both"}})["file"];
  const sim::Scenario both = sim::read_scenario(copy, disk_);
  EXPECT_EQ(both.robot.joints.size(), 8U);
  for (const sim::SourceFile& source : both.sources) {
    EXPECT_TRUE(source.path.starts_with(std::string(folder_ / "both")))
        << "the copy needs no other folder: " << source.path;
  }
  EXPECT_EQ(file_contents(file_), before);
  for (const json& bad : std::vector<json>{{{"file", "/etc/passwd"}, {"parts", {"robot"}}},
                                           {{"file", snake}, {"parts", {"wheels"}}},
                                           {{"file", snake}, {"parts", json::array()}},
                                           {{"file", snake}}}) {
    EXPECT_FALSE(ask("draft.take", bad).is_done) << bad;
  }
}

TEST_F(DraftSessionTest, UnsavedChangesAreOfferedWhenTheirScenarioIsOpenedAgain) {
  add_box();
  must("draft.open", {{"file", source_path("/sim/scenarios/robots/snake/robot.simulation.xml")}});
  const json document = draft(must("draft.open", {{"file", file_}})["revision"]);
  EXPECT_EQ(document["changed"], json::array());
  EXPECT_EQ(document["unsaved"]["files"], json({world_file()}));
  must("draft.restore");
  EXPECT_EQ(draft(document["revision"].get<std::uint64_t>() + 1)["world"]["objects"].size(), 2U);
}

TEST(DraftSessionWithoutAScenario, MakesOne) {
  const TemporaryFolder folder;
  Viewers viewers;
  PresentDraft present;
  SessionRequests requests;
  const DraftSession session({}, {folder / ""}, requests, present, viewers);
  requests.operate({1, "draft.new", json::object(), 1, "a test"});
  EXPECT_TRUE(viewers.answer(1).is_done);
  EXPECT_EQ(
      viewers.document_when("draft", [](const json& draft) { return !draft.is_null(); })["robot"]["joints"].size(), 5U);
}

TEST(DraftSessionWithoutAScenario, RefusesEveryChange) {
  Viewers viewers;
  PresentDraft present;
  SessionRequests requests;
  const DraftSession session({}, {}, requests, present, viewers);
  requests.operate({1, "world.add", {{"item", "box"}}, 1, "a test"});
  EXPECT_NE(viewers.answer(1).text.find("there is no scenario to change"), std::string::npos);
  EXPECT_EQ(viewers.document("draft"), json());
}

}  // namespace
}  // namespace proleg::tools
