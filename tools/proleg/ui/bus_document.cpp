#include "tools/proleg/ui/bus_document.hpp"

#include <algorithm>
#include <cmath>

#include "host/robot/state_text.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr Microseconds silent_us = 1'500'000;

std::optional<unsigned> joint_of(const sim::Scenario& scenario, std::uint8_t node) {
  const auto found = std::ranges::find(scenario.modules, node, &sim::ModulePlace::node);
  return found == scenario.modules.end() ? std::nullopt
                                         : std::optional(static_cast<unsigned>(found - scenario.modules.begin()));
}

/// Degrees: what the module sends while it moves, or what was read from it.
std::optional<double> angle_of(const host::MonitoredNode& node) {
  if (node.position) {
    return *node.position * 90.0 / (1 << 30);
  }
  if (node.measured && node.measured->angle != canopen::Monitoring::not_measured) {
    return node.measured->angle * 90.0 / (1 << 14);
  }
  return std::nullopt;
}

template <typename Value>
json or_null(const std::optional<Value>& value) {
  return value ? json(*value) : json();
}

json module_json(const sim::Scenario& scenario, const BusView& view, const host::MonitoredNode& node) {
  const std::optional<unsigned> joint = joint_of(scenario, node.node);
  const std::optional<std::uint16_t> watched = view.watch != nullptr ? view.watch->statusword(node.node) : std::nullopt;
  const std::optional<std::uint16_t> statusword = watched ? watched : node.statusword;
  const bool has_fault = node.measured && node.measured->faults != 0;
  json object{
      {"node", node.node},
      {"joint", or_null(joint)},
      {"state", node.state ? json(host::state_text(*node.state)) : json()},
      {"drive", statusword ? json(host::drive_text(*statusword)) : json()},
      {"angle", or_null(angle_of(node))},
      {"current", node.measured ? json(node.measured->current_ma) : json()},
      {"current_limit", or_null(node.current_limit)},
      {"temperature", node.measured ? json(node.measured->temperature_c) : json()},
      {"fault", nullptr},
      {"advice", nullptr},
      {"silent", node.last_heard + silent_us < view.now},
      {"stop_confirmed", joint && *joint < view.stop_confirmed.size() ? or_null(view.stop_confirmed[*joint]) : json()}};
  if (node.last_emergency && has_fault) {
    object["fault"] = canopen::describe(node.last_emergency->code);
    object["advice"] = host::fault_advice(node.last_emergency->code);
  } else if (has_fault) {
    object["fault"] = "the module reports an error";
    object["advice"] = "Look at its error register: proleg info.";
  }
  return object;
}

}  // namespace

json bus_document(const sim::Scenario& scenario, const BusView& view) {
  json modules = json::array();
  for (const host::MonitoredNode& node : view.nodes) {
    modules.push_back(module_json(scenario, view, node));
  }
  const double seconds = view.seconds > 0 ? view.seconds : 1.0;
  return {{"address", view.address},
          {"connected", view.is_connected},
          {"problem", view.problem.empty() ? json() : json(view.problem)},
          {"load", view.traffic.load},
          {"syncs", std::lround(view.traffic.syncs / seconds)},
          {"other_host", view.has_other_host},
          {"latency_ms", or_null(view.latency_ms)},
          {"modules", std::move(modules)}};
}

}  // namespace proleg::tools
