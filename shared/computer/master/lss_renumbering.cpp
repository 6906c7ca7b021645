#include "shared/computer/master/lss_renumbering.hpp"

#include <algorithm>

namespace proleg::canopen {

using lss::Service;

namespace {

/// Number of frames that release modules: one of them may be lost.
constexpr unsigned releases = 2;

}  // namespace

void LssRenumbering::start(Microseconds now) {
  if (state_ != State::idle) {
    return;
  }
  if (modules_.empty()) {
    state_ = State::done;
    return;
  }
  state_ = State::working;
  send(now, Step::release);
}

void LssRenumbering::send(Microseconds now, Step step) {
  step_ = step;
  switch (step) {
    case Step::release:
    case Step::release_all:
      exchange_.begin(now, lss_release_request());
      break;
    case Step::select:
      select(now);
      break;
    case Step::probe:
      exchange_.begin(now, lss::make(identifier::lss_request, Service::inquire_node_id),
                      LssExchange::of(Service::inquire_node_id), options_.silence_us);
      break;
    case Step::configure:
      exchange_.begin(now, lss::make(identifier::lss_request, Service::configure_node_id, modules_[position_].node),
                      LssExchange::of(Service::configure_node_id), options_.answer_timeout_us);
      break;
    case Step::store:
      exchange_.begin(now, lss::make(identifier::lss_request, Service::store_configuration),
                      LssExchange::of(Service::store_configuration), options_.store_timeout_us);
      break;
    case Step::reset:
      exchange_.begin(now, encode(NmtRequest{NmtCommand::reset_node, node_to_reset()}), {}, options_.boot_timeout_us);
      break;
  }
}

/// The node id that the reset is sent to. At another attempt the module may have its new node id already, if its
/// boot-up message was lost.
std::uint8_t LssRenumbering::node_to_reset() const {
  return options_.reset_node != 0 && tries_ % 2 == 0 ? modules_[position_].node : options_.reset_node;
}

/// Sends the next number of the address. The module answers the last one.
void LssRenumbering::select(Microseconds now) {
  const LssAddress& address = modules_[position_].address;
  const CanFrame request = lss::make_word(
      identifier::lss_request, static_cast<Service>(static_cast<std::uint8_t>(Service::select_vendor) + number_),
      address.at(number_));
  if (number_ + 1U < address.size()) {
    exchange_.begin(now, request);
  } else {
    exchange_.begin(now, request, LssExchange::of(Service::selected), options_.answer_timeout_us);
  }
}

void LssRenumbering::receive(Microseconds now, const CanFrame& frame) {
  if (state_ != State::working) {
    return;
  }
  exchange_.receive(now, frame);
  const auto heartbeat = decode_heartbeat(frame);
  if (step_ != Step::reset || !heartbeat || heartbeat->state != NmtState::boot_up) {
    return;
  }
  const auto module = std::ranges::find(modules_, heartbeat->node, &RenumberedModule::node);
  if (module != modules_.end()) {
    module->has_booted = true;
  }
}

void LssRenumbering::poll(Microseconds now) {
  if (state_ != State::working || !exchange_.has_ended(now)) {
    return;
  }
  if (!exchange_.is_sent()) {
    fail(LssProblem::not_sent, 0);
    return;
  }
  conclude(now);
}

void LssRenumbering::conclude(Microseconds now) {
  const bool is_answered = exchange_.is_answered();
  const auto no_answer = [&](Service service) {
    repeat_or_fail(now, Step::release, LssProblem::no_answer, static_cast<std::uint8_t>(service));
  };
  switch (step_) {
    case Step::release:
      if (++releases_ < releases) {
        send(now, Step::release);
        break;
      }
      releases_ = 0;
      send(now, Step::probe);
      break;
    case Step::probe:
      if (is_answered) {
        repeat_or_fail(now, Step::release, LssProblem::not_released, 0);
        break;
      }
      number_ = 0;
      send(now, Step::select);
      break;
    case Step::select:
      if (number_ + 1U < LssAddress().size()) {
        ++number_;
        send(now, Step::select);
      } else if (is_answered) {
        send(now, Step::configure);
      } else {
        no_answer(Service::select_serial);
      }
      break;
    case Step::configure:
      if (!is_answered) {
        no_answer(Service::configure_node_id);
      } else if (exchange_.error() != lss::ok) {
        fail(LssProblem::node_refused, exchange_.error());
      } else {
        send(now, Step::store);
      }
      break;
    case Step::store:
      if (!is_answered) {
        no_answer(Service::store_configuration);
      } else if (exchange_.error() != lss::ok) {
        fail(LssProblem::store_refused, exchange_.error());
      } else {
        modules_[position_].has_stored = true;
        next_module(now);
      }
      break;
    case Step::release_all:
      tries_ = 1;
      send(now, Step::reset);
      break;
    case Step::reset:
      if (const std::size_t missing = first_missing(); missing == modules_.size()) {
        state_ = State::done;
        exchange_.cancel();
      } else {
        position_ = missing;
        repeat_or_fail(now, Step::reset, LssProblem::no_boot_up, modules_[position_].node);
      }
      break;
  }
}

void LssRenumbering::next_module(Microseconds now) {
  tries_ = 1;
  if (position_ + 1 < modules_.size()) {
    ++position_;
    send(now, Step::release);
  } else {
    send(now, Step::release_all);
  }
}

void LssRenumbering::repeat_or_fail(Microseconds now, Step first, LssProblem problem, std::uint8_t detail) {
  if (tries_ < options_.attempts) {
    ++tries_;
    send(now, first);
  } else {
    fail(problem, detail);
  }
}

/// The first module that has not booted with its last node id.
std::size_t LssRenumbering::first_missing() const {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    const bool has_another = std::ranges::any_of(
        modules_.subspan(i + 1), [&](const RenumberedModule& later) { return later.address == modules_[i].address; });
    if (modules_[i].is_awaited && !modules_[i].has_booted && !has_another) {
      return i;
    }
  }
  return modules_.size();
}

void LssRenumbering::fail(LssProblem problem, std::uint8_t detail) {
  state_ = State::failed;
  problem_ = problem;
  problem_detail_ = detail;
  exchange_.cancel_and_release();
}

}  // namespace proleg::canopen
