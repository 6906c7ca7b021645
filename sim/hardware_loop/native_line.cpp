#include "sim/hardware_loop/native_line.hpp"

#include <algorithm>

namespace proleg::sim {

void NativeLine::reset() {
  connect(false);
  is_damaged_ = false;
}

void NativeLine::connect(bool is_gateway) {
  is_connected_ = is_gateway;
  receiver_.reset();
  input_.clear();
  sent_ = 0;
  to_send_ = 0;
  character_end_ = never_on_bus;
}

void NativeLine::begin_input(BusTime now, const SerialCharacter& character, BusTime senders_bit) {
  if (is_connected_) {
    receiver_.begin(now, character, senders_bit);
  }
}

BusTime NativeLine::next_event() const {
  return is_connected_ ? std::min(receiver_.next_event(bit), character_end_) : never_on_bus;
}

void NativeLine::advance_to(BusTime now) {
  if (!is_connected_) {
    return;
  }
  while (const auto event = receiver_.take(now, bit)) {
    if (event->kind == SerialReceiver::Kind::character) {
      take_character(event->character);
    }
  }
  while (character_end_ <= now) {
    if (watch_) {
      watch_(character_end_, static_cast<std::uint8_t>(output_.at(sent_)));
    }
    ++sent_;
    character_end_ = sent_ < to_send_ ? character_end_ + serial_character_bits * bit : never_on_bus;
  }
}

void NativeLine::take_character(const SerialCharacter& character) {
  if (!character.has_stop_bit || input_.size() == input_size) {
    is_damaged_ = true;
    input_.clear();
  } else {
    input_.push_back(static_cast<char>(character.byte));
  }
}

std::size_t NativeLine::read_line(std::span<char> characters) {
  const std::size_t count = std::min(characters.size(), input_.size());
  const auto end = input_.begin() + static_cast<std::ptrdiff_t>(count);
  std::copy(input_.begin(), end, characters.begin());
  input_.erase(input_.begin(), end);
  return count;
}

std::span<char> NativeLine::line_room() {
  return is_connected_ && sent_ == to_send_ ? std::span<char>(output_) : std::span<char>();
}

void NativeLine::send_line(std::size_t count) {
  sent_ = 0;
  to_send_ = count;
  character_end_ = count > 0 ? bus_.now() + serial_character_bits * bit : never_on_bus;
}

}  // namespace proleg::sim
