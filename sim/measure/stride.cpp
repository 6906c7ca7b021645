#include "sim/measure/stride.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

namespace proleg::sim {
namespace {

constexpr double min_amplitude = 0.5 * std::numbers::pi / 180.0;
/// A crossing of the mean counts if the signal was below the mean by this share of its amplitude: a ripple is no
/// stride.
constexpr double hysteresis = 0.25;

struct Swing {
  std::size_t signal = 0;
  double mean = 0.0;
  double amplitude = 0.0;  ///< amplitude of a sine with the same standard deviation
};

Swing max_swing(const SignalTable& signals) {
  std::vector<double> sum(signals.signals);
  std::vector<double> square_sum(signals.signals);
  for (std::size_t tick = 0; tick < signals.ticks(); ++tick) {
    for (std::size_t i = 0; i < signals.signals; ++i) {
      const double value = signals.at(tick, i);
      sum[i] += value;
      square_sum[i] += value * value;
    }
  }
  const auto ticks = static_cast<double>(signals.ticks());
  Swing largest;
  for (std::size_t i = 0; i < signals.signals; ++i) {
    const double mean = sum[i] / ticks;
    const double amplitude = std::sqrt(2.0 * std::max(square_sum[i] / ticks - mean * mean, 0.0));
    if (amplitude > largest.amplitude) {
      largest = {i, mean, amplitude};
    }
  }
  return largest;
}

/// Interpolated times of the upward crossings, in ticks.
std::vector<double> upward_crossings(const SignalTable& signals, const Swing& swing) {
  std::vector<double> crossings;
  bool was_below = false;
  double before = 0.0;
  for (std::size_t tick = 0; tick < signals.ticks(); ++tick) {
    const double value = signals.at(tick, swing.signal) - swing.mean;
    if (value < -hysteresis * swing.amplitude) {
      was_below = true;
    } else if (was_below && value >= 0.0) {
      crossings.push_back(static_cast<double>(tick) - value / (value - before));
      was_below = false;
    }
    before = value;
  }
  return crossings;
}

}  // namespace

std::optional<Stride> find_stride(const SignalTable& angles, double tick_s) {
  const Swing swing = max_swing(angles);
  if (swing.amplitude < min_amplitude) {
    return std::nullopt;
  }
  std::vector<double> crossings = upward_crossings(angles, swing);
  if (crossings.size() < 2) {
    return std::nullopt;
  }
  if (crossings.size() > 2) {
    crossings.erase(crossings.begin());
  }
  const double strides = static_cast<double>(crossings.size() - 1);
  return Stride{strides / ((crossings.back() - crossings.front()) * tick_s),
                static_cast<std::size_t>(std::lround(crossings.front())),
                static_cast<std::size_t>(std::lround(crossings.back())), std::move(crossings)};
}

std::optional<BodyWave> find_body_wave(const SignalTable& angles, std::span<const std::size_t> joints,
                                       const Stride& stride, double tick_s) {
  constexpr double least_amplitude = 1e-4;  // rad
  if (joints.size() < 2) {
    return std::nullopt;
  }
  // The sum of angle times exp(-i w t) over whole strides is proportional to amplitude times exp(i phase).
  const std::complex<double> turn = std::polar(1.0, -2.0 * std::numbers::pi * stride.frequency * tick_s);
  std::vector<std::complex<double>> swings(joints.size());
  std::complex<double> pointer = 1.0;
  for (std::size_t tick = stride.first_tick; tick < stride.end_tick; ++tick) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      swings[i] += angles.at(tick, joints[i]) * pointer;
    }
    pointer *= turn;
  }
  const auto ticks = static_cast<double>(stride.end_tick - stride.first_tick);
  BodyWave wave;
  wave.joints = joints.size();
  std::complex<double> differences = 0.0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    wave.amplitude += 2.0 * std::abs(swings[i]) / ticks / static_cast<double>(joints.size());
    if (i > 0) {
      differences += swings[i] * std::conj(swings[i - 1]);
    }
  }
  if (!(wave.amplitude > least_amplitude) || std::abs(differences) == 0.0) {
    return std::nullopt;
  }
  wave.phase_difference = std::arg(differences);
  return wave;
}

}  // namespace proleg::sim
