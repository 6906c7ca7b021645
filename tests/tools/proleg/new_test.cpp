// proleg new robot: the files it writes can be simulated at once.

#include <cmath>

#include "command_line.hpp"
#include "json_result.hpp"
#include "sim/record/svg.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::test {
namespace {

class NewRobot : public CommandLine {
 protected:
  /// Writes a robot into a folder of that name.
  void write(const std::string& name, const std::string& joints, const std::string& axes) const {
    const Finished finished =
        proleg({"new", "robot", "--joints", joints, "--axes", axes, "--out", file(name).string()});
    ASSERT_EQ(finished.status, 0) << finished.err;
    EXPECT_NE(finished.out.find(file(name + "/robot.simulation.xml").string()), std::string::npos) << finished.out;
  }

  [[nodiscard]] Json run(const std::string& name, const std::string& seconds,
                         const std::string& subcommand = "simulate") const {
    const Finished finished =
        proleg({subcommand, file(name + "/robot.simulation.xml").string(), "--seconds", seconds, "--json"});
    EXPECT_EQ(finished.status, 0) << finished.err;
    if (finished.err.find("slower than real time") == std::string::npos) {  // many links, on a slow computer
      EXPECT_EQ(finished.err, "");
    }
    return Json(finished.out);
  }
};

TEST_F(NewRobot, FivePitchJointsRepeatTheShippedTravellingWaveToTheLastBit) {
  write("five", "5", "p");
  const Json written = run("five", "5");
  const Json shipped(proleg({"simulate", scenario("uniform"), "--seconds", "5", "--json"}).out);
  for (const char* name : {"displacement_m", "contacts_mean", "setpoint_hash", "servo_hash", "measures"}) {
    EXPECT_EQ(written[name], shipped[name]) << name;
  }
}

TEST_F(NewRobot, FloorAndLinksAreTheShippedFiles) {
  write("five", "5", "p");
  for (const char* name : {"flat.environment.xml", "modules/tail.kinbody.xml", "modules/segment.kinbody.xml",
                           "modules/head.kinbody.xml"}) {
    EXPECT_EQ(read_file(file("five") / name), read_file(source_path("/sim/scenarios/travelling_wave/") + name)) << name;
  }
}

TEST_F(NewRobot, TheShippedRobotsAreWhatTheKindsWrite) {
  const std::pair<const char*, const char*> kinds[] = {
      {"cubo", "cubo"}, {"cube-chain", "cube_chain"}, {"y1", "y1"}, {"snake", "snake"}};
  for (const auto& [kind, folder] : kinds) {
    const Finished finished = proleg({"new", "robot", "--kind", kind, "--out", file(kind).string()});
    ASSERT_EQ(finished.status, 0) << finished.err;
    const fs::path shipped = source_path(std::string("/sim/scenarios/robots/") + folder);
    std::size_t files = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(shipped)) {
      if (entry.is_regular_file()) {
        ++files;
        EXPECT_EQ(read_file(file(kind) / fs::relative(entry.path(), shipped)), read_file(entry.path())) << entry.path();
      }
    }
    EXPECT_GE(files, 7U) << kind;
  }
}

TEST_F(NewRobot, AKindHasAsManyJointsAsItIsAskedFor) {
  const std::string out = file("chain").string();
  ASSERT_EQ(proleg({"new", "robot", "--kind", "cube-chain", "--joints", "11", "--out", out}).status, 0);
  const Json result = run("chain", "1");
  EXPECT_TRUE(result["displacement_m"].is_number());
  EXPECT_NE(read_file(file("chain/robot.robot.xml")).find("A chain of 11 joints"), std::string::npos);
}

TEST_F(NewRobot, AnUnknownKindIsRefusedWithTheKnownOnes) {
  const Finished finished = proleg({"new", "robot", "--kind", "spider", "--out", file("spider").string()});
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("--kind: found 'spider', expected one of caterpillar, cubo, cube-chain, y1, snake"),
            std::string::npos)
      << finished.err;
  EXPECT_EQ(proleg({"new", "robot", "--out", file("none").string()}).status, 2) << "neither kind nor joints";
}

TEST_F(NewRobot, EightJointsOfPitchAndYawMoveSideways) {
  write("eight", "8", "py");
  const Json measures = run("eight", "30")["measures"];
  const double distance = measures["distance"].number();
  const double forward = measures["speed"].number() * 30.0;
  const double sideways = std::sqrt(distance * distance - forward * forward);
  EXPECT_GT(sideways, 3.0);
  EXPECT_LT(std::abs(forward), sideways / 3.0);
}

TEST_F(NewRobot, TheCommentOnTheGaitIsTrueForTheAxes) {
  const auto comment = [&](const std::string& joints, const std::string& axes) {
    write(axes + joints, joints, axes);
    return read_file(file(axes + joints + "/robot.actuation.xml"));
  };
  const std::string alternating = comment("8", "py");
  EXPECT_NE(alternating.find("joints of this robot alternate between pitch and yaw"), std::string::npos);
  EXPECT_NE(alternating.find("(sidewinding)"), std::string::npos);
  for (const char* axes : {"ppy", "yyp"}) {
    const std::string other = comment("9", axes);
    EXPECT_NE(other.find("Those of this robot do not\n     alternate, so it may move in any direction"),
              std::string::npos)
        << other;
    // A robot with these axes moves along its body.
    EXPECT_GT(std::abs(std::cos(run(std::string(axes) + "9", "20")["measures"]["heading"].number() * 0.0174533)), 0.7);
  }
  EXPECT_EQ(comment("5", "p").find("sidewinding"), std::string::npos);
  EXPECT_EQ(comment("5", "y").find("sidewinding"), std::string::npos);
}

TEST_F(NewRobot, EveryNumberOfJointsAndOrderOfAxesRuns) {
  for (const char* axes : {"p", "y", "py", "yyp"}) {
    for (const char* joints : {"3", "7", "64"}) {
      const std::string name = std::string(axes) + joints;
      write(name, joints, axes);
      EXPECT_TRUE(run(name, "0.2")["displacement_m"].is_number()) << name;
    }
  }
  write("one", "1", "y");
  EXPECT_TRUE(run("one", "0.2")["displacement_m"].is_number());
}

TEST_F(NewRobot, TheModulesOfAPitchYawRobotRepeatItsGait) {
  write("four", "4", "py");
  EXPECT_EQ(run("four", "2", "hil")["differences"], 0);
}

TEST_F(NewRobot, LettersAreRepeatedFromTheTail) {
  write("tail", "5", "pyy");
  const std::string actuation = read_file(file("tail/robot.actuation.xml"));
  const std::size_t pitch = actuation.find("joints=\"10010\"");
  const std::size_t yaw = actuation.find("joints=\"01101\"");
  EXPECT_NE(pitch, std::string::npos) << actuation;
  EXPECT_NE(yaw, std::string::npos) << actuation;

  std::istringstream robot(read_file(file("tail/robot.robot.xml")));
  std::string axes;
  for (std::string line; std::getline(robot, line);) {
    if (line.find("<axis>") != std::string::npos) {
      axes += line.find("<axis>1 0 0</axis>") != std::string::npos ? 'p' : 'y';
    }
  }
  EXPECT_EQ(axes, "pyypy") << "J1, at the tail, is the first joint of the file";
}

TEST_F(NewRobot, AChangeThatIsProbablyNotMeantIsReportedByAllThatRunIt) {
  write("robot", "5", "p");
  const fs::path path = file("robot/robot.robot.xml");
  std::string text = read_file(path);
  const std::string line = "      <offsetfrom>2Seg</offsetfrom>\n";
  ASSERT_NE(text.find(line), std::string::npos);
  text.erase(text.find(line), line.size());
  std::ofstream(path) << text;

  const std::string top = file("robot/robot.simulation.xml").string();
  const std::string experiment = source_path("/sim/scenarios/travelling_wave/cma_es.optimise.xml");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"simulate", top, "--seconds", "0.1"},
                                                {"hil", top, "--seconds", "0.1"},
                                                {"optimise", experiment, "--simulation", top, "--workers", "1",
                                                 "--evaluations", "2", "--out", file("out").string()}}) {
    const Finished finished = proleg(words);
    EXPECT_EQ(finished.err.find("proleg " + words[0] + ": warning: " + path.string() + ":"), 0U) << finished.err;
    EXPECT_NE(finished.err.find("joint 'J2' is 72 mm outside of its body"), std::string::npos) << finished.err;
    EXPECT_NE(finished.out, "") << "it runs";
  }
}

TEST_F(NewRobot, LimitsThatCutTheGaitAreNamed) {
  write("robot", "5", "p");
  const fs::path path = file("robot/robot.robot.xml");
  std::string text = read_file(path);
  const std::size_t joint = text.find("<Joint name=\"J3\"");
  const std::string limits = "<limitsdeg>-90 90<";
  ASSERT_NE(text.find(limits, joint), std::string::npos);
  text.replace(text.find(limits, joint), limits.size(), "<limitsdeg>-30 30<");
  std::ofstream(path) << text;
  for (const char* subcommand : {"simulate", "hil"}) {
    // A sine of 40 degrees is beyond 30 for 46 % of its period.
    const Finished finished = proleg({subcommand, file("robot/robot.simulation.xml").string(), "--seconds", "4"});
    EXPECT_EQ(finished.status, 0);
    EXPECT_EQ(finished.err, std::string("proleg ") + subcommand +
                                ": warning: the limits of J3, -30 to 30 degrees, clip its set-points in 46 % of the "
                                "ticks\n");
  }
}

TEST_F(NewRobot, DoesNotReplaceAFile) {
  fs::create_directories(file("mine/modules"));
  const std::string precious = file("mine/modules/head.kinbody.xml").string();
  std::ofstream(precious) << "precious\n";
  expect_refused({"new", "robot", "--joints", "5", "--out", file("mine").string()}, {precious, "--out"});
  EXPECT_EQ(read_file(precious), "precious\n");
  EXPECT_FALSE(fs::exists(file("mine/robot.simulation.xml"))) << "nothing was written";
}

TEST_F(NewRobot, RefusesBadInputAndWritesNothing) {
  const std::string out = file("robot").string();
  for (const char* joints : {"0", "65", "-1", "5.0", "five", ""}) {
    expect_refused({"new", "robot", "--joints", joints, "--out", out}, {"--joints", "1 to 64"});
  }
  for (const char* axes : {"", "r", "pyP", "p y"}) {
    expect_refused({"new", "robot", "--joints", "5", "--axes", axes, "--out", out}, {"--axes", "p (pitch)"});
  }
  expect_refused({"new", "robot", "--joints", "2", "--axes", "ppy", "--out", out}, {"--axes", "3 letters"});
  expect_refused({"new", "robot", "--out", out}, {"--joints"});
  expect_refused({"new", "gait", "--joints", "5", "--out", out},
                 {"proleg new: found 'gait', expected 'robot', 'project', 'obstacle' or 'algorithm'"});
  expect_refused({"new", "robot", "--joints", "5", "--out", ""}, {"--out"});
  std::ofstream(file("plain")) << "a file, not a folder\n";
  expect_refused({"new", "robot", "--joints", "5", "--out", file("plain").string()}, {"plain"});
  EXPECT_EQ(left_behind(), std::vector<std::string>{"plain"});
}

class NewProject : public CommandLine {
 protected:
  void write(const std::string& name, std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"new", "project", file(name).string()});
    const Finished finished = proleg(options);
    ASSERT_EQ(finished.status, 0) << finished.err;
    EXPECT_TRUE(finished.out.ends_with("open it:  proleg ui " + file(name).string() + '\n')) << finished.out;
  }
};

TEST_F(NewProject, HasTheRobotThatNewRobotWritesAndAReadme) {
  write("mine");
  ASSERT_EQ(proleg({"new", "robot", "--joints", "5", "--out", file("robot").string()}).status, 0);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(file("robot"))) {
    if (entry.is_regular_file()) {
      const fs::path copy = file("mine") / entry.path().lexically_relative(file("robot"));
      EXPECT_EQ(read_file(copy), read_file(entry.path())) << copy;
    }
  }
  EXPECT_TRUE(read_file(file("mine/README.md")).starts_with("# mine\n"));
}

TEST_F(NewProject, TheCommandsOfItsReadmeRun) {
  write("mine");
  std::istringstream readme(read_file(file("mine/README.md")));
  std::size_t commands = 0;
  for (std::string line; std::getline(readme, line);) {
    if (!line.starts_with("    proleg ") || line.starts_with("    proleg ui")) {  // that one opens a page
      continue;
    }
    std::string command = line.substr(0, line.find('#'));
    command += command.find("optimise") != std::string::npos ? " --evaluations 8" : "";
    command += command.find("hil") != std::string::npos ? " --seconds 0.5" : "";
    const std::string folder = fs::path(PROLEG_PROGRAM).parent_path().string();
    const std::string script =
        "cd '" + file("mine").string() + "' && PATH='" + folder + "':$PATH && " + command.substr(4);
    const Finished finished = finish(start({"sh", "-c", script}));
    EXPECT_EQ(finished.status, 0) << command << finished.err;
    ++commands;
  }
  EXPECT_GE(commands, 4U);
  for (const char* name : {"run.proleg", "run.svg", "found/best.simulation.xml"}) {
    EXPECT_TRUE(fs::exists(file("mine") / name)) << name;
  }
}

TEST_F(NewProject, ItsSearchFitsEachKindOfRobot) {
  fs::create_directory(file("snake"));  // an empty folder is as good as none
  write("snake", {"--kind", "snake"});
  write("long", {"--joints", "7"});
  for (const char* name : {"snake", "long"}) {
    const Finished finished = proleg({"optimise", (file(name) / "search.optimise.xml").string(), "--evaluations", "2",
                                      "--out", (file(name) / "found").string()});
    EXPECT_EQ(finished.status, 0) << name << finished.err;
  }
}

TEST_F(NewProject, RefusesAFolderThatHasFiles) {
  fs::create_directory(file("full"));
  std::ofstream(file("full/mine")) << "precious\n";
  std::ofstream(file("plain")) << "a file\n";
  for (const auto& [name, found] :
       {std::pair("full", "found a folder with files"), std::pair("plain", "found a file")}) {
    expect_refused({"new", "project", file(name).string()}, {found, "expected a new or an empty folder"});
  }
  expect_refused({"new", "project", file("none").string(), "--kind", "elephant"}, {"--kind", "'elephant'"});
  EXPECT_FALSE(fs::exists(file("none")));
  expect_refused({"new", "project"}, {"FOLDER"});
}

class NewObstacle : public CommandLine {};

TEST_F(NewObstacle, IsTheShippedOneWithoutOptions) {
  const Finished finished = proleg({"new", "obstacle", "--out", file("mine").string()});
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(read_file(file("mine/obstacle.environment.xml")),
            read_file(source_path("/sim/scenarios/adaptive_touch/obstacle.environment.xml")));
}

// A cosine of length L and height H: the top in the middle of each hill, the floor between them.
TEST_F(NewObstacle, HasTheHeightsOfItsHillsWhereTheyAre) {
  ASSERT_EQ(proleg({"new", "obstacle", "--heights", "30,-20", "--length", "200", "--start", "500", "--segments", "4",
                    "--out", file("mine").string()})
                .status,
            0);
  sim::DiskFiles files;
  fs::create_directories(file("mine"));
  std::ofstream(file("mine/a.simulation.xml"))
      << "<simulation><robot>" << source_path("/sim/scenarios/travelling_wave/caterpillar.robot.xml")
      << "</robot><actuation>" << source_path("/sim/scenarios/travelling_wave/uniform.actuation.xml")
      << "</actuation><environment>obstacle.environment.xml</environment></simulation>";
  const sim::Scenario scenario = sim::read_scenario(file("mine/a.simulation.xml"), files);
  std::vector<sim::Point> surface;  // the upper corners of the pieces
  for (const sim::StaticObject& object : scenario.environment.objects) {
    if (object.name == "obstacle") {
      for (const sim::Geometry& piece : object.geometries) {
        const Eigen::Vector3d end =
            object.pose * piece.pose * Eigen::Vector3d(0.0, piece.extents.y(), piece.extents.z());
        surface.push_back({end.y(), end.z()});
      }
    }
  }
  const std::vector<sim::Point> expected{{0.55, 0.015}, {0.6, 0.03},  {0.65, 0.015}, {0.7, 0.0},
                                         {0.75, -0.01}, {0.8, -0.02}, {0.85, -0.01}, {0.9, 0.0}};
  ASSERT_EQ(surface.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(surface[i].x, expected[i].x, 2e-6) << i;
    EXPECT_NEAR(surface[i].y, expected[i].y, 2e-6) << i;
  }
}

TEST_F(NewObstacle, RefusesBadInputAndWritesNothing) {
  const std::string out = file("mine").string();
  for (const char* heights : {"", "30,", "30;40", "high", "501", "nan"}) {
    expect_refused({"new", "obstacle", "--heights", heights, "--out", out}, {"--heights", "-500 to 500"});
  }
  expect_refused({"new", "obstacle", "--length", "0", "--out", out}, {"--length", "20 to 5000"});
  expect_refused({"new", "obstacle", "--start", "-1", "--out", out}, {"--start"});
  expect_refused({"new", "obstacle", "--width", "1", "--out", out}, {"--width"});
  expect_refused({"new", "obstacle", "--segments", "1", "--out", out}, {"--segments", "2 to 100"});
  expect_refused({"new", "obstacle", "--friction", "-0.1", "--out", out}, {"--friction"});
  expect_refused({"new", "obstacle", "--floor-friction", "x", "--out", out}, {"--floor-friction"});
  expect_refused({"new", "obstacle", "--out", ""}, {"--out"});
  EXPECT_TRUE(left_behind().empty());
}

}  // namespace
}  // namespace proleg::test
