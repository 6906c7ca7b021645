#include "sim/measure/stride.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "test_units.hpp"

namespace proleg::sim {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;

struct Signals {
  std::vector<double> samples;
  std::size_t count;

  [[nodiscard]] SignalTable table() const { return {samples, count}; }
};

/// mean + amplitude * sin(2 pi frequency t + phase)
struct Oscillation {
  double mean;
  double amplitude;
  double phase;
};

/// Samples of oscillations of one frequency.
Signals oscillating(const std::vector<Oscillation>& oscillations, double frequency, double seconds) {
  Signals signals{{}, oscillations.size()};
  for (int tick = 0; tick < std::lround(seconds / tick_s); ++tick) {
    for (const Oscillation& o : oscillations) {
      signals.samples.push_back(o.mean + o.amplitude * std::sin(full_turn * frequency * tick * tick_s + o.phase));
    }
  }
  return signals;
}

TEST(Stride, HasTheFrequencyOfTheSignalForEveryPeriod) {
  for (const double frequency : {0.2, 0.7, 1.0, 1.01, std::numbers::e, 7.3, 13.0}) {
    const auto stride = find_stride(oscillating({{0.1, 0.02, 0.0}, {-0.2, 0.6, 1.0}}, frequency, 20).table(), tick_s);
    ASSERT_TRUE(stride) << frequency;
    EXPECT_NEAR(stride->frequency, frequency, 2e-3 * frequency) << "crossings are interpolated linearly";
    const double strides = static_cast<double>(stride->end_tick - stride->first_tick) * tick_s * frequency;
    EXPECT_NEAR(strides, std::round(strides), 1.01 * tick_s * frequency) << "a whole number, to the tick";
    EXPECT_GE(strides, 2.0);
    EXPECT_LE(stride->end_tick, 2000U);
  }
}

TEST(Stride, RunningBackwardsHasTheSameFrequency) {
  Signals forward = oscillating({{0.0, 0.6, 0.0}, {0.0, 0.6, 1.0}}, 1.0, 10);
  Signals backward{{}, 2};
  for (std::size_t tick = forward.samples.size() / 2; tick-- > 0;) {
    backward.samples.insert(backward.samples.end(), {forward.samples[2 * tick], forward.samples[2 * tick + 1]});
  }
  const auto there = find_stride(forward.table(), tick_s);
  const auto back = find_stride(backward.table(), tick_s);
  ASSERT_TRUE(there && back);
  EXPECT_NEAR(there->frequency, back->frequency, 1e-6);
}

TEST(Stride, IsFoundDespiteNoiseHarmonicsAndAnOffset) {
  Signals signals = oscillating({{0.5, 0.6, 0.3}}, 1.3, 20);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.03);
  for (std::size_t tick = 0; tick < signals.samples.size(); ++tick) {
    const double t = static_cast<double>(tick) * tick_s;
    signals.samples[tick] += noise(random) + 0.2 * std::sin(full_turn * 3 * 1.3 * t);
  }
  const auto stride = find_stride(signals.table(), tick_s);
  ASSERT_TRUE(stride);
  EXPECT_NEAR(stride->frequency, 1.3, 0.01) << "seed 7";
}

TEST(Stride, OfAGaitThatChangesItsPaceHasTheMeanFrequency) {
  Signals signals{{}, 3};
  double phase = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    phase += full_turn * tick_s * (tick < 1000 ? 0.8 : 0.8 + 3e-4 * (tick - 1000));
    signals.samples.insert(signals.samples.end(),
                           {0.6 * std::sin(phase), 0.5 * std::sin(phase - 1.0), 0.4 * std::sin(phase - 2.0)});
  }
  const auto stride = find_stride(signals.table(), tick_s);
  ASSERT_TRUE(stride);
  const double strides = static_cast<double>(stride->bounds.size() - 1);
  EXPECT_NEAR(stride->frequency, strides / ((stride->bounds.back() - stride->bounds.front()) * tick_s), 1e-12);
  EXPECT_NEAR(strides, phase / full_turn - 2, 1.0);
}

TEST(Stride, TheFirstOneIsLeftOut) {
  Signals signals = oscillating({{0.0, 0.6, 0.0}}, 1.0, 10);
  for (std::size_t tick = 0; tick < 100; ++tick) {
    signals.samples[tick] =
        0.6 * std::sin(full_turn * 2.0 * static_cast<double>(tick) * tick_s);  // starts at twice the pace
  }
  const auto stride = find_stride(signals.table(), tick_s);
  ASSERT_TRUE(stride);
  EXPECT_NEAR(stride->frequency, 1.0, 0.01);
  EXPECT_GE(stride->first_tick, 50U);
}

TEST(Stride, OneIsEnoughAndLessIsNone) {
  const std::vector<Oscillation> sine{
      {0.0, 0.6, std::numbers::pi}};  // falls first, crosses upwards after half a stride
  EXPECT_FALSE(find_stride(oscillating(sine, 1.0, 1.45).table(), tick_s));
  const auto stride = find_stride(oscillating(sine, 1.0, 1.6).table(), tick_s);
  ASSERT_TRUE(stride);
  EXPECT_NEAR(stride->frequency, 1.0, 0.05);
}

TEST(Stride, ARobotThatRestsHasNone) {
  EXPECT_FALSE(find_stride({}, tick_s));
  EXPECT_FALSE(find_stride(oscillating({{0.4, 0.0, 0.0}, {0.0, 0.0, 0.0}}, 1.0, 10).table(), tick_s));
  EXPECT_FALSE(find_stride(oscillating({{0.4, 0.3 * degree, 0.0}}, 1.0, 10).table(), tick_s)) << "it trembles";
  Signals ramp{{}, 1};
  for (int tick = 0; tick < 1000; ++tick) {
    ramp.samples.push_back(1e-3 * tick);
  }
  EXPECT_FALSE(find_stride(ramp.table(), tick_s)) << "moves once";
}

}  // namespace
}  // namespace proleg::sim
