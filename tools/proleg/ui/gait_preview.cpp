#include "tools/proleg/ui/gait_preview.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/measure/measure.hpp"
#include "sim/measure/stride.hpp"
#include "sim/physics/physics_error.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"

namespace proleg::tools {
namespace {

constexpr double sample_period_s = 0.01;
constexpr std::size_t samples_of_point = 10;
constexpr std::size_t moments_of_stride = 4;

std::vector<sim::Pose> copy_of(std::span<const sim::Pose> poses) { return {poses.begin(), poses.end()}; }

struct Samples {
  double period_s = sample_period_s;
  std::vector<double> targets;                ///< rad, of all joints, sample by sample
  std::vector<std::vector<sim::Pose>> links;  ///< of each sample

  void add(const sim::Simulation& simulation) {
    constexpr double radians = std::numbers::pi / 2.0 / (1 << 30);  // set-points: 90 degrees = 2^30
    for (const std::int32_t setpoint : simulation.setpoints()) {
      targets.push_back(setpoint * radians);
    }
    links.push_back(copy_of(simulation.plant().link_poses()));
  }
};

/// A quarter of a stride apart, the last one at the end. Without strides: of the last second.
std::vector<std::vector<sim::Pose>> last_moments(const Samples& samples, std::size_t joints) {
  const auto stride = sim::find_stride({samples.targets, joints}, samples.period_s);
  const double stride_s = stride ? 1.0 / stride->frequency : 1.0;
  std::vector<std::vector<sim::Pose>> moments;
  for (std::size_t i = moments_of_stride; i-- > 0;) {
    const double back_s = stride_s * static_cast<double>(i) / static_cast<double>(moments_of_stride);
    const auto back = static_cast<std::size_t>(std::lround(back_s / samples.period_s));
    moments.push_back(samples.links[samples.links.size() - 1 - std::min(back, samples.links.size() - 1)]);
  }
  return moments;
}

}  // namespace

GaitPreview preview_of(sim::Scenario scenario, std::chrono::milliseconds longest,
                       const std::function<bool()>& is_outdated) {
  const std::chrono::nanoseconds end = thread_time() + longest;
  const std::unique_ptr<sim::Simulation> simulation = make_fast_simulation(scenario);
  const auto links = copy_of(simulation->plant().link_poses());
  const GaitPreview start{links, {links}, copy_of(simulation->plant().object_poses()), {links.front().position}, {}};
  GaitPreview preview = start;
  const double tick_s = scenario.kernel.tick_period_us * 1e-6;
  const auto ticks = static_cast<std::uint32_t>(std::max(1L, std::lround(preview_seconds / tick_s)));
  const auto ticks_of_sample = static_cast<std::uint32_t>(std::max(1L, std::lround(sample_period_s / tick_s)));
  Samples samples;
  samples.period_s = ticks_of_sample * tick_s;
  const auto samples_between =
      static_cast<std::size_t>(std::max(1L, std::lround(samples_of_point * sample_period_s / samples.period_s)));
  try {
    while (simulation->tick() < ticks) {
      if (thread_time() >= end || is_outdated()) {
        return start;
      }
      simulation->advance();
      if (simulation->tick() % ticks_of_sample != 0) {
        continue;
      }
      samples.add(*simulation);
      if (samples.links.size() % samples_between == 0) {
        preview.path.push_back(samples.links.back().front().position);
      }
    }
  } catch (const InputError&) {  // a move to a place where the robot cannot be put
    return start;
  } catch (const sim::PhysicsError&) {
    return start;
  }
  if (!samples.links.empty()) {
    preview.moments = last_moments(samples, scenario.robot.joints.size());
  }
  preview.objects = copy_of(simulation->plant().object_poses());
  const double distance = simulation->measures()[sim::Measure::distance];
  preview.distance = std::isfinite(distance) ? std::optional(distance) : std::nullopt;
  return preview;
}

}  // namespace proleg::tools
