#include "shared/computer/master/lss_master.hpp"

#include <algorithm>

namespace proleg::canopen {

using lss::Service;

namespace {

constexpr std::uint8_t highest_bit = 31;

}  // namespace

void LssExchange::begin(Microseconds now, const CanFrame& request, const Answer& answer, Microseconds wait_us) {
  request_ = request;
  answer_ = answer;
  wait_us_ = wait_us;
  is_pending_ = true;
  is_sent_ = false;
  is_answered_ = false;
  error_ = lss::ok;
  begun_ = now;
  deadline_ = now + send_timeout_us_;
  hand_over();
}

void LssExchange::cancel_and_release() {
  cancel();
  static_cast<void>(port_.send(lss_release_request()));
}

void LssExchange::hand_over() {
  if (is_pending_ && port_.send(request_)) {
    is_pending_ = false;
  }
}

void LssExchange::receive(Microseconds now, const CanFrame& frame) {
  // An adapter may report an answer before it reports that the request was sent.
  if (deadline_ == never || is_pending_ || answer_.length == 0) {
    return;
  }
  if (frame.identifier == answer_.identifier && frame.length == answer_.length && frame.data[0] == answer_.first_byte) {
    error_ = is_answered_ && error_ != lss::ok ? error_ : frame.data[1];
    answer_delay_ = is_answered_ ? answer_delay_ : now - begun_;
    is_sent_ = true;
    is_answered_ = true;
    deadline_ = now + settle_us_;
  }
}

void LssExchange::transmitted(Microseconds now, const CanFrame& frame) {
  if (deadline_ == never) {
    return;
  }
  if (is_pending_) {
    hand_over();
  } else if (!is_sent_ && frame == request_) {
    is_sent_ = true;
    deadline_ = now + wait_us_;
  }
}

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
    case LssProblem::not_released:
      return "another module stays selected";
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
  tries_ = 1;
  exchange(now);
}

void LssMaster::exchange(Microseconds now) {
  switch (step_) {
    case Step::release_all:
      exchange_.begin(now, lss_release_request());
      break;
    case Step::release:
      exchange_.begin(now, lss_release_request(), LssExchange::boot_up_of(module_->node), options_.boot_timeout_us);
      break;
    case Step::begin:
      exchange_.begin(now, request(), LssExchange::of(Service::identified), options_.first_answer_timeout_us);
      break;
    case Step::configure:
      exchange_.begin(now, request(), LssExchange::of(Service::configure_node_id), answer_time_us_);
      break;
    case Step::store:
      exchange_.begin(now, request(), LssExchange::of(Service::store_configuration), options_.store_timeout_us);
      break;
    default:
      exchange_.begin(now, request(), LssExchange::of(Service::identified), answer_time_us_);
      break;
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
  return lss_release_request();
}

/// Number of times that the present request is sent if there is no answer. A bit of an address without an answer is 1.
/// A bit is asked once in the first scan, since every second bit is 1. If the address is wrong, it is scanned again
/// with more attempts.
unsigned LssMaster::attempts() const { return step_ == Step::bit && scans_ == 0 ? 1 : options_.attempts; }

void LssMaster::receive(Microseconds now, const CanFrame& frame) { exchange_.receive(now, frame); }

void LssMaster::transmitted(Microseconds now, const CanFrame& frame) { exchange_.transmitted(now, frame); }

void LssMaster::poll(Microseconds now) {
  if (state_ != State::working || !exchange_.has_ended(now)) {
    return;
  }
  if (!exchange_.is_sent()) {
    fail(LssProblem::not_sent);
    return;
  }
  if (!exchange_.is_answered() && step_ != Step::release_all && tries_ < attempts()) {
    ++tries_;
    exchange(now);
    return;
  }
  conclude(now);
}

/// Ends the step: all answers to the request have come, or there is none.
void LssMaster::conclude(Microseconds now) {
  switch (step_) {
    case Step::release_all:
      send(now, Step::begin);
      return;
    case Step::begin:
      if (exchange_.is_answered()) {
        answer_time_us_ = std::max(3 * exchange_.answer_delay(), options_.answer_timeout_us);
        sub_ = 0;
        scan_number(now);
      } else {
        state_ = State::done;
        exchange_.cancel();
      }
      return;
    case Step::guess:
      if (exchange_.is_answered()) {
        finish_number(now);
      } else {
        number_ = 0;
        bit_ = highest_bit;
        send(now, Step::bit);
      }
      return;
    case Step::bit:
      number_ |= exchange_.is_answered() ? 0U : std::uint32_t{1} << bit_;
      if (bit_ == 0) {
        send(now, Step::verify);
      } else {
        --bit_;
        send(now, Step::bit);
      }
      return;
    case Step::verify:
      if (exchange_.is_answered()) {
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
      if (!exchange_.is_answered()) {
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

/// Gives a node id to the module, which has selected itself.
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
  if (!exchange_.is_answered()) {
    fail(LssProblem::no_answer, static_cast<std::uint8_t>(service));
  } else if (exchange_.error() != lss::ok) {
    fail(refused, exchange_.error());
  } else {
    send(now, next);
  }
}

void LssMaster::fail(LssProblem problem, std::uint8_t detail) {
  state_ = State::failed;
  problem_ = problem;
  problem_detail_ = detail;
  exchange_.cancel_and_release();
}

}  // namespace proleg::canopen
