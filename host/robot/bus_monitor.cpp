#include "host/robot/bus_monitor.hpp"

#include <algorithm>

#include "host/robot/frame_load.hpp"
#include "shared/canopen/declared_objects.hpp"

namespace proleg::host {
BusMonitor::BusMonitor(CanPort& port) : readings_(port, periodic_reading_options()) {
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    nodes_.at(node).node = static_cast<std::uint8_t>(node);
  }
}

void BusMonitor::count(const CanFrame& frame) {
  ++frames_;
  bits_ += average_bits(frame);
}

void BusMonitor::receive(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  count(frame);
  if (canopen::decode_sync(frame)) {
    ++syncs_;
    return;
  }
  const std::uint8_t number = identifier::node_of(frame.identifier);
  if (number == canopen::host_node && canopen::decode_heartbeat(frame)) {
    host_heard_ = now;
  }
  if (number < canopen::min_node_id || number > canopen::max_node_id) {
    return;
  }
  MonitoredNode& node = nodes_.at(number);
  if (const auto heartbeat = canopen::decode_heartbeat(frame)) {
    node.state = heartbeat->state;
    if (heartbeat->state == canopen::NmtState::boot_up) {
      node.state = canopen::NmtState::pre_operational;  // which it has entered (CiA 301, figure 48)
      node.current_limit.reset();
      has_limit_.reset(number);
      lacks_touch_.reset(number);
    }
  } else if (const auto emergency = canopen::decode_emergency(frame)) {
    if (emergency->code != canopen::EmergencyCode::none) {
      node.last_emergency = emergency;
    }
  } else if (const auto measured = canopen::decode_monitoring(frame)) {
    node.current_ma = measured->current_ma;
    node.temperature_c = measured->temperature_c;
    node.error_register = measured->faults;
    if (measured->angle != canopen::Monitoring::not_measured) {
      node.position = std::int32_t{measured->angle} * (1 << 16);  // newer than what was read
    }
  } else if (identifier::base_of(frame.identifier) == identifier::state_frame) {
    if (const auto state = canopen::decode_state(frame)) {
      node.contacts = static_cast<std::uint8_t>(state->flags() & StateFrame::contact_bits);
    }
  } else if (identifier::base_of(frame.identifier) != identifier::sdo_answer) {
    readings_.receive(now, frame);
    return;  // this is a request to the node, not an answer
  }
  node.last_heard = now;
  readings_.receive(now, frame);
}

void BusMonitor::transmitted(Microseconds now, const CanFrame& frame) {
  count(frame);
  readings_.transmitted(now, frame);
}

std::size_t BusMonitor::heard_nodes() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(nodes_, [](const MonitoredNode& node) { return node.last_heard != 0; }));
}

bool BusMonitor::is_silent(const MonitoredNode& node, Microseconds now) const {
  constexpr Microseconds silent_us = 3'000'000;  // longer than the time between two readings of the largest robot
  return node.last_heard == 0 || node.last_heard + silent_us < now;
}

void BusMonitor::forget_silent(Microseconds now) {
  for (MonitoredNode& node : nodes_) {
    if (is_silent(node, now)) {
      const std::uint8_t number = node.node;
      node = {};
      node.node = number;
    }
  }
}

void BusMonitor::read_touch(Microseconds now) {
  for (MonitoredNode& node : nodes_) {
    if (is_silent(node, now) || lacks_touch_.test(node.node)) {
      continue;
    }
    readings_.read(node.node, canopen::object::touch_sensors.address, [this, &node](const SdoResult& result) {
      lacks_touch_.set(node.node, !result.is_good() && result.abort_code != canopen::AbortCode::timeout);
      if (result.is_good()) {
        node.contacts = static_cast<std::uint8_t>(result.number() & StateFrame::contact_bits);
      }
    });
  }
}

void BusMonitor::read_values(Microseconds now) {
  for (MonitoredNode& node : nodes_) {
    if (is_silent(node, now)) {
      continue;
    }
    if (!has_limit_.test(node.node)) {
      read_limit(node);  // first: what is behind a reading without an answer is not made
    }
    readings_.read(node.node, canopen::object::position_demand.address, [&node](const SdoResult& result) {
      node.setpoint = result.is_good() ? std::optional(static_cast<std::int32_t>(result.number())) : std::nullopt;
    });
    readings_.read(node.node, canopen::object::actual_position.address, [&node](const SdoResult& result) {
      const auto position = static_cast<std::int32_t>(result.number());
      const bool is_measured = result.is_good() && position != canopen::position_not_measured;
      node.position = is_measured ? std::optional(position) : std::nullopt;
    });
    readings_.read(node.node, canopen::object::statusword.address, [&node](const SdoResult& result) {
      node.statusword = result.is_good() ? std::optional(static_cast<std::uint16_t>(result.number())) : std::nullopt;
    });
    const auto read = [this, &node](const canopen::Object& object, auto take) {
      readings_.read(node.node, object.address, [object, take](const SdoResult& result) {
        if (result.is_good()) {
          take(canopen::extend(object.type, result.number()));
        }
      });
    };
    read(canopen::object::actual_current,
         [&node](std::uint32_t number) { node.current_ma = static_cast<std::int32_t>(number); });
    read(canopen::object::temperature,
         [&node](std::uint32_t number) { node.temperature_c = static_cast<std::int32_t>(number); });
    read(canopen::object::error_register,
         [&node](std::uint32_t number) { node.error_register = static_cast<std::uint8_t>(number); });
  }
}

void BusMonitor::read_limit(MonitoredNode& node) {
  readings_.read(node.node, canopen::object::current_limit.address, [this, &node](const SdoResult& result) {
    has_limit_.set(node.node, result.abort_code != canopen::AbortCode::timeout);
    node.current_limit = result.is_good() ? std::optional(static_cast<std::uint16_t>(result.number())) : std::nullopt;
  });
}

void BusMonitor::poll(Microseconds now) {
  // An answer and its request take 0.26 ms of the bus; six values of a module are read.
  constexpr Microseconds touch_share_us = 4'000;
  constexpr Microseconds reading_share_us = 16'000;
  const bool may_read = reads_ && readings_.is_idle();
  if (now >= next_touch_) {
    next_touch_ = now + std::max(touch_period_us, heard_nodes() * touch_share_us);
    if (may_read && reads_touch_) {
      read_touch(now);
    }
  }
  if (now >= next_reading_) {
    next_reading_ = now + std::max(reading_period_us, heard_nodes() * reading_share_us);
    traffic_from_ = traffic_from_ == 0 ? now : traffic_from_;
    if (may_read) {
      read_values(now);
    }
  }
  readings_.poll(now);
}

Microseconds BusMonitor::next_deadline() const {
  const Microseconds next_touch = reads_touch_ ? next_touch_ : never;
  return std::min(std::min(next_reading_, next_touch), readings_.next_deadline());
}

std::vector<MonitoredNode> BusMonitor::nodes() const {
  std::vector<MonitoredNode> heard;
  std::ranges::copy_if(nodes_, std::back_inserter(heard),
                       [](const MonitoredNode& node) { return node.last_heard != 0; });
  return heard;
}

BusMonitor::Traffic BusMonitor::take_traffic(Microseconds now) {
  const double seconds = static_cast<double>(now - traffic_from_) * 1e-6;
  const Traffic traffic{syncs_, frames_, seconds > 0 ? std::min(1.0, bits_ / bus_bit_rate / seconds) : 0.0};
  traffic_from_ = now;
  syncs_ = 0;
  frames_ = 0;
  bits_ = 0;
  return traffic;
}

}  // namespace proleg::host
