#include "tools/proleg/ui/gait_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "shared/computer/errors/input_error.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/physics/physics_error.hpp"
#include "tools/proleg/document/telemetry_row.hpp"
#include "tools/proleg/ui/fast_simulation.hpp"

namespace proleg::tools {
namespace {

constexpr double longest_motion_s = 30.0;
constexpr double row_period_s = 0.02;

/// Header of four words, then rows: little-endian, as the processors that this program runs on.
class MotionRows {
 public:
  MotionRows(std::uint32_t tick_us, std::uint32_t stride, std::size_t joints)
      : words_{static_cast<std::int32_t>(tick_us), static_cast<std::int32_t>(stride), 0,
               static_cast<std::int32_t>(joints)} {}

  void add(const sim::Plant& plant) {
    for (const double angle : plant.joint_angles()) {
      words_.push_back(raw_angle(angle));
    }
    append_pose(plant.link_poses().front(), words_);
    ++words_[2];
  }

  [[nodiscard]] std::vector<std::uint8_t> bytes() const {
    std::vector<std::uint8_t> bytes(words_.size() * sizeof(std::int32_t));
    std::memcpy(bytes.data(), words_.data(), bytes.size());
    return bytes;
  }

 private:
  std::vector<std::int32_t> words_;
};

}  // namespace

std::vector<std::uint8_t> gait_motion(const sim::Scenario& scenario, std::chrono::milliseconds longest,
                                      const std::function<bool()>& is_outdated) {
  const std::chrono::nanoseconds end = thread_time() + longest;
  const double tick_s = scenario.kernel.tick_period_us * 1e-6;
  const auto stride = static_cast<std::uint32_t>(std::max(1L, std::lround(row_period_s / tick_s)));
  const auto ticks = static_cast<std::uint32_t>(std::lround(std::min(longest_motion_s, scenario.duration_s) / tick_s));
  MotionRows rows(scenario.kernel.tick_period_us, stride, scenario.robot.joints.size());
  try {
    sim::Simulation simulation(scenario);
    simulation.leave_out_hashes();
    rows.add(simulation.plant());
    while (simulation.tick() < ticks && thread_time() < end && !is_outdated()) {
      simulation.advance();
      if (simulation.tick() % stride == 0) {
        rows.add(simulation.plant());
      }
    }
  } catch (const InputError&) {         // a move to a place where the robot cannot be put
  } catch (const sim::PhysicsError&) {  // the motion ends there
  }
  return rows.bytes();
}

}  // namespace proleg::tools
