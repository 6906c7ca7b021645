#include "firmware/module/gateway.hpp"

namespace proleg::firmware {
namespace {

/// Settings of the adapter. Its serial number is the lower half of the module's, because slcan has room for four
/// characters.
SlcanAdapter::Settings settings_of(const ModuleIdentity& identity) {
  SlcanAdapter::Settings settings;
  std::uint32_t serial = serial_number(identity);
  for (std::size_t i = settings.serial_number.size(); i-- > 0; serial >>= 4U) {
    settings.serial_number[i] = "0123456789ABCDEF"[serial & 15U];
  }
  return settings;
}

/// Takes the place of damaged characters: no command of slcan contains it.
constexpr std::string_view damaged = "?";

}  // namespace

Gateway::Gateway(const ModuleIdentity& identity, const Ports& ports)
    : can_(ports.can), line_(ports.line), adapter_(buffer_, host_port_, settings_of(identity)) {}

void Gateway::power_on() {
  is_active_ = false;
  was_open_ = false;
  is_bus_off_ = false;
  first_ = 0;
  size_ = 0;
  is_in_mailbox_ = false;
  pause_end_ = 0;
  next_error_report_ = 0;
  errors_ = {};
  status_ = {};
  adapter_.reset();
}

void Gateway::set_role(bool is_gateway) {
  if (line_ == nullptr || is_gateway == is_active_) {
    return;
  }
  is_active_ = is_gateway;
  adapter_.reset();
  follow_channel();
  discard_frames();
  line_->connect(is_gateway);
}

/// A frame that is in a mailbox cannot be withdrawn.
void Gateway::discard_frames() {
  const std::size_t kept = is_in_mailbox_ ? 1 : 0;
  discarded_ += static_cast<std::uint32_t>(size_ - kept);
  size_ = kept;
}

bool Gateway::enqueue(const CanFrame& frame) {
  if (is_bus_off_ || size_ == queue_.size()) {
    return false;
  }
  queue_[(first_ + size_) % queue_.size()] = frame;
  ++size_;
  return true;
}

void Gateway::pass(Microseconds now, const CanFrame& frame) {
  if (is_active_) {
    adapter_.received(now, frame);
  }
}

bool Gateway::confirm(Microseconds now, const CanFrame& frame) {
  // Two mailboxes never hold frames with the same identifier (CanPort).
  if (!is_in_mailbox_ || queue_[first_].identifier != frame.identifier) {
    return false;
  }
  is_in_mailbox_ = false;
  first_ = (first_ + 1) % queue_.size();
  --size_;
  pause_end_ = now + pause_us;
  return true;
}

void Gateway::bus_off() {
  is_in_mailbox_ = false;
  is_bus_off_ = true;
  discard_frames();
}

bool Gateway::serve(Microseconds now, const Conditions& conditions) {
  if (!is_active_) {
    return false;
  }
  report_bus(now);
  const bool has_more = read_line();
  follow_channel();
  send_frame(now, conditions);
  write_line();
  return has_more;
}

bool Gateway::read_line() {
  if (line_->take_damage()) {
    adapter_.input(damaged);
  }
  std::array<char, max_read> characters;
  const std::size_t count = line_->read_line(characters);
  adapter_.input({characters.data(), count});
  return count == characters.size();
}

void Gateway::follow_channel() {
  if (adapter_.is_open() != was_open_) {
    was_open_ = adapter_.is_open();
    can_.receive_all(was_open_);
  }
}

void Gateway::report_bus(Microseconds now) {
  if (const CanStatus status = can_.status(); status.state != status_.state) {
    status_ = status;
    adapter_.status_changed(status);
  }
  if (now >= next_error_report_) {
    next_error_report_ = now + error_period_us;
    errors_.add(can_.take_errors());
    adapter_.errors_occurred(errors_);
    errors_ = {};
  }
}

void Gateway::send_frame(Microseconds now, const Conditions& conditions) {
  if (now >= pause_end_ || !conditions.is_operational) {
    pause_end_ = 0;
  }
  if (size_ > 0 && !is_in_mailbox_ && pause_end_ == 0 && !conditions.has_own_frames) {
    is_in_mailbox_ = can_.send(queue_[first_]);
  }
}

void Gateway::write_line() {
  if (adapter_.has_output()) {
    if (const std::span<char> room = line_->line_room(); !room.empty()) {
      line_->send_line(adapter_.take(room));
    }
  }
}

Microseconds Gateway::next_deadline() const {
  if (!is_active_) {
    return never;
  }
  const bool is_paused = size_ > 0 && pause_end_ != 0;
  return is_paused && pause_end_ < next_error_report_ ? pause_end_ : next_error_report_;
}

}  // namespace proleg::firmware
