#include "sim/bus/bus.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace proleg::sim {
namespace {

/// Which of two frames prevails if both are sent at the same instant: the one with a dominant bit (0) where they first
/// differ. Behind the identifier comes the length, then the data.
bool prevails(const CanFrame& left, const CanFrame& right) {
  if (left.identifier != right.identifier) {
    return left.identifier < right.identifier;
  }
  if (left.length != right.length) {
    return left.length < right.length;
  }
  return std::ranges::lexicographical_compare(left.bytes(), right.bytes());
}

}  // namespace

Bus::Bus(std::uint32_t bit_rate) : bit_rate_(bit_rate) {
  if (bit_rate == 0 || bit_rate > highest_bit_rate) {
    throw std::invalid_argument("a CAN bus of " + std::to_string(bit_rate) + " bit/s, expected 1 to " +
                                std::to_string(highest_bit_rate));
  }
}

Controller& Bus::attach(BusListener& listener) {
  controllers_.push_back(std::make_unique<Controller>(*this, listener, controllers_.size()));
  controllers_.back()->on_since_ = now_;
  senders_.reserve(controllers_.size());
  return *controllers_.back();
}

BusTime Bus::next_event() const {
  if (sending_) {
    return current_.end;
  }
  if (candidates_ == 0) {
    return never_on_bus;
  }
  return arbitration_at_ + duration(frame_bits(winner()->candidate_->frame));
}

void Bus::advance_to(BusTime time) {
  if (reporting_) {
    throw std::logic_error("a listener of the CAN bus advances it");
  }
  for (;;) {
    if (sending_ && current_.end <= time) {
      finish();
    } else if (!sending_ && arbitration_at_ < time) {
      start(arbitration_at_);
    } else {
      break;
    }
  }
  now_ = std::max(now_, time);
}

void Bus::candidates_changed(bool had_one, bool has_one) {
  candidates_ += has_one ? 1U : 0U;
  candidates_ -= had_one ? 1U : 0U;
  if (sending_) {
    return;
  }
  if (candidates_ == 0) {
    arbitration_at_ = never_on_bus;
  } else if (arbitration_at_ == never_on_bus) {
    arbitration_at_ = std::max(now_, free_at_);
  }
}

Controller* Bus::winner() const {
  Controller* best = nullptr;
  for (const auto& controller : controllers_) {
    if (controller->candidate_ != nullptr &&
        (best == nullptr || prevails(controller->candidate_->frame, best->candidate_->frame))) {
      best = controller.get();
    }
  }
  return best;
}

void Bus::start(BusTime time) {
  Controller* const first = winner();
  now_ = time;
  current_.start = time;
  current_.frame = first->candidate_->frame;
  current_.sender = first->index_;
  const unsigned bits = frame_bits(current_.frame);
  current_.end = time + duration(bits);
  free_at_ = time + duration(bits + interframe_bits);
  total_.busy += free_at_ - time;
  arbitration_at_ = never_on_bus;
  sending_ = true;
  ++transmission_;

  senders_.clear();
  for (const auto& controller : controllers_) {
    if (controller->candidate_ == nullptr || controller->candidate_->frame.identifier != current_.frame.identifier) {
      continue;
    }
    if (controller->candidate_->frame == current_.frame) {
      senders_.push_back(controller.get());
      continue;
    }
    ++total_.collisions;
    if (collision_report_) {
      collision_report_(time, current_.frame, controller->candidate_->frame);
    }
  }
  for (Controller* sender : senders_) {
    sender->candidate_->state = Controller::MailboxState::on_wire;
    sender->last_sent_ = transmission_;
    sender->choose_candidate();
  }
}

void Bus::finish() {
  now_ = current_.end;
  sending_ = false;
  ++total_.frames;
  for (Controller* sender : senders_) {
    std::ranges::find(sender->mailboxes_, Controller::MailboxState::on_wire, &Controller::Mailbox::state)->state =
        Controller::MailboxState::empty;
  }
  if (candidates_ > 0) {
    arbitration_at_ = free_at_;
  }
  reporting_ = true;
  try {
    report();
  } catch (...) {
    reporting_ = false;
    throw;
  }
  reporting_ = false;
}

void Bus::report() {
  const auto hears = [this](const Controller& controller) {
    return controller.on_ && controller.on_since_ <= current_.start;
  };
  if (trace_) {
    trace_(current_);
  }
  for (Controller* sender : senders_) {
    if (hears(*sender)) {
      sender->listener_->transmitted(current_.end, current_.frame);
    }
  }
  // By position: a listener may attach another node.
  const std::size_t count = controllers_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Controller& controller = *controllers_[i];
    if (controller.last_sent_ == transmission_ || !hears(controller)) {
      continue;
    }
    if (loss_rule_ && loss_rule_(current_.frame, i)) {
      ++total_.losses;
      continue;
    }
    controller.listener_->received(current_.end, current_.frame);
  }
}

BusStatistics Bus::statistics_since_time_0() const {
  BusStatistics statistics = total_;
  statistics.busy -= free_at_ > now_ ? free_at_ - now_ : 0;
  statistics.period = now_;
  return statistics;
}

BusStatistics Bus::statistics() const {
  BusStatistics statistics = statistics_since_time_0();
  statistics.frames -= mark_.frames;
  statistics.busy -= mark_.busy;
  statistics.period -= mark_.period;
  statistics.losses -= mark_.losses;
  statistics.collisions -= mark_.collisions;
  return statistics;
}

void Bus::start_statistics() { mark_ = statistics_since_time_0(); }

}  // namespace proleg::sim
