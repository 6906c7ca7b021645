#include "sim/measure/measure.hpp"

#include <algorithm>

namespace proleg::sim {
namespace {

constexpr std::array<MeasureDeclaration, measure_count> declarations{{
    {Measure::distance, "distance", "m", true, false, "horizontal distance of the centre of mass from its start"},
    {Measure::speed, "speed", "m/s", true, true,
     "mean speed of the centre of mass along a heading; negative against it"},
    {Measure::sideways_speed, "sideways_speed", "m/s", true, true,
     "mean speed of the centre of mass to the left of where the head pointed at the start; negative to its right"},
    {Measure::heading, "heading", "deg", true, true,
     "direction from start to end, relative to where the head pointed at the start; 90 is its left"},
    {Measure::yaw_rate, "yaw_rate", "deg/s", true, true, "mean rate at which the body turns to its left"},
    {Measure::mechanical_energy, "mechanical_energy", "J", false, false, "positive work of the servos' motors"},
    {Measure::electrical_energy, "electrical_energy", "J", false, false,
     "what the servos drew of their 6 V supply; an estimate"},
    {Measure::cost_of_transport, "cost_of_transport", "m/s^2", false, false, "mechanical energy per mass and distance"},
    {Measure::electrical_cost_of_transport, "electrical_cost_of_transport", "m/s^2", false, false,
     "electrical energy per mass and distance"},
    {Measure::specific_resistance, "specific_resistance", "", false, false, "cost of transport over gravity"},
    {Measure::smoothness, "smoothness", "m/s^2", false, false,
     "root mean square acceleration of the centre of mass; the lower, the smoother"},
    {Measure::stability_margin, "stability_margin", "m", true, true,
     "how far the centre of mass is inside the outermost supports along the body, on average; negative outside"},
    {Measure::height, "height", "m", true, true, "height that the centre of mass gained"},
    {Measure::slip, "slip", "", false, false,
     "how far the contact points slide on the ground, weighted by their load, over the distance"},
    {Measure::duty_factor, "duty_factor", "", true, false,
     "share of a stride that a link is on the ground, mean of the links"},
    {Measure::froude_number, "froude_number", "", true, false, "speed squared over gravity and stride length"},
    {Measure::stride_length, "stride_length", "m", true, false, "distance in a stride"},
    {Measure::stride_frequency, "stride_frequency", "Hz", true, false, "strides in a second"},
    {Measure::tracking_error, "tracking_error", "deg", false, false,
     "root mean square difference between the set-points of the gait and the angles of the joints"},
    {Measure::max_tracking_error, "max_tracking_error", "deg", false, false, "the largest such difference"},
    {Measure::at_speed_limit, "at_speed_limit", "", false, false,
     "share of the time in which a servo is at its speed limit"},
    {Measure::at_torque_limit, "at_torque_limit", "", false, false,
     "share of the time in which a servo is at its torque limit"},
    {Measure::largest_acceleration, "largest_acceleration", "m/s^2", false, false,
     "largest acceleration of the centre of mass"},
    {Measure::mean_current, "mean_current", "mA", false, false, "mean current of a servo; an estimate"},
    {Measure::potential_energy, "potential_energy", "J", false, true,
     "potential energy against the start, mean over the time"},
    {Measure::kinetic_energy, "kinetic_energy", "J", false, false, "kinetic energy of the links, mean over the time"},
    {Measure::elastic_energy, "elastic_energy", "J", false, false,
     "energy in the servos as if they were springs, mean over the time"},
    {Measure::wave_count, "wave_count", "", true, false, "number k of waves on the body"},
    {Measure::predicted_distance, "predicted_distance", "m", true, false,
     "distance that the wave on the body goes without slip"},
    {Measure::lifted_links, "lifted_links", "", true, false,
     "number of links that do not touch the ground, mean over a stride"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < measure_count; ++i) {
    if (static_cast<std::size_t>(declarations[i].measure) != i) {
      return false;
    }
  }
  return true;
}
static_assert(in_order(), "declaration_of() uses the enumerator as the index");

}  // namespace

std::span<const MeasureDeclaration, measure_count> measures() { return declarations; }

const MeasureDeclaration& declaration_of(Measure measure) { return declarations[static_cast<std::size_t>(measure)]; }

std::optional<Measure> find_measure(std::string_view name) {
  const auto* const found = std::ranges::find(declarations, name, &MeasureDeclaration::name);
  return found == declarations.end() ? std::nullopt : std::optional(found->measure);
}

std::vector<std::string> measure_names() {
  std::vector<std::string> names;
  names.reserve(declarations.size());
  for (const MeasureDeclaration& declaration : declarations) {
    names.emplace_back(declaration.name);
  }
  return names;
}

}  // namespace proleg::sim
