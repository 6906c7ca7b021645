#pragma once

// What the page shows of a robot on a bus: the document `bus`, and its telemetry.

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/robot/bus_connection.hpp"
#include "host/robot/bus_monitor.hpp"
#include "host/robot/gait_watch.hpp"
#include "host/server/telemetry.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// What is known about a bus, for the document `bus` of docs/page-interface.md.
struct BusView {
  std::string address;
  bool is_connected = false;
  std::string problem;  ///< empty: none
  host::BusMonitor::Traffic traffic{};
  double seconds = 0;  ///< duration of the traffic
  bool has_other_host = false;
  std::optional<double> latency_ms;
  std::vector<host::MonitoredNode> nodes;
  Microseconds now = 0;
  const host::GaitWatch* watch = nullptr;             ///< while servos have power
  std::vector<std::optional<bool>> stop_confirmed{};  ///< of each joint, for the last STOP
};

/// places: of the robot's joints; none: it is not known whose modules they are.
[[nodiscard]] nlohmann::json bus_document(std::span<const sim::ModulePlace> places, const BusView& view);

/// What is known about a bus, as often as viewers need it: twice a second, and at once when a touch sensor of a module
/// has changed.
class BusViews {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds period{500};

  /// bus, monitor: must outlive this.
  BusViews(std::string address, const host::BusConnection& bus, host::BusMonitor& monitor)
      : address_(std::move(address)), bus_(bus), monitor_(monitor) {}

  /// What is known now, if it is due.
  [[nodiscard]] std::optional<BusView> due(Clock::time_point now);

 private:
  std::string address_;
  const host::BusConnection& bus_;
  host::BusMonitor& monitor_;
  Clock::time_point due_{};
  std::vector<std::optional<std::uint8_t>> contacts_;  ///< of the last view
  // Of half a second or more: in a few milliseconds there is one frame or none.
  Clock::time_point traffic_from_ = Clock::now();
  host::BusMonitor::Traffic traffic_{};
  double seconds_ = 0;
};

/// The telemetry of a robot on a bus (docs/page-interface.md): with power a row each tick of the gait, without power as
/// often, with what is known of the joints.
class RobotRows {
 public:
  using Clock = std::chrono::steady_clock;

  /// scenario: must outlive this.
  explicit RobotRows(const sim::Scenario& scenario);

  [[nodiscard]] const host::SignalLayout& layout() const { return layout_; }
  /// Number of the run of the last row.
  [[nodiscard]] std::uint16_t run() const { return run_; }

  /// The run of a tick with power: another one if the row before was without.
  [[nodiscard]] std::uint16_t run_of(std::uint32_t tick);
  /// The values of a tick. simulated_angles: rad; empty: nothing is simulated beside the robot. measured: of each joint
  /// whether its angle is known. Valid until the next call.
  [[nodiscard]] std::span<const std::int32_t> fill(const sim::TickSample& sample,
                                                   std::span<const double> simulated_angles,
                                                   const std::vector<bool>& measured);

  struct Idle {
    std::uint16_t run;
    std::uint32_t tick;
    std::vector<std::int32_t> values;
  };
  /// The rows without power that are due. angles: of each joint, 90 degrees = 2^30.
  [[nodiscard]] std::vector<Idle> idle(Clock::time_point now, const std::vector<std::optional<std::int32_t>>& angles);

 private:
  /// All values of a signal of the row, from its name.
  [[nodiscard]] std::span<std::int32_t> signal(const char* name);

  const sim::Scenario& scenario_;
  host::SignalLayout layout_;
  std::vector<std::int32_t> row_;
  std::uint16_t run_ = 0;
  bool is_idle_ = false;
  std::uint32_t idle_tick_ = 0;
  Clock::time_point idle_due_{};
};

}  // namespace proleg::tools
