#include "sim/optimize/adaptation/adaptation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace proleg::optimize {
namespace {

/// For values that are costs, the worst one says nothing about what a good gait can do.
double scale_of(const Hypothesis& hypothesis) {
  const double best = std::abs(std::ranges::max(hypothesis.values));
  return best > 0.0 ? best : 1.0;
}

}  // namespace

Adaptation::Adaptation(std::vector<std::vector<double>> points, std::vector<Hypothesis> hypotheses,
                       const AdaptationSettings& settings)
    : points_(std::move(points)), hypotheses_(std::move(hypotheses)), settings_(settings) {
  const double scale = scale_of(hypotheses_.front());
  lowest_ = std::ranges::min(hypotheses_.front().values) - scale;
  for (Hypothesis& hypothesis : hypotheses_) {
    for (double& value : hypothesis.values) {
      value = std::max(value, lowest_);
    }
    processes_.emplace_back(Kernel{settings.length, hypothesis.deviation * scale, settings.noise * scale});
  }
  update();
}

/// The mean of a mixture is that of the means; its variance is the mean of the variances, and the variance of the
/// means.
void Adaptation::update() {
  std::vector<double> logarithms;  // of the probabilities, without their common factor
  for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
    logarithms.push_back(std::log(hypotheses_[h].probability) + processes_[h].log_likelihood());
  }
  const double greatest = std::ranges::max(logarithms);
  probabilities_.clear();
  double sum = 0.0;
  for (const double logarithm : logarithms) {
    probabilities_.push_back(std::exp(logarithm - greatest));
    sum += probabilities_.back();
  }
  for (double& probability : probabilities_) {
    probability /= sum;
  }
  expected_.clear();
  std::vector<Estimate> estimates(hypotheses_.size());
  for (std::size_t gait = 0; gait < points_.size(); ++gait) {
    double mean = 0.0;
    for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
      estimates[h] = processes_[h].estimate(points_[gait], hypotheses_[h].values[gait]);
      mean += probabilities_[h] * estimates[h].mean;
    }
    double variance = 0.0;
    for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
      const double off = estimates[h].mean - mean;
      variance += probabilities_[h] * (estimates[h].deviation * estimates[h].deviation + off * off);
    }
    expected_.push_back({mean, std::sqrt(variance)});
  }
}

double Adaptation::promise(std::size_t gait) const {
  return expected_[gait].mean + settings_.kappa * expected_[gait].deviation;
}

/// A second trial of a gait would tell little: its value is known but for the noise.
std::optional<std::size_t> Adaptation::most_promising() const {
  std::optional<std::size_t> best;
  for (std::size_t gait = 0; gait < points_.size(); ++gait) {
    const bool is_tried = std::ranges::find(trials_, gait, &Trial::gait) != trials_.end();
    if (!is_tried && (!best || promise(gait) > promise(*best))) {
      best = gait;
    }
  }
  return best;
}

std::optional<std::size_t> Adaptation::next() const {
  return ending() == AdaptationEnding::none ? most_promising() : std::nullopt;
}

void Adaptation::tell(std::size_t gait, double value) {
  trials_.push_back({gait, expected_[gait], value});
  for (std::size_t h = 0; h < hypotheses_.size(); ++h) {
    processes_[h].observe(points_[gait], hypotheses_[h].values[gait], std::max(value, lowest_));
  }
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
  const std::optional<std::size_t> next = most_promising();
  if (!next) {
    return AdaptationEnding::all_tried;
  }
  if (const double most = promise(*next); best()->value >= most - (1.0 - settings_.alpha) * std::abs(most)) {
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
    case AdaptationEnding::all_tried:
      return "all gaits tried";
  }
  return "";
}

}  // namespace proleg::optimize
