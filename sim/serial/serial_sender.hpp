#pragma once

#include <deque>
#include <optional>
#include <string_view>

#include "sim/bus/controller.hpp"
#include "sim/serial/serial_receiver.hpp"

namespace proleg::sim {

/// The sending half of a UART: characters that wait go out one after the other, at a baud rate.
class SerialSender {
 public:
  /// baud: 1 to 1,000,000,000.
  explicit SerialSender(std::uint32_t baud) : bit_(ns_per_second / baud) {}

  /// Characters begin at `now` or, behind those that wait, later.
  void send(BusTime now, std::string_view characters);
  void send(BusTime now, const SerialCharacter& character);
  /// Forgets those that wait.
  void clear() { pending_.clear(); }

  /// When the next character begins; never_on_bus if none waits.
  [[nodiscard]] BusTime next_event() const { return pending_.empty() ? never_on_bus : pending_.front().start; }
  /// The character that begins at next_event(), if that is due.
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
  BusTime free_at_ = 0;  ///< the end of the last character
  std::deque<Pending> pending_;
};

}  // namespace proleg::sim
