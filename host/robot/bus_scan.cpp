#include "host/robot/bus_scan.hpp"

#include <algorithm>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/lss_frame.hpp"

namespace proleg::host {
namespace {

namespace object = canopen::object;

canopen::SdoTransferOptions transfer_options(const BusScanOptions& options, unsigned attempts) {
  canopen::SdoTransferOptions transfer;
  transfer.timeout_us = options.answer_timeout_us;
  transfer.attempts = attempts;
  return transfer;
}

}  // namespace

BusScan::BusScan(CanPort& port, const BusScanOptions& options)
    : port_(port),
      options_(options),
      probes_(port, transfer_options(options, options.attempts)),
      inquiries_(port, transfer_options(options, options.further_attempts)) {}

void BusScan::start(Microseconds now) {
  is_started_ = true;
  fresh_at_ = now;
  listening_until_ = now + options_.listening_us;
  for (std::uint8_t node = canopen::min_node_id; node <= canopen::max_node_id; ++node) {
    probe(node);
  }
  poll(now);
}

void BusScan::probe(std::uint8_t node) {
  seen_.at(node).info.node = node;
  ask(probes_, node);
}

void BusScan::ask(SdoQueue& queue, std::uint8_t node) {
  queue.read(node, object::device_type.address, [this, node](const SdoResult& result) {
    Seen& seen = seen_.at(node);
    if (!result.is_good()) {
      return;
    }
    note_attempts(result);
    seen.is_heard = true;
    seen.info.has_answered = true;
    seen.info.device_type = result.number();
    inquire(node);
  });
}

void BusScan::ask_fresh(Microseconds now) {
  constexpr Microseconds until_port_has_room = 1'000;
  if (!port_.send(
          canopen::lss::make(canopen::identifier::lss_request, canopen::lss::Service::identify_non_configured))) {
    fresh_at_ = now + until_port_has_room;
    return;
  }
  ++fresh_requests_;
  fresh_at_ = fresh_requests_ < options_.fresh_attempts ? now + options_.listening_us / options_.fresh_attempts : never;
}

void BusScan::read_number(std::uint8_t node, canopen::Address address, const std::function<void(std::uint32_t)>& take) {
  inquiries_.read(node, address, [this, take](const SdoResult& result) {
    if (result.is_good()) {
      note_attempts(result);
      take(result.number());
    }
  });
}

void BusScan::inquire(std::uint8_t node) {
  ScannedNode& info = seen_.at(node).info;
  read_number(node, object::error_register.address,
              [&info](std::uint32_t value) { info.error_register = static_cast<std::uint8_t>(value); });
  read_number(node, object::product.address, [&info](std::uint32_t value) { info.product = value; });
  read_number(node, object::revision.address, [&info](std::uint32_t value) { info.revision = value; });
  read_number(node, object::serial.address, [&info](std::uint32_t value) { info.serial = value; });
  read_number(node, object::vendor.address, [this, &info, node](std::uint32_t value) {
    info.vendor = value;
    if (value != object::vendor.default_value) {
      return;  // another manufacturer's objects above 0x2000 mean something else
    }
    info.is_module = true;
    read_number(node, object::version.address,
                [&info](std::uint32_t number) { info.protocol = static_cast<std::uint16_t>(number); });
    read_number(node, object::core_fingerprint.address,
                [&info](std::uint32_t number) { info.core_fingerprint = number; });
    read_number(node, object::update_key.address, [&info](std::uint32_t number) { info.update_key = number; });
    read_number(node, object::statusword.address,
                [&info](std::uint32_t number) { info.statusword = static_cast<std::uint16_t>(number); });
    read_number(node, object::activate.address, [this, &info, node](std::uint32_t is_active) {
      if (is_active != 0) {
        read_number(node, object::joint_index.address,
                    [&info](std::uint32_t number) { info.joint = static_cast<std::uint8_t>(number); });
      }
    });
  });
}

void BusScan::inquire_texts(std::uint8_t node) {
  read_text(node, object::device_name.address, &ScannedNode::name);
  read_text(node, object::hardware_version.address, &ScannedNode::hardware);
  read_text(node, object::software_version.address, &ScannedNode::software);
}

void BusScan::read_text(std::uint8_t node, canopen::Address address, std::string ScannedNode::*field) {
  inquiries_.read(node, address, [this, node, field](const SdoResult& result) {
    if (result.is_good()) {
      std::string& text = seen_.at(node).info.*field;
      for (const std::uint8_t byte : result.value) {
        const bool is_printable = byte >= 0x20 && byte < 0x7F;
        text += is_printable ? static_cast<char>(byte) : '?';
      }
    }
  });
}

void BusScan::receive(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  if (!is_started_ || is_done_) {
    return;
  }
  ++frames_;
  if (canopen::decode_sync(frame)) {
    ++syncs_;
  } else if (frame.identifier == identifier::lss_answer && frame.length == 8 &&
             canopen::lss::service_of(frame) == canopen::lss::Service::identified_non_configured) {
    has_fresh_ = true;
    fresh_at_ = never;
  } else if (const auto heartbeat = canopen::decode_heartbeat(frame)) {
    if (heartbeat->node == canopen::host_node) {
      has_host_ = true;
    } else {
      seen_.at(heartbeat->node).is_heard = true;
      seen_.at(heartbeat->node).info.node = heartbeat->node;
      seen_.at(heartbeat->node).info.state = heartbeat->state;
    }
  } else if (const auto emergency = canopen::decode_emergency(frame); emergency && emergency->node < seen_.size()) {
    Seen& seen = seen_.at(emergency->node);
    seen.is_heard = true;
    seen.info.node = emergency->node;
    seen.is_duplicate = seen.is_duplicate || emergency->code == canopen::EmergencyCode::identifier_collision;
  }
  const std::uint8_t node = identifier::node_of(frame.identifier);
  if (identifier::base_of(frame.identifier) == identifier::sdo_answer && node >= canopen::min_node_id &&
      node <= canopen::max_node_id) {
    seen_.at(node).is_heard = true;  // a late answer counts, too
  }
  probes_.receive(now, frame);
  inquiries_.receive(now, frame);
  finish(now);
}

void BusScan::transmitted(Microseconds now, const CanFrame& frame) {
  probes_.transmitted(now, frame);
  inquiries_.transmitted(now, frame);
}

void BusScan::poll(Microseconds now) {
  if (!is_started_ || is_done_) {
    return;
  }
  if (now >= fresh_at_) {
    ask_fresh(now);
  }
  probes_.poll(now);
  inquiries_.poll(now);
  finish(now);
}

void BusScan::note_attempts(const SdoResult& result) { is_losing_ = is_losing_ || result.attempts > 1; }

/// Whether requests to the node ids from which nothing was received are under way again: on a bus that loses frames,
/// and if no node has answered, the first ones may be lost.
bool BusScan::probes_again(Microseconds now) {
  const bool has_answer = std::ranges::any_of(seen_, [](const Seen& seen) { return seen.info.has_answered; });
  if (rounds_ == options_.rounds || (has_answer && !is_losing_)) {
    return false;
  }
  ++rounds_;
  for (std::uint8_t node = canopen::min_node_id; node <= canopen::max_node_id; ++node) {
    if (!seen_.at(node).is_heard) {
      ask(probes_, node);
    }
  }
  probes_.poll(now);
  return true;
}

void BusScan::finish(Microseconds now) {
  if (now >= listening_until_) {
    listening_until_ = never;
    has_listened_ = true;
  }
  if (!has_listened_ || !probes_.is_idle() || !inquiries_.is_idle()) {
    return;
  }
  if (probes_again(now)) {
    return;
  }
  // A present node that has not answered may only be slow, or this computer is.
  if (!has_asked_again_) {
    has_asked_again_ = true;
    for (std::uint8_t node = canopen::min_node_id; node <= canopen::max_node_id; ++node) {
      if (seen_.at(node).is_heard && !seen_.at(node).info.has_answered) {
        ask(inquiries_, node);
      }
    }
    inquiries_.poll(now);
    if (!inquiries_.is_idle()) {
      return;
    }
  }
  // Texts travel in segments, which the requests of a host that drives the robot would break.
  if (!reads_texts_ && !has_host_) {
    reads_texts_ = true;
    for (std::uint8_t node = canopen::min_node_id; node <= canopen::max_node_id; ++node) {
      if (seen_.at(node).info.has_answered) {
        inquire_texts(node);
      }
    }
    inquiries_.poll(now);
    if (!inquiries_.is_idle()) {
      return;
    }
  }
  is_done_ = true;
}

Microseconds BusScan::next_deadline() const {
  if (!is_started_ || is_done_) {
    return never;
  }
  return std::min({probes_.next_deadline(), inquiries_.next_deadline(), listening_until_, fresh_at_});
}

std::vector<ScannedNode> BusScan::nodes() const {
  std::vector<ScannedNode> nodes;
  for (const Seen& seen : seen_) {
    if (seen.is_heard) {
      nodes.push_back(seen.info);
    }
  }
  return nodes;
}

std::vector<std::uint8_t> BusScan::duplicates() const {
  std::vector<std::uint8_t> nodes;
  for (const Seen& seen : seen_) {
    if (seen.is_duplicate) {
      nodes.push_back(seen.info.node);
    }
  }
  return nodes;
}

}  // namespace proleg::host
