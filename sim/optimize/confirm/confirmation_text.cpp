#include <algorithm>
#include <cstdio>
#include <string>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/confirm/gait_confirmation.hpp"
#include "sim/scenario/overrides.hpp"

namespace proleg::optimize {
namespace {

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string right(double value, int decimals, std::size_t width) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return std::string(width > std::string(text).size() ? width - std::string(text).size() : 0, ' ') + text;
}

std::string line_of(const ConfirmedRun& run) {
  std::string line = "  " + padded(run.name, 32) + padded(std::string(sim::name_of(run.engine)), 9) +
                     padded(number_text(run.step_s * 1e3) + " ms", 10);
  if (!run.failure.empty()) {
    return line + (run.is_refused ? "-" : run.failure) + "\n";
  }
  return line + right(run.distance, 4, 8) + right(run.energy.motors, 3, 10) + right(run.energy.friction, 3, 10) +
         right(run.energy.stored, 3, 9) + right(run.energy_gains, 3, 9) +
         right(run.energy_gains - run.energy.unexplained, 3, 9) + "\n";
}

}  // namespace

std::string confirmation_text(const GaitConfirmation& confirmation) {
  std::string text =
      "run                               engine   step      distance    motors  friction   stored    gained     lost\n"
      "                                                            m         J         J        J         J        J\n";
  for (const ConfirmedRun& run : confirmation.runs) {
    text += line_of(run);
  }
  text += "\n";
  for (const ConfirmationFinding& finding : confirmation.findings) {
    text += (finding.is_good ? "  ok     " : "  DOUBT  ") + padded(finding.name, 33) + finding.text + "\n";
  }
  return text + "\n" +
         (confirmation.is_real() ? "Nothing speaks against this gait.\n"
                                 : "This gait may live on an error of the physics.\n");
}

}  // namespace proleg::optimize
