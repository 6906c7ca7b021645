#include "host/robot/bus_examination.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "host/robot/frame_load.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/image/board_names.hpp"

namespace proleg::host {
namespace {

namespace object = canopen::object;

constexpr unsigned attempts = 4;
constexpr Microseconds answer_timeout_us = 60'000;
constexpr std::uint8_t read_errors = 4;  // number of the newest entries of 0x1003 that are read
constexpr double microseconds_per_second = 1e6;

BusScanOptions scan_options() {
  BusScanOptions options;
  options.attempts = attempts;
  options.answer_timeout_us = answer_timeout_us;
  return options;
}

canopen::SdoTransferOptions reading_options() {
  canopen::SdoTransferOptions options;
  options.timeout_us = answer_timeout_us;
  options.attempts = attempts;
  return options;
}

}  // namespace

BusExamination::BusExamination(CanPort& port, ReadOwnEnd read_own_end, const BusExaminationOptions& options)
    : read_own_end_(std::move(read_own_end)),
      options_(options),
      scan_(port, scan_options()),
      readings_(port, reading_options()),
      silent_(port),
      bits_(CanFrame::max_identifier + std::size_t{1}) {}

void BusExamination::start(Microseconds now) {
  step_ = Step::listening;
  started_ = now;
  listening_until_ = now + options_.listening_us;
  first_ = read_own_end_();
  last_controller_state_ = first_.state.controller.state;
}

OwnEnd BusExamination::watch_own_end() {
  OwnEnd own = read_own_end_();
  // An old state counts only if it stays, or returns.
  const CanState state = own.state.controller.state;
  if (state != last_controller_state_ || step_ == Step::done) {
    observations_.worst_controller_state = std::max(observations_.worst_controller_state, state);
  }
  last_controller_state_ = state;
  return own;
}

void BusExamination::receive(Microseconds now, const CanFrame& frame) {
  if (step_ == Step::idle || is_done()) {
    return;
  }
  if (step_ == Step::listening && now < listening_until_) {
    listen(frame);
  }
  note_node(now, frame);
  scan_.receive(now, frame);
  readings_.receive(now, frame);
  silent_.receive(now, frame);
  proceed(now);
}

void BusExamination::transmitted(Microseconds now, const CanFrame& frame) {
  ++transmitted_;
  (void)watch_own_end();
  scan_.transmitted(now, frame);
  readings_.transmitted(now, frame);
  silent_.transmitted(now, frame);
}

void BusExamination::listen(const CanFrame& frame) {
  ++observations_.frames;
  bits_.at(frame.identifier) += average_bits(frame);
  if (const auto counter = canopen::decode_sync(frame)) {
    note_sync(*counter);
  } else if (frame.identifier == canopen::identifier::sync) {
    ++observations_.foreign_syncs;
  } else if (const auto heartbeat = canopen::decode_heartbeat(frame)) {
    observations_.host_heartbeats += heartbeat->node == canopen::host_node ? 1U : 0U;
  }
}

void BusExamination::note_sync(std::uint8_t counter) {
  ++observations_.syncs;
  if (sync_counter_) {
    // An adapter that loses frames makes the counter skip forwards. It causes no counter that stays or steps
    // backwards.
    const unsigned step = (unsigned{counter} + canopen::sync_counters - *sync_counter_) % canopen::sync_counters;
    observations_.sync_jumps += step == 0 || step > canopen::sync_counters / 2 ? 1U : 0U;
  }
  sync_counter_ = counter;
}

void BusExamination::note_node(Microseconds now, const CanFrame& frame) {
  if (const auto heartbeat = canopen::decode_heartbeat(frame); heartbeat && heartbeat->node != canopen::host_node) {
    ObservedNode& node = nodes_.at(heartbeat->node);
    node.node = heartbeat->node;
    node.state = heartbeat->state;
    if (heartbeat->state == canopen::NmtState::boot_up) {
      ++node.boot_ups;
      node.state.reset();  // the state after the boot-up is not known
      if (step_ == Step::listening) {
        listening_until_ = std::max(
            listening_until_, std::min(now + options_.after_boot_up_us, started_ + options_.longest_listening_us));
      }
    }
  } else if (const auto emergency = canopen::decode_emergency(frame);
             emergency && emergency->node >= canopen::min_node_id && emergency->node <= canopen::max_node_id) {
    ObservedNode& node = nodes_.at(emergency->node);
    node.node = emergency->node;
    if (emergency->code != canopen::EmergencyCode::none &&
        std::ranges::find(node.emergencies, emergency->code) == node.emergencies.end()) {
      node.emergencies.push_back(emergency->code);
    }
  }
}

void BusExamination::poll(Microseconds now) {
  if (step_ == Step::idle || is_done()) {
    return;
  }
  for (BusUser* user :
       {static_cast<BusUser*>(&scan_), static_cast<BusUser*>(&readings_), static_cast<BusUser*>(&silent_)}) {
    if (user->next_deadline() <= now) {
      user->poll(now);
    }
  }
  if (const OwnEnd own = watch_own_end(); step_ != Step::listening && !own.state.is_connected) {
    finish(false);
    return;
  }
  proceed(now);
}

void BusExamination::proceed(Microseconds now) {
  if (step_ == Step::listening && now >= listening_until_) {
    end_listening(now);
    return;
  }
  if (step_ != Step::listening && is_given_up(now)) {
    finish(false);
  } else if (step_ == Step::scanning && scan_.is_done()) {
    read_details(now);
  } else if (step_ == Step::reading && readings_.is_idle()) {
    search(now);
  } else if (step_ == Step::searching && silent_.is_done()) {
    finish(true);
  }
}

bool BusExamination::is_given_up(Microseconds now) const {
  return (transmitted_ == 0 && now >= asked_ + options_.send_timeout_us) || now >= asked_ + options_.longest_asking_us;
}

void BusExamination::end_listening(Microseconds now) {
  const OwnEnd own = watch_own_end();
  observations_.listened_us = now - started_;
  observations_.errors = own.state.bus_errors - first_.state.bus_errors;
  const double bits = bus_bit_rate * static_cast<double>(observations_.listened_us) / microseconds_per_second;
  const auto busiest = std::ranges::max_element(bits_);
  observations_.busiest_identifier = static_cast<std::uint16_t>(busiest - bits_.begin());
  observations_.busiest_load = std::min(1.0, *busiest / bits);
  observations_.load = std::min(1.0, std::accumulate(bits_.begin(), bits_.end(), 0.0) / bits);
  // Requests at a bit rate that differs from that of the other nodes destroy their frames.
  const bool is_foreign_bit_rate = observations_.frames == 0 && observations_.errors > 0;
  if (is_foreign_bit_rate || !own.state.is_connected) {
    finish(true);
    return;
  }
  observations_.was_asked = true;
  step_ = Step::scanning;
  asked_ = now;
  scan_.start(now);
}

void BusExamination::read_details(Microseconds now) {
  step_ = Step::reading;
  for (const ScannedNode& scanned : scan_.nodes()) {
    ObservedNode& node = nodes_.at(scanned.node);
    node.node = scanned.node;
    if (!scanned.has_answered) {
      continue;
    }
    node.answers = scanned;
    if (!scanned.is_module) {
      continue;
    }
    readings_.read(scanned.node, object::sync_identifier.address, [&node](const SdoResult& result) {
      node.produces_sync = result.is_good() && (result.number() & canopen::produces_sync) != 0;
    });
    readings_.read(scanned.node, object::capabilities.address, [&node](const SdoResult& result) {
      node.has_brown_out_reset = !result.is_good() || (result.number() & canopen::has_brown_out_reset) != 0;
      node.has_current_sensor = !result.is_good() || (result.number() & canopen::has_no_current_sensor) == 0;
    });
    readings_.read(scanned.node, object::error_count.address, [this, &node](const SdoResult& result) {
      const std::uint32_t count = result.is_good() ? result.number() : 0;
      for (std::uint8_t i = 1; i <= std::min<std::uint32_t>(count, read_errors); ++i) {
        readings_.read(node.node, object::error_history.at(i), [&node](const SdoResult& error) {
          if (error.is_good()) {
            node.past_errors.push_back(static_cast<canopen::EmergencyCode>(error.number() & 0xFFFFU));
          }
        });
      }
    });
  }
  readings_.poll(now);
  proceed(now);
}

void BusExamination::search(Microseconds now) {
  step_ = Step::searching;
  // An LSS master of another host would receive the answers, and a robot that moves has priority.
  if (observations_.host_heartbeats > 0 || scan_.has_host() || observations_.syncs > 0 || scan_.syncs() > 0) {
    finish(true);
    return;
  }
  std::vector<std::uint32_t> products;
  products.reserve(image::board_names.size());
  for (const image::BoardName& board : image::board_names) {
    products.push_back(board.id);
  }
  std::vector<std::uint32_t> known;
  for (const ScannedNode& node : scan_.nodes()) {
    if (!node.is_module) {
      continue;
    }
    if (std::ranges::find(products, node.product) == products.end()) {
      products.push_back(node.product);
    }
    known.push_back(node.serial);
  }
  silent_.start(now, object::vendor.default_value, std::move(products), std::move(known));
  proceed(now);
}

void BusExamination::finish(bool is_complete) {
  step_ = Step::done;
  observations_.is_complete = is_complete;
  observations_.has_fresh_modules = scan_.has_fresh_modules();
  observations_.silent_modules = silent_.found();
  OwnEnd& own = observations_.own;
  own = watch_own_end();
  own.state.bus_errors -= first_.state.bus_errors;
  own.statistics.received -= first_.statistics.received;
  own.statistics.transmitted -= first_.statistics.transmitted;
  own.statistics.malformed -= first_.statistics.malformed;
  for (const ObservedNode& node : nodes_) {
    if (node.node != 0) {
      observations_.nodes.push_back(node);
    }
  }
}

Microseconds BusExamination::next_deadline() const {
  switch (step_) {
    case Step::idle:
    case Step::done:
      return never;
    case Step::listening:
      return listening_until_;
    default:
      break;
  }
  const Microseconds limit = transmitted_ == 0 ? options_.send_timeout_us : options_.longest_asking_us;
  return std::min({scan_.next_deadline(), readings_.next_deadline(), silent_.next_deadline(), asked_ + limit});
}

}  // namespace proleg::host
