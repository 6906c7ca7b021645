#pragma once

#include <cstdint>
#include <vector>

#include "shared/fixed/random.hpp"
#include "sim/optimize/experiment/method_settings.hpp"

namespace proleg::optimize {

/// The bounds of the variables.
struct DelugeBox {
  std::vector<double> lower;
  std::vector<double> upper;
};

/// One great deluge among several that take turns: its place, its water, and its remaining retries and credits.
struct DelugeChain {
  std::uint32_t index;
  std::vector<double> current;
  double water;
  std::uint32_t credits;
  std::uint32_t used = 0;        ///< retries since the last accepted candidate or used credit
  std::uint64_t drawn = 0;       ///< candidates so far
  double acceptance_rate = 0.0;  ///< share of the latest candidates that were accepted, 0 to 1
  bool ended = false;

  /// Draws the next candidate.
  [[nodiscard]] std::vector<double> draw(const GreatDelugeSettings& settings, std::uint64_t seed, const DelugeBox& box);

  void count_outcome(bool accepted) { acceptance_rate += 0.25 * ((accepted ? 1.0 : 0.0) - acceptance_rate); }
  void accept(const GreatDelugeSettings& settings, const std::vector<double>& place);
  void fail(const GreatDelugeSettings& settings);
};

/// Radius of the search after this number of used retries.
[[nodiscard]] std::uint32_t radius_after(const GreatDelugeSettings& settings, std::uint32_t used);

/// The random numbers of a chain's candidate; number: from 0. They depend on nothing else, so a candidate can be
/// predicted. They are drawn in this order: the variable (Move::one only); then U for each variable that moves.
[[nodiscard]] Pcg32 candidate_noise(std::uint64_t seed, std::uint32_t chain, std::uint64_t number);

}  // namespace proleg::optimize
