#include "sim/serial/serial_line.hpp"

#include <algorithm>

namespace proleg::sim {
namespace {

constexpr unsigned data_bits = 8;
/// Time from the falling edge to the middle of the stop bit, in half bits.
constexpr unsigned half_bits_to_stop = 19;

}  // namespace

void SerialReceiver::begin(Time start, const SerialCharacter& character, Time bit) {
  add_edge(start, false);
  for (unsigned i = 0; i < data_bits; ++i) {
    add_edge(start + (1 + i) * bit, ((character.byte >> i) & 1U) != 0);
  }
  add_edge(start + (1 + data_bits) * bit, character.has_stop_bit);
  add_edge(start + serial_character_bits * bit, true);
}

void SerialReceiver::add_edge(Time time, bool high) {
  const bool before = edges_.empty() ? level_ : edges_.back().high;
  if (high != before) {
    edges_.push_back({time, high});
  }
}

bool SerialReceiver::level_at(Time time) const {
  bool high = level_;
  for (const Edge& edge : edges_) {
    if (edge.time > time) {
      break;
    }
    high = edge.high;
  }
  return high;
}

SerialReceiver::Time SerialReceiver::next_start() const {
  const auto found = std::ranges::find_if(edges_, [](const Edge& edge) { return !edge.high; });
  return found == edges_.end() ? never : found->time;
}

SerialReceiver::Time SerialReceiver::idle_time(Time bit) const {
  if (idle_from_ == never) {
    return never;
  }
  // After a break the line is idle only from its rising edge on.
  const Time rise = !level_ && !edges_.empty() ? edges_.front().time : 0;
  if (!level_ && edges_.empty()) {
    return never;
  }
  const Time idle = std::max(idle_from_, rise) + serial_character_bits * bit;
  return next_start() < idle ? never : idle;
}

SerialReceiver::Time SerialReceiver::next_event(Time bit) const {
  if (!is_busy()) {
    return never;  // this is the usual case
  }
  const Time start = next_start();
  const Time end = start == never ? never : start + half_bits_to_stop * bit / 2;
  return std::min(end, idle_time(bit));
}

std::optional<SerialReceiver::Event> SerialReceiver::take(Time now, Time bit) {
  if (!is_busy()) {
    return std::nullopt;
  }
  if (const Time idle = idle_time(bit); idle <= now) {
    idle_from_ = never;
    forget_until(idle);
    return Event{Kind::idle, {}, idle};
  }
  const Time start = next_start();
  if (start == never || start + half_bits_to_stop * bit / 2 > now) {
    return std::nullopt;
  }
  Event event;
  event.time = start + half_bits_to_stop * bit / 2;
  for (unsigned i = 0; i < data_bits; ++i) {
    const bool high = level_at(start + (2 * i + 3) * bit / 2);
    event.character.byte = static_cast<std::uint8_t>(event.character.byte | (high ? 1U << i : 0U));
  }
  event.character.has_stop_bit = level_at(event.time);
  forget_until(event.time);
  idle_from_ = start + serial_character_bits * bit;
  return event;
}

void SerialReceiver::forget_until(Time time) {
  while (!edges_.empty() && edges_.front().time <= time) {
    level_ = edges_.front().high;
    edges_.pop_front();
  }
}

void SerialSender::send(BusTime now, std::string_view characters) {
  for (const char character : characters) {
    send(now, SerialCharacter{static_cast<std::uint8_t>(character)});
  }
}

void SerialSender::send(BusTime now, const SerialCharacter& character) {
  const BusTime start = std::max(now, free_at_);
  pending_.push_back({start, character});
  free_at_ = start + serial_character_bits * bit_;
}

std::optional<SerialCharacter> SerialSender::take(BusTime now) {
  if (next_event() > now) {
    return std::nullopt;
  }
  const SerialCharacter character = pending_.front().character;
  pending_.pop_front();
  return character;
}

}  // namespace proleg::sim
