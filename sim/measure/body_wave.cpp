#include "sim/measure/body_wave.hpp"

#include <complex>
#include <vector>

namespace proleg::sim {

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
