#include "sim/serial/serial_sender.hpp"

#include <algorithm>

namespace proleg::sim {

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
