#pragma once

#include <deque>
#include <optional>
#include <string_view>

#include "sim/bus/controller.hpp"
#include "sim/serial/serial_receiver.hpp"

namespace proleg::sim {

/// The sending half of a UART: it sends waiting characters one after the other, at a baud rate.
class SerialSender {
 public:
  /// baud: 1 to 1,000,000,000.
  explicit SerialSender(std::uint32_t baud) : bit_(ns_per_second / baud) {}

  /// Sends characters from `now` on, or later if others wait.
  void send(BusTime now, std::string_view characters);
  void send(BusTime now, const SerialCharacter& character);
  /// Removes the waiting characters.
  void clear() { pending_.clear(); }

  /// Time at which the next character begins; never_on_bus if none waits.
  [[nodiscard]] BusTime next_event() const { return pending_.empty() ? never_on_bus : pending_.front().start; }
  /// Takes the character that begins at next_event(), if it is due.
  [[nodiscard]] std::optional<SerialCharacter> take(BusTime now);
  [[nodiscard]] BusTime bit_time() const { return bit_; }
  [[nodiscard]] std::size_t pending() const { return pending_.size(); }

 private:
  static constexpr BusTime ns_per_second = 1'000'000'000;
  struct Pending {
    BusTime start;
    SerialCharacter character;
  };

  BusTime bit_;
  BusTime free_at_ = 0;  ///< end of the last character
  std::deque<Pending> pending_;
};

}  // namespace proleg::sim
