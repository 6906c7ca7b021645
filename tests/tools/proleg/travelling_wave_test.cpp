// Experiment 6.1 of the thesis as it is shipped: three repetitions of each method, 30 s a candidate. Takes about an
// hour on two cores.

#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "tests/support/files.hpp"

namespace proleg::test {
namespace {

class TravellingWaveExperiment : public CommandLine {};

nlohmann::json method(const nlohmann::json& experiment, const std::string& name) {
  for (const nlohmann::json& each : experiment.at("methods")) {
    if (each.at("method") == name) {
      return each;
    }
  }
  ADD_FAILURE() << "no method " << name;
  return {};
}

double mean_evaluations(const nlohmann::json& method) {
  double sum = 0.0;
  for (const nlohmann::json& run : method.at("runs")) {
    sum += run.at("evaluations").get<double>();
  }
  return sum / static_cast<double>(method.at("runs").size());
}

TEST_F(TravellingWaveExperiment, GainsWhatTheThesisGainedAndMore) {
  const Finished finished =
      proleg({"experiment", "travelling_wave", "--repetitions", "3", "--json", "--out", file("out").string(),
              "--scenarios", source_path("/sim/scenarios/travelling_wave")});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json experiment = nlohmann::json::parse(finished.out);
  std::printf("%s%s\n", read_file(file("out/summary.txt")).c_str(), finished.out.c_str());

  const nlohmann::json deluge = method(experiment, "great-deluge");
  EXPECT_GE(deluge.at("gain_over_uniform").get<double>(), 0.15);
  const nlohmann::json values = deluge.at("best_values");
  for (const char* joint : {"amplitude:J5", "amplitude:J4", "amplitude:J3", "amplitude:J2"}) {
    EXPECT_LT(values.at("amplitude:J1").get<double>(), 0.5 * values.at(joint).get<double>())
        << "the joint at the tail hardly moves, the others do";
  }
  EXPECT_GE(method(experiment, "genetic").at("gain_over_uniform").get<double>(), 0.08);

  // After a fifth of the great deluge's evaluations. (Not at its mean in every three repetitions: there are two
  // summits, 2.17 m and 2.04 m, and both methods end on the lower one in one of three searches.)
  EXPECT_NEAR(mean_evaluations(deluge) / 5.0, 800.0, 200.0);
  EXPECT_GE(method(experiment, "cma-es").at("mean_best_after").at("800").get<double>(),
            0.95 * deluge.at("mean_best").get<double>());
}

}  // namespace
}  // namespace proleg::test
