// Experiment 6.2 of the thesis, with fewer repetitions than the thesis made: the reduced engine searches, ODE judges
// the best and runs them in other worlds. Takes about forty minutes on two cores; the short form takes a few.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "command_line.hpp"
#include "json_result.hpp"
#include "tests/support/files.hpp"

namespace proleg::test {
namespace {

class AdaptiveTouchExperiment : public CommandLine {
 protected:
  void expect_tables_and_figures() const {
    for (const char* made : {"table_6_7.tsv", "table_6_9.tsv", "figure_6_8.svg", "figure_6_10.svg", "figure_6_11.svg",
                             "figure_6_12.svg", "figure_6_13.svg", "figure_7_2.svg", "figure_7_3.svg"}) {
      EXPECT_TRUE(fs::exists(file("out") / made)) << made;
    }
  }
};

Json named(const Json& list, const char* key, const std::string& name) {
  for (const Json& each : list.elements()) {
    if (each[key] == name) {
      return each;
    }
  }
  ADD_FAILURE() << "nothing with the name " << name;
  return Json("null");
}

TEST_F(AdaptiveTouchExperiment, CrossesTheObstacleWithEveryMethod) {
  const Finished finished = proleg({"experiment", "adaptive_touch", "--repetitions", "1", "--json", "--out",
                                    file("out").string(), "--scenarios", source_path("/sim/scenarios/adaptive_touch")});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Json experiment(finished.out);
  std::printf("%s%s\n", read_file(file("out/summary.txt")).c_str(), finished.out.c_str());

  const double plain = experiment["references"]["no reflex"].number();
  EXPECT_GE(plain, 0.6) << "it reaches the top of the first hill";
  EXPECT_LE(plain, 1.5) << "and stays on the obstacle";
  EXPECT_GE(experiment["references"]["set by hand"].number(), 2.3) << "the obstacle ends at 1.96 m";
  const Json methods = experiment["methods"];
  const Json deluge = named(methods, "method", "great-deluge");
  EXPECT_GE(deluge["best_score"].number(), 3.5);
  EXPECT_GE(named(methods, "method", "great-deluge-bounded")["best_score"].number(), 3.5);
  EXPECT_GE(named(methods, "method", "genetic")["best_score"].number(), 3.0);
  EXPECT_GE(named(methods, "method", "cma-es")["mean_best"].number(),
            0.95 * named(methods, "method", "great-deluge-bounded")["mean_best"].number())
      << "with a third of the evaluations, in the same space; one search each says no more";

  const Json gaits = experiment["gaits"];
  const double level = named(gaits, "name", "no reflex")["level_m"].number();
  for (const auto& [method, least] : {std::pair{"great-deluge", 3.5}, std::pair{"great-deluge-bounded", 3.5},
                                      std::pair{"genetic", 3.0}, std::pair{"cma-es", 3.5}}) {
    const Json kept = named(gaits, "name", method + std::string(", level kept"));
    EXPECT_GE(kept["distance_m"].number(), least) << method;
    EXPECT_NEAR(kept["level_m"].number(), level, 0.15 * level) << method;
    const std::vector<Json> worlds = named(gaits, "name", method)["worlds_m"].elements();
    EXPECT_EQ(worlds.size(), 20U);
    const auto crossed = std::ranges::count_if(worlds, [](const Json& world) { return world.number() > 2.0; });
    EXPECT_GE(crossed, 15) << method << ": nothing asks the search for a gait that does not depend on its world";
  }
  expect_tables_and_figures();
}

TEST_F(AdaptiveTouchExperiment, ShortFormMakesTheTablesAndCrossesTheObstacle) {
  const Finished finished =
      proleg({"experiment", "adaptive_touch", "--repetitions", "1", "--evaluations", "60", "--json", "--out",
              file("out").string(), "--scenarios", source_path("/sim/scenarios/adaptive_touch")});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Json experiment(finished.out);
  std::printf("%s%s\n", read_file(file("out/summary.txt")).c_str(), finished.out.c_str());

  // 60 evaluations are too few for the genetic algorithm to cross.
  for (const char* name : {"great-deluge", "great-deluge-bounded", "cma-es"}) {
    EXPECT_GE(named(experiment["methods"], "method", name)["best_score"].number(), 2.3)
        << name << ": the obstacle ends at 1.96 m";
  }
  EXPECT_GE(named(experiment["methods"], "method", "genetic")["best_score"].number(),
            experiment["references"]["no reflex"].number());
  expect_tables_and_figures();
}

}  // namespace
}  // namespace proleg::test
