#include "sim/mcu/peripherals/bxcan_transmitter.hpp"

#include <algorithm>

namespace proleg::sim {
namespace {

enum Identifier : std::uint32_t { txrq = 1U << 0U, rtr = 1U << 1U, ide = 1U << 2U };
constexpr unsigned stid_shift = 21;
constexpr std::uint32_t dlc_mask = 0xF;
constexpr std::uint32_t time_mask = 0xFFFF'0000;
constexpr std::uint32_t tgt = 1U << 8U;

constexpr std::uint32_t abrq = 1U << 7U;
constexpr unsigned code_shift = 24;
constexpr unsigned tme_shift = 26;
constexpr unsigned low_shift = 29;

}  // namespace

void BxCanRequests::add(BusTime time, Kind kind, std::uint32_t value) {
  pending_.push_back({empty() ? time : std::max(time, pending_.back().time), kind, value});
}

void BxCanRequests::postpone(const Request& request, BusTime time) {
  pending_.push_front({time, request.kind, request.value});
}

std::optional<BxCanRequests::Request> BxCanRequests::take_due(BusTime now) {
  if (empty() || pending_.front().time > now) {
    return std::nullopt;
  }
  const Request request = pending_.front();
  pending_.pop_front();
  return request;
}

std::uint32_t BxCanMailboxes::read(std::size_t number, std::uint32_t word) const {
  const Mailbox& mailbox = mailboxes_.at(number);
  switch (word) {
    case 0:
      return mailbox.identifier | (mailbox.is_pending ? txrq : 0U);
    case 1:
      return mailbox.length;
    case 2:
      return mailbox.low;
    default:
      return mailbox.high;
  }
}

std::optional<std::string> BxCanMailboxes::write(std::size_t number, std::uint32_t word, std::uint32_t value) {
  Mailbox& mailbox = mailboxes_.at(number);
  if (mailbox.is_pending) {
    return "write-protected while TSR.TME" + std::to_string(number) + " is 0";
  }
  switch (word) {
    case 0:
      if ((value & ide) != 0) {
        return "extended identifiers are not modelled";
      }
      if ((value & rtr) != 0) {
        return "remote frames are not modelled";
      }
      mailbox.identifier = value & ~txrq;
      if ((value & txrq) != 0) {
        mailbox.request = requests_++;
        mailbox.is_pending = true;
        mailbox.outcome = 0;
      }
      break;
    case 1:
      if ((value & tgt) != 0) {
        return "time triggered communication is not modelled";
      }
      if ((value & dlc_mask) > CanFrame::max_length) {
        return "a data length above 8 is not modelled";
      }
      mailbox.length = value & (dlc_mask | time_mask);
      break;
    case 2:
      mailbox.low = value;
      break;
    default:
      mailbox.high = value;
      break;
  }
  return std::nullopt;
}

std::uint32_t BxCanMailboxes::status(bool by_request) const {
  std::uint32_t value = 0;
  std::optional<std::size_t> lowest;
  std::optional<std::size_t> next_free;
  unsigned pending = 0;
  for (std::size_t i = count; i-- > 0;) {
    const Mailbox& mailbox = mailboxes_.at(i);
    value |= (mailbox.outcome | (mailbox.abort_requested ? abrq : 0U)) << (8 * i);
    if (!mailbox.is_pending) {
      value |= 1U << (tme_shift + i);
      next_free = i;
      continue;
    }
    ++pending;
    if (!lowest || precedes(*lowest, i, by_request)) {
      lowest = i;
    }
  }
  if (pending > 1) {
    value |= 1U << (low_shift + *lowest);
  }
  const std::size_t code = next_free ? *next_free : *lowest;
  return value | (static_cast<std::uint32_t>(code) << code_shift);
}

std::uint32_t BxCanMailboxes::write_status(std::uint32_t value) {
  std::uint32_t aborts = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Mailbox& mailbox = mailboxes_.at(i);
    const std::uint32_t bits = value >> (8 * i);
    mailbox.outcome &= (bits & rqcp) != 0 ? 0U : ~(bits & (txok | alst | terr));
    if ((bits & abrq) != 0 && mailbox.is_pending && !mailbox.abort_requested) {
      mailbox.abort_requested = true;
      aborts |= 1U << i;
    }
  }
  return aborts;
}

void BxCanMailboxes::complete(std::size_t number, std::uint32_t outcome) {
  Mailbox& mailbox = mailboxes_.at(number);
  mailbox.is_pending = false;
  mailbox.is_submitted = false;
  mailbox.is_handed_over = false;
  mailbox.abort_requested = false;
  mailbox.outcome = outcome | rqcp;
}

void BxCanMailboxes::take_back() {
  for (Mailbox& mailbox : mailboxes_) {
    mailbox.is_handed_over = false;
  }
}

bool BxCanMailboxes::any_completed() const {
  std::uint32_t outcomes = 0;
  for (const Mailbox& mailbox : mailboxes_) {
    outcomes |= mailbox.outcome;
  }
  return (outcomes & rqcp) != 0;
}

std::optional<std::size_t> BxCanMailboxes::first(bool by_request) const {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < count; ++i) {
    if (mailboxes_.at(i).is_pending && (!best || precedes(i, *best, by_request))) {
      best = i;
    }
  }
  return best;
}

std::optional<std::size_t> BxCanMailboxes::next_to_hand_over() const {
  std::optional<std::size_t> next;
  for (std::size_t i = 0; i < count; ++i) {
    const Mailbox& mailbox = mailboxes_.at(i);
    if (mailbox.is_submitted && !mailbox.is_handed_over && (!next || mailbox.request < mailboxes_.at(*next).request)) {
      next = i;
    }
  }
  return next;
}

CanFrame BxCanMailboxes::frame(std::size_t number) const {
  const Mailbox& mailbox = mailboxes_.at(number);
  CanFrame frame;
  frame.identifier = static_cast<std::uint16_t>(mailbox.identifier >> stid_shift);
  frame.length = static_cast<std::uint8_t>(mailbox.length & dlc_mask);
  for (unsigned i = 0; i < frame.length; ++i) {
    frame.data.at(i) = static_cast<std::uint8_t>((i < 4 ? mailbox.low : mailbox.high) >> (8 * (i % 4)));
  }
  return frame;
}

bool BxCanMailboxes::precedes(std::size_t left, std::size_t right, bool by_request) const {
  const Mailbox& one = mailboxes_.at(left);
  const Mailbox& other = mailboxes_.at(right);
  if (by_request) {
    return one.request < other.request;
  }
  const std::uint32_t identifier = one.identifier >> stid_shift;
  const std::uint32_t other_identifier = other.identifier >> stid_shift;
  return identifier != other_identifier ? identifier < other_identifier : left < right;
}

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
