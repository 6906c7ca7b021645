#include "sim/bus/controller.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "sim/bus/bus.hpp"

namespace proleg::sim {

bool Controller::send(const CanFrame& frame) {
  if (frame.identifier > CanFrame::highest_identifier || frame.length > CanFrame::longest) {
    throw std::invalid_argument("a CAN frame with identifier " + std::to_string(frame.identifier) + " and " +
                                std::to_string(frame.length) + " bytes, expected at most 2047 and 8");
  }
  const auto free = std::ranges::find(mailboxes_, MailboxState::empty, &Mailbox::state);
  if (!on_ || free == mailboxes_.end()) {
    return false;
  }
  free->frame.identifier = frame.identifier;
  free->frame.length = frame.length;
  free->frame.data.fill(0);  // nobody sees what lies beyond the length
  std::ranges::copy(frame.bytes(), free->frame.data.begin());
  free->request = requests_++;
  free->state = MailboxState::pending;
  choose_candidate();
  return true;
}

void Controller::abort_all() {
  for (Mailbox& mailbox : mailboxes_) {
    if (mailbox.state == MailboxState::pending) {
      mailbox.state = MailboxState::empty;
    }
  }
  choose_candidate();
}

void Controller::switch_off() {
  abort_all();
  on_ = false;
}

void Controller::switch_on() {
  if (!on_) {
    on_ = true;
    on_since_ = bus_->now();
  }
}

std::size_t Controller::free_mailboxes() const {
  return static_cast<std::size_t>(std::ranges::count(mailboxes_, MailboxState::empty, &Mailbox::state));
}

void Controller::choose_candidate() {
  const bool had_one = candidate_ != nullptr;
  candidate_ = nullptr;
  for (Mailbox& mailbox : mailboxes_) {
    if (mailbox.state != MailboxState::pending) {
      continue;
    }
    if (candidate_ == nullptr || mailbox.frame.identifier < candidate_->frame.identifier ||
        (mailbox.frame.identifier == candidate_->frame.identifier && mailbox.request < candidate_->request)) {
      candidate_ = &mailbox;
    }
  }
  bus_->candidates_changed(had_one, candidate_ != nullptr);
}

}  // namespace proleg::sim
