#include "sim/optimize/method/deluge_chain.hpp"

#include <algorithm>
#include <limits>

#include "sim/optimize/experiment/seeds.hpp"

namespace proleg::optimize {
namespace {

/// A draw from -radius to radius must have fewer than 2^32 outcomes.
constexpr std::uint32_t max_radius = std::numeric_limits<std::int32_t>::max();

double draw_offset(GreatDelugeSettings::Neighbour neighbour, std::uint32_t radius, Pcg32& noise) {
  const double reach = radius;
  switch (neighbour) {
    case GreatDelugeSettings::Neighbour::three:
      return reach * (static_cast<double>(noise.below(3)) - 1.0);
    case GreatDelugeSettings::Neighbour::sign:
      return noise.below(2) == 0 ? -reach : reach;
    case GreatDelugeSettings::Neighbour::uniform:
      return static_cast<double>(noise.below(2 * radius + 1)) - reach;
  }
  return 0.0;
}

}  // namespace

std::uint32_t radius_after(const GreatDelugeSettings& settings, std::uint32_t used) {
  const std::uint64_t times = used / settings.confidence;
  std::uint64_t radius = settings.step;
  if (settings.growth == GreatDelugeSettings::Growth::linear) {
    radius *= 1 + times;
  } else {
    for (std::uint64_t i = 0; i < times && radius < max_radius; ++i) {
      radius *= 2;
    }
  }
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(radius, max_radius));
}

Pcg32 candidate_noise(std::uint64_t seed, std::uint32_t chain, std::uint64_t number) {
  return {scatter(scatter(seed) + number), chain};
}

std::vector<double> DelugeChain::draw(const GreatDelugeSettings& settings, std::uint64_t seed, const DelugeBox& box) {
  Pcg32 noise = candidate_noise(seed, index, drawn++);
  const std::uint32_t radius = radius_after(settings, used);
  std::vector<double> place = current;
  const auto move = [&](std::size_t i) {
    place[i] = std::clamp(place[i] + draw_offset(settings.neighbour, radius, noise), box.lower[i], box.upper[i]);
  };
  if (settings.move == GreatDelugeSettings::Move::one) {
    move(noise.below(static_cast<std::uint32_t>(place.size())));
  } else {
    for (std::size_t i = 0; i < place.size(); ++i) {
      move(i);
    }
  }
  return place;
}

void DelugeChain::accept(const GreatDelugeSettings& settings, const std::vector<double>& place) {
  current = place;
  water += settings.rain;
  used = 0;
}

void DelugeChain::fail(const GreatDelugeSettings& settings) {
  if (++used < settings.retries) {
    return;
  }
  if (credits == 0) {
    ended = true;
    return;
  }
  --credits;
  used = 0;
}

}  // namespace proleg::optimize
