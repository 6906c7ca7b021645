// Experiment 6.1 of the thesis as it is shipped: three repetitions of each method, 30 s a candidate. Takes about an
// hour on two cores.

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

double mean_evaluations(const Json& method) {
  double sum = 0.0;
  for (const Json& run : method["runs"].elements()) {
    sum += run["evaluations"].number();
  }
  return sum / static_cast<double>(method["runs"].size());
}

TEST_F(TravellingWaveExperiment, GainsWhatTheThesisGainedAndMore) {
  const Finished finished =
      proleg({"experiment", "travelling_wave", "--repetitions", "3", "--json", "--out", file("out").string(),
              "--scenarios", source_path("/sim/scenarios/travelling_wave")});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Json experiment(finished.out);
  std::printf("%s%s\n", read_file(file("out/summary.txt")).c_str(), finished.out.c_str());

  const Json deluge = method(experiment, "great-deluge");
  EXPECT_GE(deluge["gain_over_uniform"].number(), 0.15);
  const Json values = deluge["best_values"];
  for (const char* joint : {"amplitude:J5", "amplitude:J4", "amplitude:J3", "amplitude:J2"}) {
    EXPECT_LT(values["amplitude:J1"].number(), 0.5 * values[joint].number())
        << "the joint at the tail hardly moves, the others do";
  }
  EXPECT_GE(method(experiment, "genetic")["gain_over_uniform"].number(), 0.08);

  // After a fifth of the great deluge's evaluations. (Not at its mean in every three repetitions: there are two
  // summits, 2.17 m and 2.04 m, and a search of either method may end on the lower one.)
  EXPECT_NEAR(mean_evaluations(deluge) / 5.0, 800.0, 200.0);
  EXPECT_GE(method(experiment, "cma-es")["mean_best_after"]["800"].number(), 0.95 * deluge["mean_best"].number());
}

}  // namespace
}  // namespace proleg::test
