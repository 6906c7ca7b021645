#include "tools/proleg/ui/bus_view.hpp"

#include <algorithm>
#include <cmath>

#include "host/robot/state_text.hpp"
#include "shared/fixed/unit.hpp"
#include "tools/proleg/document/telemetry_row.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr Microseconds silent_us = 1'500'000;

std::optional<unsigned> joint_of(std::span<const sim::ModulePlace> modules, std::uint8_t node) {
  const auto found = std::ranges::find(modules, node, &sim::ModulePlace::node);
  return found == modules.end() ? std::nullopt : std::optional(static_cast<unsigned>(found - modules.begin()));
}

template <typename Value>
json or_null(const std::optional<Value>& value) {
  return value ? json(*value) : json();
}

json module_json(std::span<const sim::ModulePlace> places, const BusView& view, const host::MonitoredNode& node) {
  const std::optional<unsigned> joint = joint_of(places, node.node);
  const std::optional<std::uint16_t> watched = view.watch != nullptr ? view.watch->statusword(node.node) : std::nullopt;
  const std::optional<std::uint16_t> statusword = watched ? watched : node.statusword;
  const bool has_fault = node.error_register.value_or(0) != 0;
  json object{
      {"node", node.node},
      {"joint", or_null(joint)},
      {"state", node.state ? json(host::state_text(*node.state)) : json()},
      {"drive", statusword ? json(host::drive_text(*statusword)) : json()},
      {"angle", node.position ? json(*node.position * 90.0 / (1 << 30)) : json()},
      {"current", or_null(node.current_ma)},
      {"current_limit", or_null(node.current_limit)},
      {"temperature", or_null(node.temperature_c)},
      {"contacts", or_null(node.contacts)},
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

constexpr const char* simulated_angle = "simulated_angle";

std::vector<host::Signal> signals(const sim::Scenario& scenario) {
  std::vector<host::Signal> signals = signals_of(scenario);
  signals.push_back(
      {simulated_angle, "deg", value_of_step(Unit::degree), scenario.robot.joints.size(), host::SignalOf::joint});
  return signals;
}

}  // namespace

json bus_document(std::span<const sim::ModulePlace> places, const BusView& view) {
  json modules = json::array();
  for (const host::MonitoredNode& node : view.nodes) {
    modules.push_back(module_json(places, view, node));
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

std::optional<BusView> BusViews::due(Clock::time_point now) {
  std::vector<host::MonitoredNode> nodes = monitor_.nodes();
  std::vector<std::optional<std::uint8_t>> contacts;
  contacts.reserve(nodes.size());
  for (const host::MonitoredNode& node : nodes) {
    contacts.push_back(node.contacts);
  }
  if (now < due_ && contacts == contacts_) {
    return std::nullopt;
  }
  contacts_ = std::move(contacts);
  due_ = now + period;
  BusView view;
  view.address = address_;
  view.is_connected = bus_.state().is_connected;
  view.problem = view.is_connected ? bus_.state().reason : bus_.diagnosis();
  view.now = bus_.now();
  if (now >= traffic_from_ + period) {
    traffic_ = monitor_.take_traffic(view.now);
    seconds_ = std::chrono::duration<double>(now - std::exchange(traffic_from_, now)).count();
  }
  view.traffic = traffic_;
  view.seconds = seconds_;
  view.has_other_host = monitor_.has_host(view.now);
  view.nodes = std::move(nodes);
  return view;
}

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
