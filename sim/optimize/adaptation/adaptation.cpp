#include "sim/optimize/adaptation/adaptation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace proleg::optimize {
namespace {

/// The scale of the map's values.
double scale_of(const std::vector<AdaptationCell>& cells) {
  double greatest = 0.0;
  for (const AdaptationCell& cell : cells) {
    greatest = std::max(greatest, std::abs(cell.prior));
  }
  return greatest > 0.0 ? greatest : 1.0;
}

}  // namespace

Adaptation::Adaptation(std::vector<AdaptationCell> cells, const AdaptationSettings& settings)
    : cells_(std::move(cells)),
      settings_(settings),
      process_({settings.length, scale_of(cells_), settings.noise * scale_of(cells_)}),
      lowest_(std::ranges::min_element(cells_, {}, &AdaptationCell::prior)->prior - scale_of(cells_)) {
  update();
}

void Adaptation::update() {
  expected_.clear();
  for (const AdaptationCell& cell : cells_) {
    expected_.push_back(process_.estimate(cell.point, cell.prior));
  }
}

std::optional<std::size_t> Adaptation::next() const {
  if (ending() != AdaptationEnding::none) {
    return std::nullopt;
  }
  const auto promise = [&](const Estimate& estimate) { return estimate.mean + settings_.kappa * estimate.deviation; };
  return static_cast<std::size_t>(std::ranges::max_element(expected_, {}, promise) - expected_.begin());
}

void Adaptation::tell(std::size_t cell, double value) {
  trials_.push_back({cell, expected_[cell], value});
  process_.observe(cells_[cell].point, cells_[cell].prior, std::max(value, lowest_));
  update();
}

const Adaptation::Trial* Adaptation::best() const {
  const auto best = std::ranges::max_element(trials_, {}, &Trial::value);
  return best == trials_.end() ? nullptr : &*best;
}

/// For values below 0 the share is one of their absolute value: -1.1 is at least 0.9 times -1.
AdaptationEnding Adaptation::ending() const {
  if (trials_.empty()) {
    return AdaptationEnding::none;
  }
  const double most = std::ranges::max_element(expected_, {}, &Estimate::mean)->mean;
  if (best()->value >= most - (1.0 - settings_.alpha) * std::abs(most)) {
    return AdaptationEnding::good_enough;
  }
  return trials_.size() >= settings_.trials ? AdaptationEnding::trials_used_up : AdaptationEnding::none;
}

std::string_view text_of(AdaptationEnding ending) {
  switch (ending) {
    case AdaptationEnding::none:
      return "";
    case AdaptationEnding::good_enough:
      return "good enough";
    case AdaptationEnding::trials_used_up:
      return "trials used up";
  }
  return "";
}

}  // namespace proleg::optimize
