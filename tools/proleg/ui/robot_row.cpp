#include "tools/proleg/ui/robot_row.hpp"

#include <algorithm>

#include "shared/fixed/unit.hpp"
#include "tools/proleg/document/telemetry_row.hpp"

namespace proleg::tools {
namespace {

constexpr const char* simulated_angle = "simulated_angle";

std::vector<host::Signal> signals(const sim::Scenario& scenario) {
  std::vector<host::Signal> signals = signals_of(scenario);
  signals.push_back(
      {simulated_angle, "deg", value_of_step(Unit::degree), scenario.robot.joints.size(), host::SignalOf::joint});
  return signals;
}

}  // namespace

RobotRows::RobotRows(const sim::Scenario& scenario)
    : scenario_(scenario), layout_(signals(scenario)), row_(layout_.row_size(), host::no_value) {}

std::span<std::int32_t> RobotRows::signal(const char* name) {
  const host::SignalColumns* columns = layout_.find(name);
  return std::span(row_).subspan(columns->offset, columns->count);
}

std::uint16_t RobotRows::run_of(std::uint32_t tick) {
  if (is_idle_ || tick == 0) {
    ++run_;
    is_idle_ = false;
  }
  return run_;
}

std::span<const std::int32_t> RobotRows::fill(const sim::TickSample& sample, std::span<const double> simulated_angles,
                                              const std::vector<bool>& measured) {
  fill_row(sample, scenario_, row_);
  const std::span<std::int32_t> angles(row_.data() + layout_.find("angle")->offset, measured.size());
  for (std::size_t joint = 0; joint < measured.size(); ++joint) {
    angles[joint] = measured[joint] ? angles[joint] : host::no_value;
  }
  for (const double angle : simulated_angles) {
    row_.push_back(raw_angle(angle));
  }
  row_.resize(layout_.row_size(), host::no_value);
  if (simulated_angles.empty()) {
    for (const char* name : {"head", "torque", "force"}) {
      std::ranges::fill(signal(name), host::no_value);
    }
  }
  return row_;
}

std::vector<RobotRows::Idle> RobotRows::idle(Clock::time_point now,
                                             const std::vector<std::optional<std::int32_t>>& angles) {
  constexpr std::chrono::milliseconds longest_delay{200};  // then nothing is caught up
  if (!is_idle_ || now > idle_due_ + longest_delay) {
    run_ = is_idle_ ? run_ : static_cast<std::uint16_t>(run_ + 1);
    idle_tick_ = is_idle_ ? idle_tick_ : 0;
    is_idle_ = true;
    idle_due_ = now;
  }
  std::vector<Idle> rows;
  for (; idle_due_ <= now; idle_due_ += std::chrono::microseconds(scenario_.kernel.tick_period_us)) {
    std::ranges::fill(row_, host::no_value);
    const std::span<std::int32_t> shown = signal("angle");
    for (std::size_t joint = 0; joint < angles.size(); ++joint) {
      shown[joint] = angles[joint].value_or(host::no_value);
    }
    rows.push_back({run_, idle_tick_++, row_});
  }
  return rows;
}

}  // namespace proleg::tools
