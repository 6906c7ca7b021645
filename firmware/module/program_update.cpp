#include "firmware/module/program_update.hpp"

namespace proleg::firmware {

namespace module_flag = broadcast::module_flag;

ProgramUpdate::ProgramUpdate(const ModuleIdentity& identity, const Ports& ports)
    : port_(ports.program),
      receiver_(ports.program == nullptr ? std::span<std::uint8_t>() : ports.program->buffer(), serial_number(identity),
                *this) {}

void ProgramUpdate::power_on(Microseconds now) {
  has_sent_ = false;
  has_received_ = false;
  is_on_trial_ = port_ != nullptr && port_->has_bootloader() && !port_->is_confirmed();
  confirm_at_ = port_ == nullptr ? never : now + trial_us;
  good_at_ = port_ == nullptr ? never : now + good_start_us;
  enter_at_ = never;
  started_at_ = now;
  receiver_.reset();
}

std::optional<CanFrame> ProgramUpdate::receive(Microseconds now, const CanFrame& frame, const Conditions& conditions) {
  if (port_ == nullptr) {
    return std::nullopt;
  }
  conditions_ = conditions;
  const std::optional<CanFrame> answer = receiver_.receive(now, frame);
  if (!conditions.may_restart && receiver_.is_in_use(now)) {
    // A module that may move has no time to receive an image, and would not install it.
    receiver_.set_state(broadcast::ReceiverState::refused, broadcast::refused_busy);
  }
  if (receiver_.has_install_request()) {
    install(now);
  }
  if (receiver_.take_enter_request() && conditions.may_restart && port_->has_bootloader()) {
    enter_at_ = now + answer_time_us;
  }
  return answer;
}

void ProgramUpdate::install(Microseconds now) {
  if (conditions_.may_restart && port_->has_bootloader()) {
    port_->install({receiver_.image().size(), receiver_.session(), conditions_.is_gateway, now - started_at_});
  } else {
    receiver_.set_state(broadcast::ReceiverState::refused, broadcast::refused_busy);
  }
}

void ProgramUpdate::poll(Microseconds now, bool may_restart) {
  constexpr Microseconds next_look_us = 100'000;
  if (now >= confirm_at_) {
    if (is_on_trial_ && has_sent_ && has_received_) {  // so it can be replaced
      port_->confirm();
      is_on_trial_ = false;
    }
    confirm_at_ = is_on_trial_ ? now + next_look_us : never;
  }
  if (now >= good_at_) {
    good_at_ = never;
    port_->note_good_start();
  }
  if (now >= enter_at_) {
    enter_at_ = never;
    if (may_restart) {
      port_->enter_bootloader();
    }
  }
}

Microseconds ProgramUpdate::next_deadline() const {
  const Microseconds next = confirm_at_ < good_at_ ? confirm_at_ : good_at_;
  return next < enter_at_ ? next : enter_at_;
}

std::span<const std::uint8_t> ProgramUpdate::image_header() const {
  const ProgramPort& port = *port_;
  return port.header();
}

broadcast::TrustSummary ProgramUpdate::trust() const {
  const ProgramPort& port = *port_;
  return port.trust_summary();
}

broadcast::ModuleCondition ProgramUpdate::condition() const {
  unsigned flags = module_flag::runs_program | module_flag::has_image;
  flags |= port_->is_confirmed() ? module_flag::is_confirmed : 0U;
  flags |= conditions_.may_restart ? 0U : module_flag::is_busy;
  flags |= conditions_.has_newer_settings ? module_flag::has_newer_settings : 0U;
  flags |= conditions_.is_gateway ? module_flag::is_gateway : 0U;
  flags |= port_->has_bootloader() ? module_flag::has_bootloader : 0U;
  return {static_cast<std::uint8_t>(flags), conditions_.node};
}

}  // namespace proleg::firmware
