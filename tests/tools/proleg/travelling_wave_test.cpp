// Experiment 6.1 of the thesis as it is shipped: thirty repetitions of each method, 30 s a candidate, as the thesis
// made it, and in a short form. The reduced engine searches, and ODE judges the best. The whole experiment takes about
// forty minutes on two cores.

#include <algorithm>

#include "command_line.hpp"
#include "json_result.hpp"
#include "tests/support/files.hpp"

namespace proleg::test {
namespace {

class TravellingWaveExperiment : public CommandLine {};

Json method(const Json& experiment, const std::string& name) {
  for (const Json& each : experiment["methods"].elements()) {
    if (each["method"] == name) {
      return each;
    }
  }
  ADD_FAILURE() << "no method " << name;
  return Json("null");
}

TEST_F(TravellingWaveExperiment, GainsWhatTheThesisGainedAndMore) {
  const Finished finished =
      proleg({"experiment", "travelling_wave", "--engine", "reduced", "--repetitions", "30", "--json", "--out",
              file("out").string(), "--scenarios", source_path("/sim/scenarios/travelling_wave")});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Json experiment(finished.out);
  std::printf("%s%s\n", read_file(file("out/summary.txt")).c_str(), finished.out.c_str());

  // The best of thirty in the thesis: 18.7 % with the great deluge, 13.8 % with the genetic algorithm.
  const Json deluge = method(experiment, "great-deluge");
  EXPECT_GE(deluge["gain"].number(), 0.187);
  EXPECT_GE(method(experiment, "genetic")["gain"].number(), 0.138);
  const Json values = deluge["best_values"];
  for (const char* joint : {"amplitude:J5", "amplitude:J4", "amplitude:J3", "amplitude:J2"}) {
    EXPECT_LT(values["amplitude:J1"].number(), 0.5 * values[joint].number())
        << "the joint at the tail hardly moves, the others do";
  }

  // There are two summits, 2.18 m and 2.04 m in this engine.
  const std::vector<Json> runs = method(experiment, "cma-es")["runs"].elements();
  EXPECT_EQ(runs.size(), 30U);
  EXPECT_GE(std::ranges::count_if(runs, [](const Json& run) { return run["best_in_search"].number() > 2.08; }), 28)
      << "CMA-ES with restarts finds the upper one";
}

TEST_F(TravellingWaveExperiment, ShortFormMakesTheTablesAndFindsBetterGaitsThanTheUniformOne) {
  const Finished finished =
      proleg({"experiment", "travelling_wave", "--engine", "reduced", "--repetitions", "1", "--evaluations", "1500",
              "--json", "--out", file("out").string(), "--scenarios", source_path("/sim/scenarios/travelling_wave")});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Json experiment(finished.out);
  std::printf("%s%s\n", read_file(file("out/summary.txt")).c_str(), finished.out.c_str());

  for (const char* name : {"great-deluge", "genetic", "cma-es"}) {
    EXPECT_GE(method(experiment, name)["gain"].number(), 0.138)
        << name << ": the thesis's genetic algorithm gained 13.8 %";
  }
}

}  // namespace
}  // namespace proleg::test
