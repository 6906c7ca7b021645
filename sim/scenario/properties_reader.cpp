#include "sim/scenario/properties_reader.hpp"

#include <charconv>
#include <cmath>
#include <optional>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

constexpr Range durations{0.01, 86'400.0, "s"};
constexpr Range step_widths{1e-5, 0.02, "s"};
constexpr Range ticks{1.0, 100.0, "ms"};
constexpr Range probabilities{0.0, 1.0, ""};

std::uint64_t read_seed(const XmlElement& element) {
  const std::string text = element.text();
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc{} || end != text.data() + text.size()) {
    element.refuse(in_quotes(text) + " in " + element.label(), "a whole number from 0 to 18446744073709551615");
  }
  return seed;
}

Solver read_solver(const XmlElement& element) {
  const std::string text = lower_case(element.text());
  if (text == "automatic") {
    return Solver::automatic;
  }
  if (text == "direct") {
    return Solver::direct;
  }
  if (text != "iterative") {
    element.refuse(in_quotes(text) + " in " + element.label(), "'automatic', 'direct' or 'iterative'");
  }
  return Solver::iterative;
}

std::uint32_t read_tick(const XmlElement& element) {
  const double microseconds = read_quantity(element, ticks) * 1000.0;
  if (std::abs(microseconds - std::round(microseconds)) > 1e-6) {
    element.refuse(in_quotes(element.text({"unit"})) + " in " + element.label(), "a whole number of microseconds");
  }
  return static_cast<std::uint32_t>(std::round(microseconds));
}

void check_steps_in_tick(const XmlElement& place, const Scenario& scenario) {
  const double tick_s = scenario.kernel.tick_period_us * 1e-6;
  const double steps = std::round(tick_s / scenario.step_s);
  if (steps < 1.0 || std::abs(steps * scenario.step_s - tick_s) > 1e-9 * tick_s) {
    place.refuse(
        "a tick of " + number_text(tick_s * 1e3) + " ms with steps of " + number_text(scenario.step_s * 1e3) + " ms",
        "a tick that is a whole number of steps");
  }
}

/// The thesis's tags without a counterpart: a value other than `quiet` asks for something that will not happen.
void remark_unless(const XmlElement& parent, std::string_view tag, std::string_view quiet, std::string_view reason,
                   std::vector<std::string>& remarks) {
  const std::optional<XmlElement> child = parent.child(tag);
  if (child && child->text() != quiet) {
    remark_no_effect(remarks, *child, reason);
  }
}

}  // namespace

void read_simulation_properties(const XmlElement& element, Scenario& scenario) {
  element.allow({}, {"stepWidth", "duration", "tick", "seed", "solver", "contactNoise", "showViewer",
                     "parallelComputing", "storingData", "mode", "accuracy"});
  if (const auto duration = element.child("duration")) {
    scenario.duration_s = read_quantity(*duration, durations);
  }
  const std::optional<XmlElement> step = element.child("stepWidth");
  if (step) {
    scenario.step_s = read_quantity(*step, step_widths);
  }
  const std::optional<XmlElement> tick = element.child("tick");
  if (tick) {
    scenario.kernel.tick_period_us = read_tick(*tick);
  }
  check_steps_in_tick(tick ? *tick : step.value_or(element), scenario);
  if (const auto seed = element.child("seed")) {
    scenario.kernel.seed = read_seed(*seed);
  }
  if (const auto solver = element.child("solver")) {
    scenario.solver = read_solver(*solver);
  }
  if (const auto noise = element.child("contactNoise")) {
    scenario.contact_noise = read_number(*noise, probabilities);
  }

  std::vector<std::string>& remarks = scenario.remarks;
  remark_unless(element, "showViewer", "0", "a run has no viewer", remarks);
  remark_unless(element, "parallelComputing", "0", "one run uses one processor", remarks);
  remark_unless(element, "storingData", "0", "ask for a recording on the command line", remarks);
  remark_unless(element, "mode", "Single Run Simulation", "a scenario is a single run", remarks);
  if (const auto accuracy = element.child("accuracy")) {
    remark_no_effect(remarks, *accuracy,
                     "it is the sampling of the thesis's program in ms; <tick> and <stepWidth> count here");
  }
}

}  // namespace proleg::sim
