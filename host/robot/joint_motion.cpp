#include "host/robot/joint_motion.hpp"

#include <algorithm>

#include "shared/canopen/declared_objects.hpp"
#include "shared/gait/registry.hpp"

namespace proleg::host {
namespace {

namespace object = canopen::object;

canopen::SdoTransferOptions transfer_options() {
  canopen::SdoTransferOptions options;
  options.timeout_us = patient_timeout_us;
  options.attempts = patient_attempts;
  return options;
}

const ActuationModule& sine() { return *find_algorithm("PatternGenerator_sinusoidal"); }

Setting start_value(std::string_view parameter, std::int32_t value) {
  return {0, 0, static_cast<std::uint8_t>(find_parameter(sine().declaration(), parameter)), false, value};
}

}  // namespace

JointMotion::JointMotion(CanPort& port, std::uint8_t node, const JointMotionOptions& options)
    : port_(port), nodes_{node}, options_(options), readings_(port, transfer_options()) {}

JointMotion::State JointMotion::state() const {
  if (!master_) {
    return state_;
  }
  switch (master_->state()) {
    case canopen::MasterState::running:
      return State::moving;
    case canopen::MasterState::stopping:
      return State::stopping;
    case canopen::MasterState::stopped:
      return State::stopped;
    case canopen::MasterState::failed:
      return State::failed;
    default:
      return State::starting;
  }
}

std::optional<canopen::Event> JointMotion::take_event() { return master_ ? master_->take_event() : std::nullopt; }

void JointMotion::start(Microseconds now) {
  if (state_ != State::idle) {
    return;
  }
  state_ = State::reading;
  read(object::lowest_position.address, lowest_);
  read(object::highest_position.address, highest_);
  read(object::actual_position.address, measured_);
  read(object::core_fingerprint.address, core_fingerprint_);
  readings_.poll(now);
}

void JointMotion::read(canopen::Address address, std::uint32_t& value) {
  readings_.read(nodes_[0], address, [this, address, &value](const SdoResult& result) {
    if (result.is_good()) {
      value = result.number();
    } else if (problem_.code == canopen::ProblemCode::none) {
      problem_.code = result.abort_code == canopen::AbortCode::timeout ? canopen::ProblemCode::no_answer
                                                                       : canopen::ProblemCode::refused;
      problem_.node = nodes_[0];
      problem_.address = address;
      problem_.abort_code = result.abort_code;
      state_ = State::failed;
    }
  });
}

/// Plans a motion that fits into the limits.
void JointMotion::plan() {
  const std::int32_t lower = std::max(static_cast<std::int32_t>(lowest_), options_.limits.lower);
  const std::int32_t upper = std::max(lower, std::min(static_cast<std::int32_t>(highest_), options_.limits.upper));
  const std::int64_t room = (std::int64_t{upper} - lower) / 2;
  amplitude_ = static_cast<std::int32_t>(std::min<std::int64_t>(options_.amplitude, room));
  const bool is_measured = measured_ != static_cast<std::uint32_t>(canopen::position_not_measured);
  center_ = std::clamp(is_measured ? static_cast<std::int32_t>(measured_) : 0, lower + amplitude_, upper - amplitude_);
  limits_[0] = {center_ - amplitude_, center_ + amplitude_};
}

void JointMotion::begin_motion(Microseconds now) {
  plan();
  start_values_ = {start_value("amplitude", amplitude_), start_value("frequency", raw(Unit::hertz, 1)),
                   start_value("offset", center_)};
  setup_.kernel.joint_count = 1;
  setup_.kernel.slots[0] = {&sine(), JointMask::first(1)};
  setup_.nodes = nodes_;
  setup_.limits = limits_;
  setup_.start_values = start_values_;

  canopen::MasterOptions options;
  options.core_fingerprint = core_fingerprint_;  // always fits: no other module computes this joint
  options.resets_modules = true;
  options.allows_others = true;
  options.ramps_down = true;
  options.answer_timeout_us = patient_timeout_us;
  options.attempts = patient_attempts;
  master_.emplace(port_, setup_, options);
  master_->start(now);
}

void JointMotion::stop(Microseconds now) {
  if (master_) {
    master_->stop(now);
  } else {
    state_ = State::stopped;
  }
}

void JointMotion::receive(Microseconds now, const CanFrame& frame) {
  if (master_) {
    master_->receive(now, frame);
  } else {
    readings_.receive(now, frame);
  }
}

void JointMotion::transmitted(Microseconds now, const CanFrame& frame) {
  if (master_) {
    master_->transmitted(now, frame);
  } else {
    readings_.transmitted(now, frame);
  }
}

void JointMotion::poll(Microseconds now) {
  if (master_) {
    master_->poll(now);
    return;
  }
  readings_.poll(now);
  if (state_ == State::reading && readings_.is_idle()) {
    begin_motion(now);
  }
}

Microseconds JointMotion::next_deadline() const {
  if (master_) {
    return master_->next_deadline();
  }
  const bool has_read = state_ == State::reading && readings_.is_idle();
  return has_read ? 0 : readings_.next_deadline();
}

}  // namespace proleg::host
