#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/robot/bus_monitor.hpp"
#include "host/robot/gait_watch.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// What is known about a bus, for the document `bus` of docs/page-interface.md.
struct BusView {
  std::string address;
  bool is_connected = false;
  std::string problem;  ///< empty: none
  host::BusMonitor::Traffic traffic{};
  double seconds = 0;  ///< that the traffic has taken
  bool has_other_host = false;
  std::optional<double> latency_ms;
  std::vector<host::MonitoredNode> nodes;
  Microseconds now = 0;
  const host::GaitWatch* watch = nullptr;             ///< while servos have power
  std::vector<std::optional<bool>> stop_confirmed{};  ///< of each joint, for the last STOP
};

[[nodiscard]] nlohmann::json bus_document(const sim::Scenario& scenario, const BusView& view);

}  // namespace proleg::tools
