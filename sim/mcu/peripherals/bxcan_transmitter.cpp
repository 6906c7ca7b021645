#include "sim/mcu/peripherals/bxcan_transmitter.hpp"

namespace proleg::sim {

void BxCanTransmitter::submit(std::size_t mailbox) {
  mailboxes_[mailbox].is_submitted = true;
  hand_over();
}

void BxCanTransmitter::abort(std::size_t mailbox) {
  const BxCanMailboxes::Mailbox& aborted = mailboxes_[mailbox];
  if (!aborted.abort_requested) {
    return;  // the frame has gone out in the meantime
  }
  if (!aborted.is_handed_over || controller_->abort(mailbox)) {
    mailboxes_.complete(mailbox, aborted.outcome & ~BxCanMailboxes::txok);
  }
}

void BxCanTransmitter::hand_over() {
  for (auto next = mailboxes_.next_to_hand_over(); next; next = mailboxes_.next_to_hand_over()) {
    if (!controller_->send(*next, mailboxes_.frame(*next))) {
      return;
    }
    mailboxes_[*next].is_handed_over = true;
  }
}

void BxCanTransmitter::transmitted() { mailboxes_.complete(controller_->sent_mailbox(), BxCanMailboxes::txok); }

void BxCanTransmitter::failed(bool one_shot) {
  const std::size_t number = controller_->sent_mailbox();
  BxCanMailboxes::Mailbox& mailbox = mailboxes_[number];
  mailbox.outcome = (mailbox.outcome & ~BxCanMailboxes::txok) | BxCanMailboxes::terr;
  // In bus-off the controller has emptied all its mailboxes. There a request is complete only if it has one attempt.
  const bool is_tried_again =
      controller_->error_state() == ErrorState::bus_off && !mailbox.abort_requested && !one_shot;
  if (controller_->is_empty(number) && !is_tried_again) {
    mailboxes_.complete(number, mailbox.outcome);
  }
}

void BxCanTransmitter::lost_arbitration() {
  const std::size_t number = controller_->outbid_mailbox();
  mailboxes_.complete(number, (mailboxes_[number].outcome & ~BxCanMailboxes::txok) | BxCanMailboxes::alst);
}

}  // namespace proleg::sim
