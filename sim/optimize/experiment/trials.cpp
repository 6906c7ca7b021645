#include "sim/optimize/experiment/trials.hpp"

#include <algorithm>
#include <cmath>

#include "shared/fixed/random.hpp"
#include "sim/optimize/experiment/search_space.hpp"
#include "sim/scenario/damage.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

/// Draws a uniform number between 0 and 1, both excluded.
double draw(Pcg32& random) { return (random.next() + 0.5) / 4294967296.0; }

/// Draws a uniform factor between 1 - spread and 1 + spread.
double draw_factor(Pcg32& random, double spread) { return 1.0 + spread * (2.0 * draw(random) - 1.0); }

/// The dimension that sets a parameter of a joint, or null.
const Dimension* find_dimension(const SearchSpace& space, const Setting& place) {
  for (const Dimension& dimension : space.dimensions) {
    for (const Setting& target : dimension.targets) {
      if (target.has_same_place(place)) {
        return &dimension;
      }
    }
  }
  return nullptr;
}

/// Whether an algorithm's state starts with noise on some joint.
bool starts_with_noise(const sim::Scenario& scenario, const SearchSpace& space, unsigned slot_number) {
  const Slot& slot = scenario.kernel.slots[slot_number];
  const Declaration& declaration = slot.algorithm->declaration();
  const int noise = find_parameter(declaration, noise_name);
  const bool has_scale = std::ranges::any_of(declaration.internal_values,
                                             [](const InternalValue& value) { return value.noise_scale != 0; });
  if (noise < 0 || !has_scale) {
    return false;
  }
  for (unsigned joint = 0; joint < scenario.kernel.joint_count; ++joint) {
    if (!slot.group.contains(joint)) {
      continue;
    }
    Setting place;
    place.slot = static_cast<std::uint8_t>(slot_number);
    place.joint = static_cast<std::uint8_t>(joint);
    place.number = static_cast<std::uint8_t>(noise);
    const Dimension* const dimension = find_dimension(space, place);
    if (dimension != nullptr ? std::ranges::any_of(dimension->values, [](std::int32_t value) { return value != 0; })
                             : start_value(scenario, place.slot, place.joint, place.number) != 0) {
      return true;
    }
  }
  return false;
}

}  // namespace

void perturb(sim::Scenario& scenario, const Spread& spread, std::uint64_t seed) {
  Pcg32 friction(seed, sim::random_stream::friction);
  sim::scale_friction(scenario, draw_factor(friction, spread.friction));

  Pcg32 mass(seed, sim::random_stream::mass);
  for (sim::Link& link : scenario.robot.links) {
    const double factor = draw_factor(mass, spread.mass);
    link.mass.mass *= factor;
    link.mass.inertia *= factor;
  }

  sim::ServoModel& servo = scenario.robot.servo;
  Pcg32 gain(seed, sim::random_stream::servo_gain);
  servo.gain = std::min(servo.gain * draw_factor(gain, spread.servo_gain), 1.0 / scenario.step_s);

  constexpr std::uint32_t max_latency_us = 100'000;
  Pcg32 latency(seed, sim::random_stream::latency);
  const auto later_us = static_cast<std::uint32_t>(std::lround(draw(latency) * spread.latency_ms * 1000.0));
  servo.latency_us = std::min(servo.latency_us + later_us, max_latency_us);

  if (spread.contact_noise > 0.0) {
    scenario.contact_noise = spread.contact_noise;
  }
  scenario.kernel.seed = seed;
}

bool depends_on_seed(const sim::Scenario& scenario, const SearchSpace& space, const Spread& spread) {
  if (spread.any() || scenario.contact_noise > 0.0) {
    return true;
  }
  for (unsigned slot = 0; slot < max_slots; ++slot) {
    if (scenario.kernel.slots[slot].algorithm != nullptr && starts_with_noise(scenario, space, slot)) {
      return true;
    }
  }
  return false;
}

std::uint64_t trial_seed(std::uint64_t experiment_seed, std::uint32_t run, std::uint64_t individual,
                         std::uint32_t trial) {
  // Each step is a bijection of its number: seeds that differ in one number are never equal.
  std::uint64_t seed = scatter(experiment_seed);
  seed = scatter(seed ^ run);
  seed = scatter(seed ^ individual);
  return scatter(seed ^ trial);
}

}  // namespace proleg::optimize
