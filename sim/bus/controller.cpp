#include "sim/bus/controller.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "sim/bus/frame_bits.hpp"

namespace proleg::sim {
namespace {

constexpr unsigned max_active = 127;
constexpr unsigned max_on_bus = 255;

}  // namespace

ErrorState ErrorCounters::state() const {
  if (transmit_ > max_on_bus) {
    return ErrorState::bus_off;
  }
  return transmit_ > max_active || receive_ > max_active ? ErrorState::passive : ErrorState::active;
}

void ErrorCounters::transmitter_error() { transmit_ += transmit_ > max_on_bus ? 0 : 8; }

void ErrorCounters::receiver_error() { receive_ += receive_ > max_active ? 0 : 1; }

void ErrorCounters::transmitted() { transmit_ -= transmit_ > 0 ? 1 : 0; }

void ErrorCounters::received() {
  if (receive_ > max_active) {
    receive_ = max_active;
  } else if (receive_ > 0) {
    --receive_;
  }
}

bool Controller::send(const CanFrame& frame) {
  const auto free = std::ranges::find(mailboxes_, MailboxState::empty, &Mailbox::state);
  return send(static_cast<std::size_t>(free - mailboxes_.begin()), frame);
}

bool Controller::send(std::size_t mailbox, const CanFrame& frame) {
  if (frame.identifier > CanFrame::max_identifier || frame.length > CanFrame::max_length) {
    throw std::invalid_argument("a CAN frame with identifier " + std::to_string(frame.identifier) + " and " +
                                std::to_string(frame.length) + " bytes, expected at most 2047 and 8");
  }
  if (!accepts_requests() || mailbox >= mailbox_count || mailboxes_[mailbox].state != MailboxState::empty) {
    return false;
  }
  Mailbox& free = mailboxes_[mailbox];
  free.frame.identifier = frame.identifier;
  free.frame.length = frame.length;
  free.frame.data.fill(0);  // bytes beyond the length are not sent
  std::ranges::copy(frame.bytes(), free.frame.data.begin());
  free.bits = frame_bits(free.frame);
  free.request = requests_++;
  free.state = MailboxState::pending;
  choose_candidate();
  return true;
}

void Controller::abort_all() {
  for (Mailbox& mailbox : mailboxes_) {
    if (mailbox.state == MailboxState::pending) {
      mailbox.state = MailboxState::empty;
    } else if (mailbox.state == MailboxState::on_wire) {
      mailbox.state = MailboxState::withdrawn_on_wire;
    }
  }
  choose_candidate();
}

bool Controller::abort(std::size_t mailbox) {
  MailboxState& state = mailboxes_.at(mailbox).state;
  if (state == MailboxState::pending) {
    state = MailboxState::empty;
    choose_candidate();
  } else if (state == MailboxState::on_wire) {
    state = MailboxState::withdrawn_on_wire;
  }
  return state == MailboxState::empty;
}

void Controller::switch_off() {
  presence_ = Presence::off;
  bus_->end_wait(*this);
  update_part();
  abort_all();
}

void Controller::switch_on() {
  if (presence_ != Presence::on) {
    bus_->end_wait(*this);
    presence_ = Presence::on;
    reset_errors();
    update_part();
  }
}

void Controller::join() {
  if (presence_ == Presence::off) {
    presence_ = Presence::joining;
    bus_->begin_wait(*this, 1);
  }
}

void Controller::unplug() {
  if (!plugged_in_) {
    return;
  }
  if (is_sending()) {
    bus_->destroy_frame();
  }
  plugged_in_ = false;
  update_part();
  choose_candidate();
}

void Controller::plug_in() {
  if (plugged_in_) {
    return;
  }
  plugged_in_ = true;
  const bool has_tried = std::ranges::find(mailboxes_, MailboxState::pending, &Mailbox::state) != mailboxes_.end();
  if (has_tried && accepts_requests() && role_ == Role::normal) {
    while (error_state() == ErrorState::active) {
      errors_.transmitter_error();
    }
    last_error_ = CanError::acknowledgement;
    bus_->begin_counting();
  }
  update_part();
  choose_candidate();
  bus_->report_states();
}

void Controller::recover() {
  if (presence_ == Presence::on && error_state() == ErrorState::bus_off) {
    bus_->begin_wait(*this, 128);
  }
}

void Controller::reset_errors() {
  errors_.reset();
  last_error_ = CanError::none;
  reported_state_ = ErrorState::active;
  suspended_until_ = 0;
}

void Controller::set_order(Order order) {
  order_ = order;
  choose_candidate();
}

void Controller::set_role(Role role) {
  role_ = role;
  update_part();
  choose_candidate();
}

void Controller::watch(bool watch) {
  bus_->watch_changed(watches_, watch);
  watches_ = watch;
}

std::size_t Controller::free_mailboxes() const {
  return static_cast<std::size_t>(std::ranges::count(mailboxes_, MailboxState::empty, &Mailbox::state));
}

bool Controller::is_sending() const {
  const MailboxState state = mailboxes_[sent_mailbox_].state;
  return state == MailboxState::on_wire || state == MailboxState::withdrawn_on_wire;
}

void Controller::update_part() {
  const bool before = takes_part_;
  takes_part_ = plugged_in_ && accepts_requests();
  if (takes_part_ && !before) {
    part_since_ = bus_->now();
  }
  receives_ = takes_part_ && role_ != Role::loop_back;
  acknowledges_ = receives_ && role_ != Role::silent;
}

void Controller::take_back() {
  MailboxState& state = mailboxes_[sent_mailbox_].state;
  state = state == MailboxState::on_wire && !one_shot_ ? MailboxState::pending : MailboxState::empty;
}

bool Controller::precedes(const Mailbox& left, const Mailbox& right) const {
  if (order_ != Order::request && left.frame.identifier != right.frame.identifier) {
    return left.frame.identifier < right.frame.identifier;
  }
  return order_ == Order::identifier_then_mailbox ? &left < &right : left.request < right.request;
}

void Controller::choose_candidate() {
  const bool had_one = candidate_ != nullptr;
  candidate_ = nullptr;
  if (takes_part_ && role_ != Role::silent) {
    for (Mailbox& mailbox : mailboxes_) {
      if (mailbox.state == MailboxState::pending && (candidate_ == nullptr || precedes(mailbox, *candidate_))) {
        candidate_ = &mailbox;
      }
    }
  }
  bus_->candidates_changed(had_one, candidate_ != nullptr);
}

}  // namespace proleg::sim
