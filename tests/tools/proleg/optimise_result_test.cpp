// What `proleg optimise` says of a result must be true: a run of the written scenario repeats it.

#include "optimise_fixture.hpp"

namespace proleg::test {
namespace {

class OptimiseResult : public Optimise {
 protected:
  /// A copy of the shipped experiment for CMA-ES with texts replaced.
  void write_experiment(const std::string& name,
                        const std::vector<std::pair<std::string, std::string>>& replacements) const {
    std::string text = read_file(shipped("cma_es"));
    for (const auto& [old_text, new_text] : replacements) {
      ASSERT_NE(text.find(old_text), std::string::npos) << old_text;
      text.replace(text.find(old_text), old_text.size(), new_text);
    }
    write(name, text);
  }

  [[nodiscard]] std::vector<std::string> search(const std::string& experiment, const std::string& folder,
                                                const std::vector<std::string>& rest = {}) const {
    std::vector<std::string> all{"optimise", file(experiment).string(), "--out", file(folder).string(), "--json"};
    all.insert(all.end(), rest.begin(), rest.end());
    return all;
  }

  /// The JSON of a run of the best scenario.
  [[nodiscard]] Json best_run(const std::string& folder) const {
    return json_of(proleg({"simulate", file(folder + "/best.simulation.xml").string(), "--json"}));
  }

  /// A short run with noise: touch sensors that are wrong at times and an algorithm that starts with noise.
  void write_noisy_scenario(const std::string& name) const {
    const std::string shipped = source_path("/sim/scenarios/travelling_wave/");
    write(name, "<simulation><robot>" + shipped + "caterpillar.robot.xml</robot><actuation>" + shipped +
                    "coupled.actuation.xml</actuation><environment>" + shipped +
                    "flat.environment.xml</environment><simulationProperties><duration>0.3</duration><seed>1</seed>"
                    "</simulationProperties></simulation>");
  }

  const std::pair<std::string, std::string> short_ = {"<simulation>uniform.simulation.xml",
                                                      "<simulation>short.simulation.xml"};
  const std::pair<std::string, std::string> noisy_ = {"<simulation>uniform.simulation.xml",
                                                      "<simulation>noisy.simulation.xml"};
  const std::pair<std::string, std::string> coupled_ = {"PatternGenerator_sinusoidal",
                                                        "PatternGenerator_coupled_oscillator"};
};

TEST_F(OptimiseResult, WithNoiseTheBestScenarioHasTheScoreOfTheSearchToTheLastBit) {
  write_noisy_scenario("noisy.simulation.xml");
  for (const char* numbers : {"common", "fresh"}) {
    write_experiment("noisy.optimise.xml",
                     {noisy_,
                      coupled_,
                      {"<seed>1</seed>", std::string("<seed>1</seed><trials count=\"1\" randomNumbers=\"") + numbers +
                                             "\"/><confirmation runs=\"3\"/>"}});
    const Json object = json_of(proleg(search("noisy.optimise.xml", numbers, {"--evaluations", "30", "--seed", "3"})));
    const Json run = best_run(numbers);
    EXPECT_EQ(object["best_score"], run["displacement_m"]) << numbers;
    EXPECT_EQ(object["best_scenario_score"], run["displacement_m"]) << numbers;
    EXPECT_EQ(object["best_measures"], run["measures"]) << numbers;
  }
}

TEST_F(OptimiseResult, WithTrialsThatVaryTheWorldTheOriginalWorldIsStatedAndRated) {
  write_experiment("trials.optimise.xml",
                   {short_,
                    {"<seed>1</seed>",
                     "<seed>1</seed><trials count=\"2\"><friction>0.5</friction><mass>0.3</mass></trials>"
                     "<confirmation candidates=\"2\" runs=\"3\"/>"}});
  const Json object = json_of(proleg(search("trials.optimise.xml", "out", {"--evaluations", "12"})));
  const Json run = best_run("out");
  EXPECT_EQ(object["best_scenario_score"], run["displacement_m"]);
  EXPECT_NE(object["best_score"].number(), run["displacement_m"].number()) << "the mean of other worlds";
}

TEST_F(OptimiseResult, LimitsThatCutTheBestGaitAreAWarning) {
  std::string robot = read_file(source_path("/sim/scenarios/travelling_wave/caterpillar.robot.xml"));
  for (std::size_t at = 0; (at = robot.find("<limitsdeg>", at)) != std::string::npos;) {
    at += std::string("<limitsdeg>").size();
    robot.replace(at, robot.find('<', at) - at, "-20 20");
  }
  ASSERT_NE(robot.find("-20 20"), std::string::npos);
  const std::string shipped = source_path("/sim/scenarios/travelling_wave/");
  fs::copy(shipped + "modules", file("modules"), fs::copy_options::recursive);
  write("caterpillar.robot.xml", robot);
  write("limits.simulation.xml",
        "<simulation><robot>caterpillar.robot.xml</robot><actuation>" + shipped +
            "uniform.actuation.xml</actuation><environment>" + shipped +
            "flat.environment.xml</environment><simulationProperties><duration>1</duration></simulationProperties>"
            "</simulation>");
  write_experiment("limits.optimise.xml",
                   {{"<simulation>uniform", "<simulation>limits"}, {"<lowerBounds>0<", "<lowerBounds>39<"}});
  const Finished finished = proleg(search("limits.optimise.xml", "out", {"--evaluations", "4"}));
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.err.find("clip its set-points"), std::string::npos) << finished.err;
}

TEST_F(OptimiseResult, TheTimeOfFreshRunsIsStated) {
  write_noisy_scenario("noisy.simulation.xml");
  write_experiment("noisy.optimise.xml", {noisy_, coupled_});
  const Finished finished =
      proleg({"optimise", file("noisy.optimise.xml").string(), "--out", file("out").string(), "--evaluations", "12"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("time of fresh runs"), std::string::npos) << finished.out;
}

TEST_F(OptimiseResult, ANoisyWinnerIsTheBestInFreshRunsForAnyNumberOfWorkersAndAfterResuming) {
  write_noisy_scenario("noisy.simulation.xml");
  write_experiment("noisy.optimise.xml", {noisy_, coupled_});
  std::vector<Json> results;
  for (const char* workers : {"1", "2", "3"}) {
    results.push_back(
        json_of(proleg(search("noisy.optimise.xml", workers, {"--evaluations", "40", "--workers", workers}))));
  }
  results.push_back(json_of(proleg({"optimise", file("noisy.optimise.xml").string(), "--resume", file("1").string(),
                                    "--evaluations", "40", "--json"})));
  EXPECT_EQ(results[3]["simulated"], 0);
  for (const Json& result : results) {
    EXPECT_EQ(result["confirmations"], results[0]["confirmations"]);
    EXPECT_EQ(result["best_values"], results[0]["best_values"]);
  }
  const std::vector<Json> confirmations = results[0]["confirmations"].elements();
  ASSERT_GE(confirmations.size(), 5U);
  for (const Json& confirmation : confirmations) {
    EXPECT_LE(confirmation["mean"].number(), confirmations[0]["mean"].number());
    EXPECT_EQ(confirmation["runs"], 10);
  }
  EXPECT_EQ(results[0]["best_number"], confirmations[0]["number"].number());
  EXPECT_EQ(results[0]["confirmed_mean"], confirmations[0]["mean"].number());
  EXPECT_EQ(select("1", "SELECT count(*) FROM trial WHERE trial > 0"),
            std::to_string(10 * confirmations.size()) + "|\n");
  EXPECT_TRUE(fs::is_regular_file(file("1/confirmation.tsv")));
}

TEST_F(OptimiseResult, WithoutRandomNumbersNothingIsConfirmed) {
  write_experiment("plain.optimise.xml", {short_});
  const Json object = json_of(proleg(search("plain.optimise.xml", "out", {"--evaluations", "12"})));
  EXPECT_TRUE(object["confirmations"].empty());
  EXPECT_TRUE(object["confirmed_mean"].is_null());
  EXPECT_EQ(object["best_scenario_score"], object["best_score"].number());
}

TEST_F(OptimiseResult, TheScenariosOwnValuesAreTheBaseline) {
  write_experiment("plain.optimise.xml", {short_});
  const Json own = json_of(proleg({"simulate", file("short.simulation.xml").string(), "--json"}));
  const Json object = json_of(proleg(search("plain.optimise.xml", "out", {"--evaluations", "30"})));
  const Json baseline = object["baseline"];
  EXPECT_EQ(baseline["score"], own["displacement_m"].number());
  EXPECT_EQ(baseline["values"]["amplitude:J3"], 40);
  EXPECT_TRUE(baseline["moved"].empty());
  EXPECT_NEAR(object["gain_percent"].number(),
              100.0 * (object["best_score"].number() / baseline["score"].number() - 1.0), 1e-9);
  EXPECT_EQ(select("out", "SELECT \"amplitude:J1\" || ' ' || \"amplitude:J5\" FROM evaluation WHERE number = 0"),
            "40.0 40.0|\n");
  EXPECT_NE(read_file(file("out/learning_curve.svg")).find("baseline"), std::string::npos);
  EXPECT_NE(read_file(file("out/best.tsv")).find("\nbaseline\t0\t0\t40\t"), std::string::npos);
}

TEST_F(OptimiseResult, ABaselineOutsideTheSearchSpaceIsMovedAndSaysSo) {
  write_experiment("narrow.optimise.xml", {short_, {"<upperBounds>40", "<upperBounds>30"}});
  const Json object = json_of(proleg(search("narrow.optimise.xml", "out", {"--evaluations", "8"})));
  ASSERT_EQ(object["baseline"]["moved"].size(), 5U);
  EXPECT_EQ(object["baseline"]["moved"][0]["scenario"], "40");
  EXPECT_EQ(object["baseline"]["moved"][0]["baseline"], "30");
  std::vector<std::string> words = search("narrow.optimise.xml", "text", {"--evaluations", "8"});
  words.erase(std::ranges::find(words, "--json"));
  const std::string text = proleg(words).out;
  EXPECT_NE(text.find("baseline "), std::string::npos) << text;
  EXPECT_NE(text.find("the scenario's 40 deg is not in the search space; the baseline has 30"), std::string::npos)
      << text;
}

TEST_F(OptimiseResult, AnOptimumAtABoundIsReported) {
  // Two values for each joint: 10 and 10.25 degrees.
  write_experiment("bound.optimise.xml",
                   {short_, {"<lowerBounds>0", "<lowerBounds>10"}, {"<upperBounds>40", "<upperBounds>10.25"}});
  std::vector<std::string> words = search("bound.optimise.xml", "text", {"--evaluations", "40"});
  const Json object = json_of(proleg(words));
  EXPECT_EQ(object["better_than_baseline"], Json("true"));
  ASSERT_EQ(object["at_bounds"].size(), 5U) << "every value is at one of the two bounds";
  for (const Json& bound : object["at_bounds"].elements()) {
    EXPECT_EQ(bound["bound"], bound["value"].number() == 10.25 ? "highest" : "lowest");
  }
  words = search("bound.optimise.xml", "out", {"--evaluations", "40"});
  words.erase(std::ranges::find(words, "--json"));
  EXPECT_NE(proleg(words).out.find("value of its range: a wider range may give more"), std::string::npos);
}

TEST_F(OptimiseResult, WithoutABetterCandidateTheResultSaysSoAndNamesNoBounds) {
  // The only evaluation is the scenario's own candidate, whose amplitudes are the highest of the search space.
  write_experiment("plain.optimise.xml", {short_});
  const Json object = json_of(proleg(search("plain.optimise.xml", "json", {"--evaluations", "1"})));
  EXPECT_EQ(object["best_score"], object["baseline"]["score"].number());
  EXPECT_EQ(object["better_than_baseline"], Json("false"));
  EXPECT_TRUE(object["at_bounds"].empty());
  std::vector<std::string> words = search("plain.optimise.xml", "text", {"--evaluations", "1"});
  words.erase(std::ranges::find(words, "--json"));
  const std::string text = proleg(words).out;
  EXPECT_NE(text.find("no candidate was better than the scenario's own"), std::string::npos) << text;
  EXPECT_EQ(text.find("at a bound"), std::string::npos) << text;
}

TEST_F(OptimiseResult, AWinnerThatTheServosCannotFollowCausesAWarning) {
  const std::string shipped = source_path("/sim/scenarios/travelling_wave/");
  for (const bool fast : {false, true}) {
    std::string actuation = read_file(shipped + "uniform.actuation.xml");
    const std::string frequency = "name=\"frequency\" value=\"1\"";
    ASSERT_NE(actuation.find(frequency), std::string::npos);
    if (fast) {  // 40 degrees at 3 Hz need 13 rad/s, the servos have 4.5
      actuation.replace(actuation.find(frequency), frequency.size(), "name=\"frequency\" value=\"3\"");
    }
    write("speed.actuation.xml", actuation);
    write("speed.simulation.xml", "<simulation><robot>" + shipped +
                                      "caterpillar.robot.xml</robot><actuation>speed.actuation.xml</actuation>"
                                      "<environment>" +
                                      shipped +
                                      "flat.environment.xml</environment><simulationProperties><duration>2.5</duration>"
                                      "</simulationProperties></simulation>");
    write_experiment("speed.optimise.xml",
                     {{"<simulation>uniform", "<simulation>speed"}, {"<lowerBounds>0<", "<lowerBounds>39<"}});
    const Finished finished = proleg(search("speed.optimise.xml", fast ? "fast" : "slow", {"--evaluations", "5"}));
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_EQ(finished.err.find("the servos cannot follow this gait: J") != std::string::npos, fast) << finished.err;
  }
}

TEST_F(OptimiseResult, WithoutOneScoreTheSearchFailsAndNamesTheFirstFailure) {
  const std::string shipped = source_path("/sim/scenarios/travelling_wave/");
  std::string environment = read_file(shipped + "flat.environment.xml");
  const std::size_t gravity = environment.find("<gravity>");
  ASSERT_NE(gravity, std::string::npos);
  environment.replace(gravity, environment.find("</gravity>") - gravity, "<gravity>900 0 -1");
  write("steep.environment.xml", environment);
  write("steep.simulation.xml",
        "<simulation><robot>" + shipped + "caterpillar.robot.xml</robot><actuation>" + shipped +
            "uniform.actuation.xml</actuation><environment>steep.environment.xml</environment><simulationProperties>"
            "<duration>2</duration></simulationProperties></simulation>");
  write_experiment("steep.optimise.xml", {{"<simulation>uniform", "<simulation>steep"}});
  const Finished finished = proleg(search("steep.optimise.xml", "out", {"--evaluations", "5"}));
  EXPECT_EQ(finished.status, 1);
  const Json object(finished.out);
  EXPECT_EQ(object["failed"], 5);
  EXPECT_TRUE(object["best_score"].is_null());
  EXPECT_NE(finished.err.find("none of 5 evaluations has a score"), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find("the first failure: "), std::string::npos) << finished.err;
  EXPECT_FALSE(fs::exists(file("out/best.simulation.xml")));
  EXPECT_TRUE(fs::exists(file("out/evaluations.tsv"))) << "the failures can be looked at";
}

TEST_F(OptimiseResult, AMeasureThatNoRunDefinesIsAFailure) {
  // A fifth of a second has no stride.
  write_experiment("stride.optimise.xml", {short_, {"measure=\"distance\"", "measure=\"stride_length\""}});
  const Finished finished = proleg(search("stride.optimise.xml", "out", {"--evaluations", "5"}));
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("none of 5 evaluations has a score"), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find("the run does not define stride_length"), std::string::npos) << finished.err;
  EXPECT_FALSE(fs::exists(file("out/best.simulation.xml")));
}

TEST_F(OptimiseResult, FailedEvaluationsAreCounted) {
  write_experiment("plain.optimise.xml", {short_});
  EXPECT_EQ(json_of(proleg(search("plain.optimise.xml", "out", {"--evaluations", "5"})))["failed"], 0);
}

}  // namespace
}  // namespace proleg::test
