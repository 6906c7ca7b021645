#include "shared/master/lss_master.hpp"

namespace proleg::canopen {

using lss::Service;

namespace {

constexpr std::uint8_t highest_bit = 31;

}  // namespace

std::string_view describe(LssProblem problem) {
  switch (problem) {
    case LssProblem::none:
      return "no problem";
    case LssProblem::not_sent:
      return "no node acknowledges frames";
    case LssProblem::scan_failed:
      return "a module stopped answering during Fastscan";
    case LssProblem::unexpected_module:
      return "a module without a node id is not in the list";
    case LssProblem::no_answer:
      return "the module does not answer";
    case LssProblem::node_refused:
      return "the module refuses the node id";
    case LssProblem::store_refused:
      return "the module does not store the node id";
    case LssProblem::no_boot_up:
      return "the module does not boot with its node id";
  }
  return "unknown problem";
}

void LssMaster::start(Microseconds now) {
  if (state_ == State::idle) {
    state_ = State::working;
    send(now, Step::release_all);
  }
}

void LssMaster::send(Microseconds now, Step step) {
  step_ = step;
  is_pending_ = true;
  is_transmitted_ = false;
  is_answered_ = false;
  error_ = lss::ok;
  deadline_ = now + options_.send_timeout_us;
  hand_over();
}

void LssMaster::hand_over() {
  if (is_pending_ && port_.send(request())) {
    is_pending_ = false;
  }
}

CanFrame LssMaster::request() const {
  constexpr std::uint16_t identifier = identifier::lss_request;
  const auto next_number = static_cast<std::uint8_t>((sub_ + 1U) % address_.size());
  switch (step_) {
    case Step::begin:
      return encode(lss::FastscanRequest{0, lss::fastscan_start, 0, 0});
    case Step::guess:
    case Step::verify:
      return encode(lss::FastscanRequest{number_, 0, sub_, next_number});
    case Step::bit:
      return encode(lss::FastscanRequest{number_, bit_, sub_, sub_});
    case Step::configure:
      return lss::make(identifier, Service::configure_node_id, module_->node);
    case Step::store:
      return lss::make(identifier, Service::store_configuration);
    case Step::release_all:
    case Step::release:
      break;
  }
  return lss::make(identifier, Service::switch_state_global, static_cast<std::uint8_t>(lss::State::waiting));
}

Service LssMaster::expected_answer() const {
  switch (step_) {
    case Step::configure:
      return Service::configure_node_id;
    case Step::store:
      return Service::store_configuration;
    default:
      return Service::identified;
  }
}

Microseconds LssMaster::timeout() const {
  switch (step_) {
    case Step::release_all:
      return 0;  // it has no answer
    case Step::store:
      return options_.store_timeout_us;
    case Step::release:
      return options_.boot_timeout_us;
    default:
      return options_.answer_timeout_us;
  }
}

void LssMaster::receive(Microseconds now, const CanFrame& frame) {
  // An adapter may report an answer before it reports that the request was sent.
  if (state_ != State::working || is_pending_) {
    return;
  }
  if (step_ == Step::release) {
    if (frame == encode(Heartbeat{module_->node, NmtState::boot_up})) {
      is_transmitted_ = true;
      is_answered_ = true;
      deadline_ = now;
    }
    return;
  }
  if (frame.identifier == identifier::lss_answer && frame.length == CanFrame::max_length &&
      lss::service_of(frame) == expected_answer()) {
    error_ = is_answered_ && error_ != lss::ok ? error_ : frame.data[1];
    is_transmitted_ = true;
    is_answered_ = true;
    deadline_ = now + options_.settle_us;
  }
}

void LssMaster::transmitted(Microseconds now, const CanFrame& frame) {
  if (state_ != State::working) {
    return;
  }
  if (is_pending_) {
    hand_over();
  } else if (!is_transmitted_ && frame == request()) {
    is_transmitted_ = true;
    deadline_ = now + timeout();
  }
}

void LssMaster::poll(Microseconds now) {
  if (state_ != State::working || now < deadline_) {
    return;
  }
  if (!is_transmitted_) {
    fail(LssProblem::not_sent);
    return;
  }
  conclude(now);
}

/// The answers to the request have come, or none.
void LssMaster::conclude(Microseconds now) {
  switch (step_) {
    case Step::release_all:
      send(now, Step::begin);
      return;
    case Step::begin:
      if (is_answered_) {
        sub_ = 0;
        scan_number(now);
      } else {
        state_ = State::done;
        deadline_ = never;
      }
      return;
    case Step::guess:
      if (is_answered_) {
        finish_number(now);
      } else {
        number_ = 0;
        bit_ = highest_bit;
        send(now, Step::bit);
      }
      return;
    case Step::bit:
      number_ |= is_answered_ ? 0U : std::uint32_t{1} << bit_;
      if (bit_ == 0) {
        send(now, Step::verify);
      } else {
        --bit_;
        send(now, Step::bit);
      }
      return;
    case Step::verify:
      if (is_answered_) {
        finish_number(now);
      } else {
        repeat_scan(now);
      }
      return;
    case Step::configure:
      finish(now, Service::configure_node_id, LssProblem::node_refused, options_.stores ? Step::store : Step::release);
      return;
    case Step::store:
      finish(now, Service::store_configuration, LssProblem::store_refused, Step::release);
      return;
    case Step::release:
      if (!is_answered_) {
        fail(LssProblem::no_boot_up, module_->node);
        return;
      }
      module_->has_booted = true;
      ++assigned_;
      scans_ = 0;
      send(now, Step::begin);
      return;
  }
}

void LssMaster::scan_number(Microseconds now) {
  number_ = options_.usual[sub_];
  bit_ = highest_bit;
  send(now, number_ != 0 ? Step::guess : Step::bit);
}

void LssMaster::finish_number(Microseconds now) {
  address_[sub_] = number_;
  if (++sub_ < address_.size()) {
    scan_number(now);
  } else {
    assign(now);
  }
}

void LssMaster::repeat_scan(Microseconds now) {
  if (++scans_ < max_scans) {
    send(now, Step::release_all);
  } else {
    fail(LssProblem::scan_failed, sub_);
  }
}

/// The module has selected itself.
void LssMaster::assign(Microseconds now) {
  module_ = find_entry();
  if (module_ == nullptr) {
    fail(LssProblem::unexpected_module);
    return;
  }
  module_->address = address_;
  send(now, Step::configure);
}

LssModule* LssMaster::find_entry() const {
  LssModule* free = nullptr;
  for (LssModule& entry : modules_) {
    if (entry.has_booted) {
      continue;
    }
    if (entry.serial != 0 && entry.serial == address_.back()) {
      return &entry;
    }
    if (entry.serial == 0 && free == nullptr) {
      free = &entry;
    }
  }
  return free;
}

void LssMaster::finish(Microseconds now, Service service, LssProblem refused, Step next) {
  if (!is_answered_) {
    fail(LssProblem::no_answer, static_cast<std::uint8_t>(service));
  } else if (error_ != lss::ok) {
    fail(refused, error_);
  } else {
    send(now, next);
  }
}

void LssMaster::fail(LssProblem problem, std::uint8_t detail) {
  state_ = State::failed;
  problem_ = problem;
  problem_detail_ = detail;
  deadline_ = never;
  // No module stays selected: it would be configured with the next one. If that is lost, the next start releases it.
  step_ = Step::release_all;
  static_cast<void>(port_.send(request()));
}

}  // namespace proleg::canopen
