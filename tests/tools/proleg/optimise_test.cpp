// `proleg optimise` and `proleg experiment` from the command line. Trials are short: these tests are about the program,
// not about gaits.

#include <csignal>
#include <map>

#include "optimise_fixture.hpp"

namespace proleg::test {
namespace {

TEST_F(Optimise, PrintsTheBestAndWritesStoreTablesFiguresAndTheBestScenario) {
  const Finished finished = proleg(words("great_deluge", "out", {"--evaluations", "12"}));
  const Json object = json_of(finished);
  EXPECT_EQ(finished.err, "");
  EXPECT_EQ(object["evaluations"], 12);
  EXPECT_EQ(object["best_values"].size(), 5U);
  EXPECT_TRUE(object["best_values"].contains("amplitude:J5"));
  EXPECT_GT(object["simulated_s_per_s"].number(), 0.0);
  for (const char* name :
       {"store.sqlite", "evaluations.tsv", "best.tsv", "learning_curve.svg", "best.simulation.xml"}) {
    EXPECT_TRUE(fs::is_regular_file(file(std::string("out/") + name))) << name;
  }
  const std::string table = read_file(file("out/evaluations.tsv"));
  EXPECT_EQ(std::ranges::count(table, '\n'), 13);
}

TEST_F(Optimise, TheBestScenarioRunsAndHasTheScoreOfTheSearch) {
  for (const std::string engine : {"ode", "reduced"}) {
    const Json search = json_of(proleg(words("cma_es", engine, {"--evaluations", "30", "--engine", engine})));
    EXPECT_EQ(search["engine"], engine);
    const Json run = json_of(proleg({"simulate", file(engine + "/best.simulation.xml").string(), "--json"}));
    EXPECT_EQ(search["best_score"], run["displacement_m"]) << "to the last bit, with " << engine;
    EXPECT_EQ(search["best_measures"], run["measures"]);
  }
}

TEST_F(Optimise, TheReducedEngineSearchesAndOdeJudgesTheBestTen) {
  const Json search = json_of(proleg(words("cma_es", "out", {"--evaluations", "60", "--engine", "reduced"})));
  EXPECT_EQ(search["judge"], "ode");
  const std::vector<Json> judged = search["confirmations"].elements();
  ASSERT_GE(judged.size(), 10U);
  EXPECT_LE(judged.size(), 11U) << "with the baseline";
  double best = 0.0;
  for (const Json& finalist : judged) {
    EXPECT_EQ(finalist["runs"], 1);
    best = std::max(best, finalist["mean"].number());
  }
  EXPECT_EQ(search["best_score"], best);
  EXPECT_EQ(search["best_number"], judged[0]["number"].number());
  EXPECT_EQ(search["best_search_scores"]["distance"], judged[0]["score"].number());
  EXPECT_NE(search["best_search_scores"]["distance"], best);

  const auto simulate = [&](const std::vector<std::string>& rest) {
    std::vector<std::string> command{"simulate", file("out/best.simulation.xml").string(), "--json"};
    command.insert(command.end(), rest.begin(), rest.end());
    return json_of(proleg(command));
  };
  EXPECT_EQ(simulate({})["displacement_m"], best) << "the best scenario has the judge's engine";
  EXPECT_EQ(simulate({"--engine", "reduced"})["displacement_m"], search["best_search_scores"]["distance"].number());
  EXPECT_NE(read_file(file("out/confirmation.tsv")).find("\tscore (reduced)\tmean (ode)\t"), std::string::npos);

  const Finished text = proleg({"optimise", shipped("cma_es"), "--simulation", file("short.simulation.xml").string(),
                                "--evaluations", "60", "--engine", "reduced", "--out", file("text").string()});
  EXPECT_NE(text.out.find("m (ode)\n  in the search"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("m (reduced)\n"), std::string::npos) << text.out;
}

TEST_F(Optimise, TrialsSimulateEachCandidateInSoManyWorlds) {
  const std::vector<std::string> rest{"--evaluations", "8", "--engine", "reduced", "--trials", "20"};
  const Json search = json_of(proleg(words("cma_es", "out", rest)));
  EXPECT_EQ(search["trials"], 20);
  EXPECT_EQ(search["simulated"], 8);
  EXPECT_EQ(select("out", "SELECT count(*), count(DISTINCT seed) FROM trial WHERE trial < 20"), "160|20|\n")
      << "all candidates meet the same worlds";
  EXPECT_EQ(
      select("out", "SELECT count(DISTINCT printf('%.17g', distance)) FROM trial WHERE number = 0 AND trial < 20"),
      "20|\n")
      << "the worlds differ, though the file has no variations";
  const Json resumed = json_of(proleg(
      words("cma_es", "",
            {"--evaluations", "10", "--engine", "reduced", "--trials", "20", "--resume", file("out").string()})));
  EXPECT_EQ(resumed["restored"], 8);
  expect_refused(words("cma_es", "", {"--engine", "reduced", "--resume", file("out").string()}),
                 {"another experiment", "trials"});
}

TEST_F(Optimise, OneWorkerTwoAndThreeGiveTheSameToTheLastBit) {
  for (const char* engine : {"ode", "reduced"}) {
    for (const char* experiment : {"great_deluge", "genetic", "cma_es"}) {
      std::map<std::string, int> outcomes;
      for (const char* workers : {"1", "2", "3"}) {
        const std::string folder = std::string(experiment) + engine + workers;
        static_cast<void>(json_of(
            proleg(words(experiment, folder, {"--evaluations", "70", "--workers", workers, "--engine", engine}))));
        ++outcomes[evaluations(folder)];
      }
      EXPECT_EQ(outcomes.size(), 1U) << experiment << engine;
      EXPECT_EQ(std::ranges::count(outcomes.begin()->first, '\n'), 70) << experiment << engine;
    }
  }
}

TEST_F(Optimise, AnotherSeedGivesAnotherSearch) {
  static_cast<void>(json_of(proleg(words("great_deluge", "a", {"--evaluations", "5"}))));
  static_cast<void>(json_of(proleg(words("great_deluge", "b", {"--evaluations", "5", "--seed", "2"}))));
  const auto tried = [&](const std::string& folder) {
    return select(folder, "SELECT group_concat(candidate, ' ') FROM evaluation");
  };
  EXPECT_NE(tried("a"), tried("b"));
}

// A search with this many evaluations is still running when this process stops it.
constexpr const char* endless = "1000000";

TEST_F(Optimise, InterruptedAndResumedGivesTheSame) {
  for (const char* experiment : {"great_deluge", "pareto", "cma_es"}) {
    static_cast<void>(json_of(proleg(words(experiment, "whole", {"--evaluations", "150"}))));
    const pid_t search = start_proleg(words(experiment, "parts", {"--evaluations", endless}));
    wait_for("parts", 20);
    kill(search, SIGINT);
    const Finished interrupted = finish(search);
    EXPECT_EQ(interrupted.status, 1) << interrupted.err;
    EXPECT_EQ(Json(interrupted.out)["ended"], "interrupted");
    EXPECT_TRUE(fs::exists(file("parts/learning_curve.svg"))) << "the results so far are written";
    const Json object =
        json_of(proleg(words(experiment, "", {"--evaluations", "150", "--resume", file("parts").string()})));
    EXPECT_GE(object["restored"].number(), 20);
    EXPECT_EQ(evaluations("whole", 150), evaluations("parts", 150)) << experiment;
    fs::remove_all(file("whole"));
    fs::remove_all(file("parts"));
  }
}

TEST_F(Optimise, IsStoppedFromElsewhere) {
  const pid_t search = start_proleg(words("great_deluge", "out", {"--evaluations", endless}));
  wait_for("out", 5);
  const Finished stop = proleg({"optimise", "--stop", file("out").string()});
  EXPECT_EQ(stop.status, 0) << stop.err;
  const Finished stopped = finish(search);
  EXPECT_EQ(stopped.status, 1) << "as Ctrl-C";
  EXPECT_NE(stopped.err.find("continue with: "), std::string::npos) << stopped.err;
  EXPECT_FALSE(fs::exists(file("out/store.sqlite.stop")));
  expect_refused({"optimise", "--stop", file("out").string()}, {"nothing to stop"});
  expect_refused({"optimise", "--stop", file("none").string()}, {"nothing to stop"});
}

TEST_F(Optimise, EstimatesItsTimeAndWritesNothing) {
  const Json object = json_of(proleg(words("cma_es", "out", {"--estimate", "--evaluations", "1000"})));
  EXPECT_EQ(object["planned"], 1000);
  EXPECT_GT(object["evaluation_s"].number(), 0.0);
  EXPECT_GE(object["seconds"].number(), 1000 * object["evaluation_s"].number());
  EXPECT_FALSE(fs::exists(file("out")));
}

TEST_F(Optimise, LeavesItsResultAsAFile) {
  const Finished finished = proleg(words("cma_es", "out", {"--evaluations", "30"}));
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(read_file(file("out/result.json")), finished.out);
}

TEST_F(Optimise, PrintsTheCommandThatContinues) {
  const pid_t search = start_proleg(words("great_deluge", "the parts", {"--evaluations", endless, "--seed", "9"}));
  wait_for("the parts", 3);
  kill(search, SIGINT);
  const std::string message = finish(search).err;
  const std::string mark = "continue with: proleg ";
  ASSERT_NE(message.find(mark), std::string::npos) << message;
  std::string command = message.substr(message.find(mark) + mark.size());
  command.replace(command.find(endless), std::string(endless).size(), "2000");
  // As a user would paste it.
  const Json object = json_of(finish(
      start({"sh", "-c", std::string(PROLEG_PROGRAM) + " " + command.substr(0, command.find('\n')) + " --json"})));
  EXPECT_GE(object["restored"].number(), 3);
  EXPECT_EQ(object["seed"], 9);
}

TEST_F(Optimise, EndsAtOnceIfItsStoreIsRenamedAndContinuesFromIt) {
  const pid_t search = start_proleg(words("great_deluge", "out", {"--evaluations", endless}));
  wait_for("out", 3);
  fs::rename(file("out/store.sqlite"), file("out/renamed"));
  const Finished ended = finish(search);
  EXPECT_EQ(ended.status, 1);
  EXPECT_NE(ended.err.find("out/store.sqlite: another program removed, renamed or replaced"), std::string::npos)
      << ended.err;
  EXPECT_NE(ended.err.find("continue with: proleg optimise"), std::string::npos) << ended.err;
  fs::rename(file("out/renamed"), file("out/store.sqlite"));
  const Json object =
      json_of(proleg(words("great_deluge", "", {"--evaluations", "40", "--resume", file("out").string()})));
  EXPECT_GE(object["restored"].number(), 3);
}

TEST_F(Optimise, AnIgnoredHangUpStopsNothing) {
  const pid_t search = start({"sh", "-c", "trap '' HUP; exec \"$0\" \"$@\"", PROLEG_PROGRAM, "optimise",
                              shipped("great_deluge"), "--simulation", file("short.simulation.xml").string(), "--out",
                              file("out").string(), "--evaluations", "400", "--json"});
  wait_for("out", 3);
  kill(search, SIGHUP);
  EXPECT_EQ(json_of(finish(search))["evaluations"], 400);
}

TEST_F(Optimise, KilledItLosesOnlyWhatItsWorkersWereSimulating) {
  static_cast<void>(json_of(proleg(words("genetic", "whole", {"--evaluations", "100"}))));
  const pid_t search = start_proleg(words("genetic", "parts", {"--evaluations", endless}));
  wait_for("parts", 31);
  kill(search, SIGKILL);
  EXPECT_EQ(finish(search).status, 128 + SIGKILL);
  const Json object =
      json_of(proleg(words("genetic", "", {"--evaluations", "100", "--resume", file("parts").string()})));
  EXPECT_GE(object["restored"].number(), 31);
  EXPECT_EQ(evaluations("whole", 100), evaluations("parts", 100));
}

TEST_F(Optimise, ALargerBudgetContinuesFromTheSameStore) {
  static_cast<void>(json_of(proleg(words("great_deluge", "out", {"--evaluations", "20"}))));
  const Json object =
      json_of(proleg(words("great_deluge", "", {"--evaluations", "40", "--resume", file("out").string()})));
  EXPECT_EQ(object["restored"], 20);
  EXPECT_EQ(object["evaluations"], 40);
}

TEST_F(Optimise, ResumesFromItsFolderAlone) {
  static_cast<void>(json_of(proleg(words("genetic", "whole", {"--evaluations", "70", "--seed", "9"}))));
  const pid_t search = start_proleg(words("genetic", "parts", {"--evaluations", "70", "--seed", "9"}));
  wait_for("parts", 5);
  kill(search, SIGKILL);
  static_cast<void>(finish(search));
  fs::remove(file("short.simulation.xml"));  // the store has all files
  const auto resumed = [&](const std::vector<std::string>& rest) {
    std::vector<std::string> command{"optimise", "--resume", file("parts").string(), "--json"};
    command.insert(command.end(), rest.begin(), rest.end());
    return json_of(proleg(command));
  };
  const Json object = resumed({});
  EXPECT_EQ(object["evaluations"], 70);
  EXPECT_EQ(object["seed"], 9);
  EXPECT_GE(object["restored"].number(), 5);
  EXPECT_EQ(evaluations("whole"), evaluations("parts"));
  EXPECT_EQ(resumed({"--evaluations", "80"})["evaluations"], 80);
  EXPECT_EQ(resumed({})["evaluations"], 80) << "the latest number";
  expect_refused({"optimise"}, {"FILE", "--resume"});
  expect_refused({"optimise", "--resume", file("nothing").string()}, {"nothing", "store.sqlite"});
  expect_refused({"optimise", "--resume", file("parts").string(), "--seed", "8"}, {"another experiment", "seed"});
  expect_refused({"optimise", "--resume", file("parts").string(), "--simulation", "x"}, {"--simulation", "FILE"});
}

TEST_F(Optimise, ResumedWithFewerEvaluationsKeepsAll) {
  static_cast<void>(json_of(proleg(words("great_deluge", "out", {"--evaluations", "40"}))));
  const Finished finished =
      proleg(words("great_deluge", "", {"--evaluations", "20", "--resume", file("out").string()}));
  EXPECT_EQ(json_of(finished)["evaluations"], 40);
  EXPECT_NE(finished.err.find("the store has 40 evaluations, more than 20"), std::string::npos) << finished.err;
  EXPECT_EQ(std::ranges::count(read_file(file("out/evaluations.tsv")), '\n'), 41);
}

TEST_F(Optimise, NeverWritesOverAFileOfItsExperiment) {
  static_cast<void>(json_of(proleg(words("cma_es", "first", {"--evaluations", "20"}))));
  std::string experiment = read_file(shipped("cma_es"));
  experiment.replace(experiment.find("uniform.simulation.xml"), 22, "best.simulation.xml");
  write("first/again.optimise.xml", experiment);
  fs::remove(file("first/store.sqlite"));
  const std::string before = read_file(file("first/best.actuation.xml"));
  const auto into = [&](const std::string& folder) {
    return std::vector<std::string>{
        "optimise", file("first/again.optimise.xml").string(), "--evaluations", "8", "--out", folder};
  };
  expect_refused(into(file("first").string()), {"best.simulation.xml", "write over", "--out"});
  fs::create_directory_symlink(file("first"), file("link"));
  expect_refused(into(file("link").string()), {"best.simulation.xml", "write over", "--out"});
  EXPECT_EQ(read_file(file("first/best.actuation.xml")), before);
  EXPECT_FALSE(fs::exists(file("first/store.sqlite")));
  EXPECT_EQ(proleg(into(file("second").string())).status, 0);
}

TEST_F(Optimise, AFreshSearchReplacesNoFileOfAnother) {
  for (const std::string name : {"best.tsv", "learning_curve.svg", "best.files"}) {
    fs::create_directory(file("out"));
    write("out/" + name, "of somebody else\n");
    expect_refused(words("great_deluge", "out", {"--evaluations", "4"}), {name + ": found an existing file", "--out"});
    EXPECT_EQ(read_file(file("out/" + name)), "of somebody else\n");
    EXPECT_FALSE(fs::exists(file("out/store.sqlite")));
    fs::remove_all(file("out"));
  }
  write("out", "a file\n");
  expect_refused(words("great_deluge", "out", {"--evaluations", "4"}),
                 {"out: found something that is not a folder, expected a folder for the results (--out)"});
  expect_refused(words("great_deluge", "out/inside", {"--evaluations", "4"}), {"something that is not a folder"});
}

TEST_F(Optimise, SeveralObjectivesGiveAParetoFront) {
  const Json object = json_of(proleg(words("pareto", "out", {"--evaluations", "80"})));
  EXPECT_EQ(object["best_scores"].size(), 2U);
  EXPECT_TRUE(fs::is_regular_file(file("out/pareto.svg")));
  EXPECT_GT(std::ranges::count(read_file(file("out/pareto.tsv")), '\n'), 1);
}

TEST_F(Optimise, RefusesBadInputAndStartsNothing) {
  const auto refuse = [&](const std::vector<std::string>& rest, const std::vector<std::string>& message) {
    expect_refused(words("great_deluge", "out", rest), message);
    EXPECT_FALSE(fs::exists(file("out"))) << message.front();
  };
  refuse({"--workers", "0"}, {"--workers", "'0'", "1 to 1024"});
  refuse({"--workers", "two"}, {"--workers", "'two'"});
  refuse({"--evaluations", "0"}, {"--evaluations", "'0'"});
  refuse({"--evaluations", "-3"}, {"--evaluations", "'-3'"});
  refuse({"--seed", "1.5"}, {"--seed", "'1.5'"});
  refuse({"--trials", "0"}, {"--trials", "'0'", "1 to 1000"});
  refuse({"--trials", "1001"}, {"--trials", "'1001'"});
  refuse({"--trials", "many"}, {"--trials", "'many'"});
  refuse({"--engine", "bullet"}, {"--engine", "'bullet'", "'ode', 'reduced' or 'mujoco'"});
  expect_refused({"optimise", "/nowhere/x.optimise.xml"}, {"/nowhere/x.optimise.xml"});
  expect_refused({"optimise", scenario("uniform")}, {"uniform.simulation.xml", "greatDeluge"});
  expect_refused(words("great_deluge", "", {"--resume", file("nothing").string()}), {"nothing", "store.sqlite"});
}

TEST_F(Optimise, RefusesAScenarioThatTheEngineDoesNotHave) {
  const fs::path folder = file("spheres");
  fs::copy(source_path("/sim/scenarios/travelling_wave"), folder, fs::copy_options::recursive);
  const std::string box =
      "<Geom type=\"box\">\n      <translation>0 0.036 0</translation>\n      <extents>0.026 0.018 0.026</extents>";
  std::string segment = read_file(folder / "modules/segment.kinbody.xml");
  segment.replace(segment.find(box), box.size(),
                  "<Geom type=\"sphere\"><translation>0 0.036 0</translation><radius>0.026</radius>");
  std::ofstream(folder / "modules/segment.kinbody.xml") << segment;
  const std::vector<std::string> refusal{"with a sphere", "reduced engine", "--engine ode"};
  expect_refused(
      {"optimise", (folder / "cma_es.optimise.xml").string(), "--engine", "reduced", "--out", file("out").string()},
      refusal);
  expect_refused({"sweep", (folder / "uniform.simulation.xml").string(), "--over", "amplitude=10:20:10", "--engine",
                  "reduced", "--out", file("out").string()},
                 refusal);
  expect_refused({"experiment", "travelling_wave", "--scenarios", folder.string(), "--engine", "reduced", "--out",
                  file("out").string()},
                 refusal);
  EXPECT_FALSE(fs::exists(file("out")));
}

TEST_F(Optimise, RejectsAStoreThatExistsOrIsOfAnotherExperiment) {
  static_cast<void>(json_of(proleg(words("great_deluge", "out", {"--evaluations", "5"}))));
  const std::string before = evaluations("out");
  expect_refused(words("great_deluge", "out", {"--evaluations", "5"}),
                 {"store.sqlite: exists already", "--resume " + file("out").string(), "--out"});
  expect_refused(words("genetic", "", {"--resume", file("out").string()}), {"store.sqlite", "another experiment"});
  expect_refused(words("great_deluge", "", {"--resume", file("out").string(), "--seed", "9"}), {"another experiment"});
  expect_refused(words("great_deluge", "", {"--resume", file("out").string(), "--engine", "reduced"}),
                 {"another experiment", "engine"});
  expect_refused(words("great_deluge", "elsewhere", {"--resume", file("out").string()}), {"--out", "--resume"});
  EXPECT_EQ(evaluations("out"), before);
}

TEST_F(Optimise, SimulatesWithClosedStandardStreams) {
  static_cast<void>(json_of(proleg(words("great_deluge", "open", {"--evaluations", "20"}))));
  std::vector<std::string> command{"sh", "-c", "exec \"$0\" \"$@\" <&- >&- 2>&-", PROLEG_PROGRAM};
  const std::vector<std::string> search = words("great_deluge", "closed", {"--evaluations", "20", "--workers", "2"});
  command.insert(command.end(), search.begin(), search.end());
  EXPECT_EQ(finish(start(command)).status, 1) << "the result went nowhere";
  EXPECT_EQ(evaluations("open"), evaluations("closed"));
}

TEST_F(Optimise, UnderMpirunGivesTheSame) {
  if (!fs::exists(fs::path(PROLEG_PROGRAM).parent_path() / "proleg-optimise-mpi")) {
    GTEST_SKIP() << "built without Open MPI";
  }
  for (const std::string engine : {"ode", "reduced"}) {
    const std::vector<std::string> rest{"--evaluations", "40", "--engine", engine};
    static_cast<void>(json_of(proleg(words("great_deluge", "local_" + engine, rest))));
    const Json object = json_of(finish(start(under_mpirun(words("great_deluge", "cluster_" + engine, rest)))));
    EXPECT_EQ(object["workers"], 4);
    EXPECT_EQ(evaluations("local_" + engine), evaluations("cluster_" + engine));
  }
}

TEST_F(Optimise, UnderMpirunReportsAnErrorOnce) {
  if (!fs::exists(fs::path(PROLEG_PROGRAM).parent_path() / "proleg-optimise-mpi")) {
    GTEST_SKIP() << "built without Open MPI";
  }
  for (const char* word : {"--evolutions", "--seed=-1"}) {
    const Finished finished = finish(start(under_mpirun(words("great_deluge", "out", {word}))));
    EXPECT_NE(finished.status, 0);
    const std::size_t first = finished.err.find("proleg optimise: ");
    ASSERT_NE(first, std::string::npos) << finished.err;
    EXPECT_EQ(finished.err.find("proleg optimise: ", first + 1), std::string::npos) << finished.err;
  }
}

/// The shipped experiment with its trials cut to a fifth of a second.
fs::path copy_short_experiment(const fs::path& folder) {
  fs::copy(source_path("/sim/scenarios/travelling_wave"), folder, fs::copy_options::recursive);
  std::string scenario = read_file(folder / "uniform.simulation.xml");
  scenario.replace(scenario.find("<duration>30<"), 13, "<duration>0.2<");
  std::ofstream(folder / "uniform.simulation.xml") << scenario;
  return folder;
}

TEST_F(Optimise, RepetitionsSideBySideGiveTheSameAlsoIfTheyAreInterrupted) {
  const fs::path folder = copy_short_experiment(file("scenarios"));
  const auto words = [&](const std::string& out, const std::string& workers, const std::string& evaluations) {
    return std::vector<std::string>{
        "experiment", "travelling_wave",  "--repetitions", "9",         "--evaluations", evaluations,   "--method",
        "cma-es",     "--engine",         "reduced",       "--workers", workers,         "--scenarios", folder.string(),
        "--out",      file(out).string(), "--json"};
  };
  const auto found = [&](const std::string& out) {
    return select(
        out + "/cma-es",
        "SELECT run, number, candidate, reused, printf('%.17g', distance) FROM evaluation ORDER BY run, number");
  };
  const Json one = json_of(proleg(words("one", "1", "60")));
  const Json two = json_of(proleg(words("two", "2", "60")));
  EXPECT_EQ(one["methods"][0]["runs"], two["methods"][0]["runs"]);
  EXPECT_EQ(one["methods"][0]["runs"].size(), 9U);
  EXPECT_EQ(found("one"), found("two"));
  EXPECT_FALSE(fs::exists(file("two/cma-es/part0"))) << "what each process found is in one store";

  for (const int signal : {SIGINT, SIGKILL}) {
    const pid_t experiment = start_proleg(words("parts", "2", endless));
    wait_for("parts/cma-es/part0", 100);
    kill(experiment, signal);
    EXPECT_NE(finish(experiment).status, 0);
  }
  const Json continued = json_of(proleg(words("parts", "2", "60")));
  EXPECT_EQ(one["methods"][0]["runs"], continued["methods"][0]["runs"]);

  static_cast<void>(json_of(proleg(words("longer", "2", "30"))));
  const Json longer = json_of(proleg(words("longer", "2", "60")));
  EXPECT_EQ(one["methods"][0]["runs"], longer["methods"][0]["runs"]) << "more evaluations than the first time";
}

TEST_F(Optimise, AnExperimentWritesTheThesissTablesAndFiguresAndContinues) {
  const fs::path folder = copy_short_experiment(file("scenarios"));
  const auto run = [&](const char* repetitions) {
    return json_of(proleg({"experiment", "travelling_wave", "--repetitions", repetitions, "--evaluations", "40",
                           "--scenarios", folder.string(), "--out", file("out").string(), "--json"}));
  };
  const Json two = run("2");
  ASSERT_EQ(two["methods"].size(), 3U);
  for (const char* name :
       {"table_6_2.tsv", "table_6_4.tsv", "figure_6_3.svg", "figure_6_4.svg", "figure_6_5.svg", "figure_6_6.svg",
        "figure_7_1.svg", "summary.txt", "great-deluge/store.sqlite", "genetic/best.simulation.xml"}) {
    EXPECT_TRUE(fs::is_regular_file(file(std::string("out/") + name))) << name;
  }
  EXPECT_NE(read_file(file("out/table_6_2.tsv")).find("1.958"), std::string::npos) << "the thesis's best stands beside";
  const Json one =
      json_of(proleg({"experiment", "travelling_wave", "--repetitions", "2", "--evaluations", "40", "--scenarios",
                      folder.string(), "--out", file("out").string(), "--json", "--method", "genetic"}));
  EXPECT_EQ(one["methods"].size(), 3U) << "those in the folder are shown, too";
  EXPECT_TRUE(one.contains("great_deluge_above_genetic_after"));
  EXPECT_TRUE(one["methods"][2].contains("reaches_mean_of_great_deluge_after"));
  const Json other =
      json_of(proleg({"experiment", "travelling_wave", "--repetitions", "2", "--evaluations", "40", "--scenarios",
                      folder.string(), "--out", file("out").string(), "--json", "--method", "xnes"}));
  ASSERT_EQ(other["methods"].size(), 4U);
  EXPECT_EQ(other["methods"][3]["method"], "xnes") << "any algorithm of pagmo searches the same space";
  EXPECT_TRUE(fs::is_regular_file(file("out/table_xnes.tsv")));
  const Json three = run("3");
  for (std::size_t method = 0; method < 3; ++method) {
    ASSERT_EQ(three["methods"][method]["runs"].size(), 3U);
    for (std::size_t repetition = 0; repetition < 2; ++repetition) {
      EXPECT_EQ(three["methods"][method]["runs"][repetition], two["methods"][method]["runs"][repetition]);
    }
  }
}

TEST_F(Optimise, AnExperimentThatIsUnknownOrHasNoFilesIsRejected) {
  expect_refused({"experiment", "travelling_wave", "--out", ""}, {"--out", "an empty name"});
  write("file", "of somebody else\n");
  expect_refused({"experiment", "travelling_wave", "--out", file("file").string()},
                 {"file: found something that is not a folder, expected a folder"});
  fs::create_directories(file("out/genetic"));
  write("out/summary.txt", "of somebody else\n");
  expect_refused({"experiment", "travelling_wave", "--out", file("out").string()},
                 {"summary.txt: found an existing file"});
  fs::rename(file("out/summary.txt"), file("out/genetic/best.tsv"));
  expect_refused({"experiment", "travelling_wave", "--out", file("out").string()},
                 {"best.tsv: found an existing file"});
  expect_refused({"experiment", "swimming"}, {"'swimming'", "travelling_wave"});
  expect_refused({"experiment", "travelling_wave", "--repetitions", "0"}, {"--repetitions", "'0'"});
  expect_refused({"experiment", "travelling_wave", "--method", "magic"}, {"--method", "'magic'", "great-deluge"});
  expect_refused({"experiment", "travelling_wave", "--scenarios", file("none").string()}, {"--scenarios"});
}

}  // namespace
}  // namespace proleg::test
