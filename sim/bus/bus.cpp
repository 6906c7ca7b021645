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

constexpr unsigned error_bits = 6 + 8;  // flag and delimiter; flags that do not begin together would take up to 12
constexpr unsigned recessive_bits_to_join = 11;
constexpr unsigned suspend_bits = 8;         // a passive sender waits this long for others
constexpr unsigned earliest_collision = 16;  // frames of one identifier differ from the length on

/// Resets a mark at the end of a scope, also if a listener throws.
class Reset {
 public:
  explicit Reset(bool& mark) : mark_(&mark) {}
  ~Reset() { *mark_ = false; }
  Reset(const Reset&) = delete;
  Reset& operator=(const Reset&) = delete;

 private:
  bool* mark_;
};

}  // namespace

Bus::Bus(std::uint32_t bit_rate) : bit_rate_(bit_rate), waits_(bit_rate) {
  if (bit_rate == 0 || bit_rate > max_bit_rate) {
    throw std::invalid_argument("a CAN bus of " + std::to_string(bit_rate) + " bit/s, expected 1 to " +
                                std::to_string(max_bit_rate));
  }
}

Controller& Bus::attach(BusListener& listener) {
  controllers_.push_back(
      std::make_unique<Controller>(static_cast<ControllerBus&>(*this), listener, controllers_.size()));
  controllers_.back()->part_since_ = now_;
  senders_.reserve(controllers_.size());
  return *controllers_.back();
}

BusTime Bus::next_delivery() const { return delayed_.empty() ? never_on_bus : delayed_.front().time; }

BusTime Bus::next_end_of_wait() const { return dominant_ ? never_on_bus : waits_.next_end(); }

BusTime Bus::next_event() const { return std::min(next_delivery(), next_change()); }

BusTime Bus::next_change() const {
  if (sending_) {
    return current_.end;
  }
  const BusTime end_of_wait = next_end_of_wait();
  if (candidates_ == 0 || dominant_) {
    return end_of_wait;
  }
  if (watchers_ > 0 || collision_rule_ == CollisionRule::bit_error) {
    return std::min(end_of_wait, arbitration_at_ + 1);  // the end is known when the transmission has begun
  }
  return std::min(end_of_wait, arbitration_at_ + duration(winner()->candidate_->bits));
}

BusTime Bus::earliest_delivery() const {
  if (sending_) {
    return std::min(next_delivery(), current_.end);
  }
  const bool collides = collision_rule_ == CollisionRule::bit_error;
  return std::min(std::min(next_delivery(), next_end_of_wait()),
                  now_ + duration(collides ? earliest_collision + error_bits : min_frame_bits));
}

void Bus::advance_to(BusTime time) {
  if (reporting_) {
    throw std::logic_error("a listener of the CAN bus advances it");
  }
  for (;;) {
    if (next_delivery() <= time && (!sending_ || next_delivery() <= current_.end)) {
      deliver_delayed(next_delivery());
      continue;
    }
    if (sending_) {
      if (current_.end > time) {
        break;
      }
      finish();
      continue;
    }
    const BusTime end_of_wait = next_end_of_wait();
    if (end_of_wait != never_on_bus && end_of_wait <= time && end_of_wait <= arbitration_at_) {
      end_waits(end_of_wait);
    } else if (!dominant_ && arbitration_at_ < time) {
      start(arbitration_at_);
    } else {
      break;
    }
  }
  now_ = std::max(now_, time);
}

std::unique_lock<std::mutex> Bus::lock() const {
  return is_shared_ ? std::unique_lock(mutex_) : std::unique_lock<std::mutex>();
}

void Bus::end_sharing() {
  is_shared_ = false;
  if (has_changed_in_share_) {
    has_changed_in_share_ = false;
    schedule_arbitration();
  }
}

void Bus::end_wait(const Controller& controller) {
  const auto held = lock();
  waits_.remove(controller);
}

void Bus::candidates_changed(bool had_one, bool has_one) {
  const auto held = lock();
  candidates_ += has_one ? 1U : 0U;
  candidates_ -= had_one ? 1U : 0U;
  if (sending_) {
    return;
  }
  if (is_shared_) {
    has_changed_in_share_ = true;  // the candidates of other threads may change now
  } else {
    schedule_arbitration();
  }
}

void Bus::watch_changed(bool watched, bool watches) {
  const auto held = lock();
  watchers_ += watches ? 1U : 0U;
  watchers_ -= watched ? 1U : 0U;
}

void Bus::schedule_arbitration() {
  const BusTime earliest = std::max(now_, free_at_);
  if (candidates_ == 0 || dominant_) {
    arbitration_at_ = never_on_bus;
  } else if (suspended_until_ > earliest) {
    arbitration_at_ = never_on_bus;
    for (const auto& controller : controllers_) {
      if (controller->candidate_ != nullptr) {
        arbitration_at_ = std::min(arbitration_at_, std::max(earliest, controller->suspended_until_));
      }
    }
  } else if (arbitration_at_ == never_on_bus) {
    arbitration_at_ = earliest;
  }
}

void Bus::end_waits(BusTime time) {
  now_ = time;
  reporting_ = true;
  const Reset guard(reporting_);
  for (Controller* controller : waits_.ending_at(time)) {
    // A listener called before may have switched it off.
    if (!waits_.contains(*controller)) {
      continue;
    }
    waits_.remove(*controller);
    const bool joins = controller->presence_ == Controller::Presence::joining;
    if (joins) {
      controller->presence_ = Controller::Presence::on;
    } else {
      controller->errors_.reset();
      controller->last_error_ = CanError::none;
    }
    controller->update_part();
    if (joins) {
      controller->listener_->joined(time);
    }
    report_states();
  }
}

Controller* Bus::winner() const {
  Controller* best = nullptr;
  for (const auto& controller : controllers_) {
    if (competes(*controller) &&
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
  const unsigned bits = first->candidate_->bits;
  current_.end = time + duration(bits);
  free_at_ = time + duration(bits + interframe_bits);
  failure_ = CanError::none;
  ++transmission_;

  unsigned collision_bit = bits;
  senders_.clear();
  for (const auto& controller : controllers_) {
    if (controller->candidate_ == nullptr || controller->candidate_->frame.identifier != current_.frame.identifier ||
        !competes(*controller)) {
      continue;
    }
    if (controller->candidate_->frame == current_.frame) {
      senders_.push_back(controller.get());
      continue;
    }
    ++total_.collisions;
    if (collision_rule_ == CollisionRule::bit_error) {
      collision_bit = std::min(collision_bit, first_different_bit(current_.frame, controller->candidate_->frame));
      senders_.push_back(controller.get());
    }
    if (collision_report_) {
      collision_report_(time, current_.frame, controller->candidate_->frame);
    }
  }
  const bool acknowledged =
      first->role_ == Controller::Role::loop_back || std::ranges::any_of(controllers_, [&](const auto& controller) {
        return controller->acknowledges_ && controller.get() != first;
      });
  predict_error(acknowledged, bits, collision_bit);
  total_.busy += free_at_ - time;
  if (!waits_.empty()) {
    waits_.end_silence(time);
  }
  for (Controller* sender : senders_) {
    sender->sent_mailbox_ = static_cast<std::size_t>(sender->candidate_ - sender->mailboxes_.data());
  }
  if (watchers_ > 0) {
    notify_watchers(time);
  }
  arbitration_at_ = never_on_bus;
  sending_ = true;
  for (Controller* sender : senders_) {
    sender->candidate_->state = Controller::MailboxState::on_wire;
    sender->last_sent_ = transmission_;
    sender->choose_candidate();
  }
}

void Bus::predict_error(bool acknowledged, unsigned bits, unsigned collision_bit) {
  constexpr unsigned crc_delimiter_to_end = 10;
  unsigned last_bit = 0;  // in which the error is seen, counted from 1
  if (collision_bit < bits) {
    failure_ = CanError::bit_recessive;
    last_bit = collision_bit + 1;
  } else if (error_rule_ && error_rule_(current_.frame, transmission_)) {
    failure_ = CanError::bit_recessive;
    last_bit = bits - crc_delimiter_to_end + 1;
  } else if (!acknowledged) {
    failure_ = CanError::acknowledgement;
    last_bit = bits - crc_delimiter_to_end + 2;
  } else {
    return;
  }
  current_.end = current_.start + duration(last_bit + error_bits);
  free_at_ = current_.start + duration(last_bit + error_bits + interframe_bits);
}

void Bus::notify_watchers(BusTime time) {
  reporting_ = true;
  const Reset guard(reporting_);
  for (const auto& controller : controllers_) {
    if (!controller->watches_) {
      continue;
    }
    controller->outbid_mailbox_ = Controller::mailbox_count;
    if (competes(*controller) && std::ranges::find(senders_, controller.get()) == senders_.end()) {
      controller->outbid_mailbox_ = static_cast<std::size_t>(controller->candidate_ - controller->mailboxes_.data());
    }
  }
  for (const auto& controller : controllers_) {
    if (!controller->watches_) {
      continue;
    }
    controller->listener_->frame_began(time);
    if (controller->one_shot_ && controller->outbid_mailbox_ < Controller::mailbox_count) {
      controller->mailboxes_[controller->outbid_mailbox_].state = Controller::MailboxState::empty;
      controller->choose_candidate();
    }
  }
}

void Bus::finish() {
  now_ = current_.end;
  sending_ = false;
  if (!waits_.empty()) {
    waits_.begin_silence(now_);
  }
  if (failure_ == CanError::none) {
    succeed();
  } else {
    fail();
  }
}

void Bus::succeed() {
  ++total_.frames;
  for (Controller* sender : senders_) {
    sender->mailboxes_[sender->sent_mailbox_].state = Controller::MailboxState::empty;
  }
  if (counting_) {
    for (const auto& controller : controllers_) {
      if (!controller->took_part_since(current_.start)) {
        continue;
      }
      if (controller->last_sent_ == transmission_) {
        controller->errors_.transmitted();
        controller->last_error_ = CanError::none;
      } else if (controller->receives_) {
        controller->errors_.received();
        controller->last_error_ = CanError::none;
      }
    }
    suspend_passive_senders();
  }
  schedule_arbitration();
  reporting_ = true;
  const Reset guard(reporting_);
  report();
  if (counting_) {
    report_states();
  }
}

void Bus::fail() {
  ++total_.errors;
  counting_ = true;
  for (const auto& controller : controllers_) {
    const bool counts = controller->took_part_since(current_.start);
    if (controller->last_sent_ != transmission_) {
      if (counts && controller->receives_) {
        controller->errors_.receiver_error();
        controller->last_error_ = CanError::form;
      }
      continue;
    }
    controller->take_back();
    if (counts) {
      // A node that is alone on the bus does not enter bus-off (rule c, exception 1).
      const bool alone = failure_ == CanError::acknowledgement && controller->error_state() == ErrorState::passive;
      if (!alone) {
        controller->errors_.transmitter_error();
      }
      controller->last_error_ = failure_;
      if (controller->error_state() == ErrorState::bus_off) {
        controller->update_part();
        controller->abort_all();
      }
    }
  }
  suspend_passive_senders();
  for (Controller* sender : senders_) {
    sender->choose_candidate();
  }
  schedule_arbitration();
  reporting_ = true;
  const Reset guard(reporting_);
  report_error();
  report_states();
}

void Bus::suspend_passive_senders() {
  for (Controller* sender : senders_) {
    if (sender->error_state() == ErrorState::passive) {
      sender->suspended_until_ = free_at_ + duration(suspend_bits);
      suspended_until_ = std::max(suspended_until_, sender->suspended_until_);
    }
  }
}

void Bus::report() {
  if (frame_listener_) {
    frame_listener_(current_);
  }
  for (Controller* sender : senders_) {
    if (sender->took_part_since(current_.start)) {
      sender->listener_->transmitted(current_.end, current_.frame);
    }
  }
  // Iterates by position, because a listener may attach another node.
  const std::size_t count = controllers_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Controller& controller = *controllers_[i];
    if (controller.last_sent_ == transmission_ || !controller.receives_ || controller.part_since_ > current_.start) {
      continue;
    }
    if (loss_rule_ && loss_rule_(current_.frame, i)) {
      ++total_.losses;
      continue;
    }
    if (const BusTime delay = delay_rule_ ? delay_rule_(current_.frame, i) : 0; delay > 0) {
      const Delayed delayed{current_.end + delay, i, current_.frame};
      delayed_.insert(std::ranges::upper_bound(delayed_, delayed.time, {}, &Delayed::time), delayed);
      continue;
    }
    controller.listener_->received(current_.end, current_.frame);
  }
}

void Bus::deliver_delayed(BusTime time) {
  now_ = std::max(now_, time);
  const Delayed delayed = delayed_.front();
  delayed_.erase(delayed_.begin());
  Controller& receiver = *controllers_[delayed.receiver];
  if (receiver.presence_ == Controller::Presence::on) {
    reporting_ = true;
    const Reset guard(reporting_);
    receiver.listener_->received(time, delayed.frame);
  }
}

void Bus::hold_dominant(bool dominant) {
  if (dominant == dominant_) {
    return;
  }
  dominant_ = dominant;
  arbitration_at_ = never_on_bus;
  if (dominant) {
    count_dominant_errors();
    waits_.end_silence(now_);
  } else {
    free_at_ = std::max(free_at_, now_ + duration(recessive_bits_to_join));
    waits_.begin_idle(now_);
  }
  schedule_arbitration();
}

void Bus::count_dominant_errors() {
  counting_ = true;
  if (sending_) {
    destroy_frame();
    finish();
    for (Controller* sender : senders_) {
      while (sender->takes_part_) {
        sender->errors_.transmitter_error();
        sender->last_error_ = CanError::bit_recessive;
        if (sender->error_state() == ErrorState::bus_off) {
          sender->update_part();
          sender->abort_all();
        }
      }
    }
  }
  for (const auto& controller : controllers_) {
    while (controller->receives_ && controller->error_state() == ErrorState::active) {
      controller->errors_.receiver_error();
      controller->last_error_ = CanError::form;
    }
  }
  reporting_ = true;
  const Reset guard(reporting_);
  report_states();
}

void Bus::destroy_frame() {
  if (!sending_) {
    return;
  }
  failure_ = CanError::bit_recessive;
  current_.end = std::max(now_, current_.start + 1);
  free_at_ = current_.end + duration(interframe_bits);
}

void Bus::report_error() {
  const std::size_t count = controllers_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Controller& controller = *controllers_[i];
    const bool sent = controller.last_sent_ == transmission_;
    // A controller that is in bus-off now was on the bus when the error occurred.
    if (controller.presence_ == Controller::Presence::on && controller.part_since_ <= current_.start &&
        (sent || controller.receives_)) {
      controller.listener_->error_seen(current_.end, sent);
    }
  }
}

void Bus::report_states() {
  const std::size_t count = controllers_.size();
  for (std::size_t i = 0; i < count; ++i) {
    Controller& controller = *controllers_[i];
    if (controller.error_state() != controller.reported_state_) {
      controller.reported_state_ = controller.error_state();
      controller.listener_->error_state_changed(now_);
    }
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
  statistics.errors -= mark_.errors;
  return statistics;
}

void Bus::start_statistics() { mark_ = statistics_since_time_0(); }

}  // namespace proleg::sim
