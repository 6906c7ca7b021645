#include "sim/optimize/confirm/doubts.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "shared/computer/text/text.hpp"

namespace proleg::optimize {
namespace {

// Limits. The shipped gaits: half the step changes the distance by 1 to 14 % (most on the terrace), the other engine by
// 1 to 5 %, MuJoCo by up to 8 %; contacts give 1 to 2 % of the motors' work; the first second has 0.8 to 1.6 times the
// average speed.
constexpr double max_difference = 0.2;     // of distances
constexpr double negligible_m = 0.02;      // differences below are none
constexpr double min_median = 0.7;         // of the distances in other worlds, share of the distance
constexpr double max_energy_gains = 0.05;  // share of the motors' work
constexpr double max_start = 3.0;          // times the average speed

std::string percent(double share) { return number_text(std::round(1000.0 * share) / 10.0) + " %"; }
std::string metres(double distance) { return number_text(std::round(1e4 * distance) / 1e4) + " m"; }

ConfirmationFinding compare(const std::string& name, const ConfirmedRun& first, const ConfirmedRun& other) {
  if (!other.failure.empty()) {
    return {name, "no result: " + other.failure, false};
  }
  const double difference = std::abs(other.distance - first.distance);
  return {name,
          metres(other.distance) + " instead of " + metres(first.distance) + ", " +
              percent(difference / std::max(first.distance, negligible_m)) + " (limit " + percent(max_difference) + ")",
          difference <= std::max(max_difference * first.distance, negligible_m)};
}

ConfirmationFinding of_other_worlds(const GaitConfirmation& confirmation) {
  const std::vector<double>& distances = confirmation.perturbed;
  const std::string name = "worlds that differ";
  if (confirmation.failed_worlds > 0 || distances.empty()) {
    return {name, std::to_string(confirmation.failed_worlds) + " without a result", false};
  }
  const auto quantile = [&](double share) {
    return distances[static_cast<std::size_t>(share * static_cast<double>(distances.size() - 1))];
  };
  const double nominal = confirmation.runs.front().distance;
  std::string text = "median " + metres(quantile(0.5)) + " (at least " + metres(min_median * nominal) +
                     "), a tenth below " + metres(quantile(0.1));
  if (quantile(0.1) < min_median * nominal) {
    text += ": it works in some of the worlds only";  // fragile, but not unreal
  }
  return {name, text, quantile(0.5) >= std::min(min_median * nominal, nominal - negligible_m)};
}

ConfirmationFinding of_energy(const ConfirmedRun& run) {
  const double share = run.energy_gains / std::max(run.energy.motors, 1e-9);
  return {"energy",
          "contacts gave " + number_text(std::round(1e3 * run.energy_gains) / 1e3) + " J, " + percent(share) +
              " of the " + number_text(std::round(1e3 * run.energy.motors) / 1e3) + " J of the motors (limit " +
              percent(max_energy_gains) + ")",
          share <= max_energy_gains};
}

ConfirmationFinding of_start(const ConfirmedRun& run) {
  const double ratio = run.first_second / std::max(run.distance * run.first_share, 1e-9);
  return {"start",
          metres(run.first_second) + " in the first " + percent(run.first_share) + " of the time, " +
              number_text(std::round(100.0 * ratio) / 100.0) + " times the average (limit " + number_text(max_start) +
              ")",
          ratio <= max_start || run.first_second <= negligible_m};
}

}  // namespace

std::vector<ConfirmationFinding> find_doubts(const GaitConfirmation& confirmation) {
  const ConfirmedRun& first = confirmation.runs.front();
  if (!first.failure.empty()) {
    return {{"as it is", "no result: " + first.failure, false}};
  }
  std::vector<ConfirmationFinding> findings;
  for (const ConfirmedRun& run : confirmation.runs) {
    if (&run == &first) {
      continue;
    }
    if (run.is_refused) {
      findings.push_back({run.name, "not compared: " + run.failure, true});
    } else {
      findings.push_back(compare(run.name, first, run));
    }
  }
  findings.push_back(of_other_worlds(confirmation));
  findings.push_back(of_energy(first));
  findings.push_back(of_start(first));
  return findings;
}

}  // namespace proleg::optimize
