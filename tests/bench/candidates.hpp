#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/fixed/random.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::bench {

/// Of the candidates with which both physics engines are compared.
inline constexpr std::uint64_t candidate_seed = 1;

/// Scenarios with random parameters of the sine generator, as a search meets them: 10 to 70 degrees, 0.3 to 2.2 Hz, 15
/// to 140 degrees from joint to joint. The same for the same seed.
[[nodiscard]] inline std::vector<sim::Scenario> candidates(const sim::Scenario& scenario, std::size_t count,
                                                           std::uint64_t seed) {
  Pcg32 random(seed, 0);
  const auto draw = [&](const char* name, std::uint32_t from, std::uint32_t to) {
    // In hundredths.
    const std::uint32_t value = from + random.next() % (to - from + 1);
    const std::string fraction = std::to_string(value % 100);
    return std::string(name) + "=" + std::to_string(value / 100) + (fraction.size() == 1 ? ".0" : ".") + fraction;
  };
  std::vector<sim::Scenario> all(count, scenario);
  for (sim::Scenario& candidate : all) {
    sim::apply_setting(candidate, draw("amplitude", 1000, 7000));
    sim::apply_setting(candidate, draw("frequency", 30, 220));
    sim::apply_setting(candidate, draw("phase_difference", 1500, 14000));
  }
  return all;
}

}  // namespace proleg::bench
