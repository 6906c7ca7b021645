#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace proleg::sim {

/// A character on an asynchronous serial line: a start bit (low), eight data bits, lowest first, and a stop bit.
struct SerialCharacter {
  std::uint8_t byte = 0;
  bool has_stop_bit = true;  ///< false: the line stays low in its place, as in a break

  friend bool operator==(const SerialCharacter&, const SerialCharacter&) = default;
};
inline constexpr unsigned serial_character_bits = 10;

/// The receiving half of a UART. It samples the line in the middle of each bit, by its own bit time: a sender with
/// another baud rate leads to other characters, as on a real line. Times are of any unit, all of one.
class SerialReceiver {
 public:
  using Time = std::uint64_t;
  static constexpr Time never = ~Time{0};

  enum class Kind : std::uint8_t {
    character,
    idle,  ///< the line was high for a whole character, the first time since the last character
  };
  struct Event {
    Kind kind = Kind::character;
    SerialCharacter character;  ///< has_stop_bit false: a framing error
    Time time = 0;              ///< of a character: the middle of its stop bit
  };

  /// The line is high, and nothing was received.
  void reset() { *this = SerialReceiver(); }
  /// A character begins on the line. The one before must be over.
  void begin(Time start, const SerialCharacter& character, Time bit);

  /// When the next event occurs if no character begins before; `never`: there is none. bit: the receiver's.
  [[nodiscard]] Time next_event(Time bit) const;
  /// The oldest event up to `now` that was not taken yet.
  [[nodiscard]] std::optional<Event> take(Time now, Time bit);
  /// Whether a character is being received at this time, or an event has not been taken.
  [[nodiscard]] bool is_busy() const { return !edges_.empty() || idle_from_ != never; }

 private:
  struct Edge {
    Time time;
    bool high;
  };

  void add_edge(Time time, bool high);
  [[nodiscard]] bool level_at(Time time) const;
  /// The first falling edge that no character has taken.
  [[nodiscard]] Time next_start() const;
  [[nodiscard]] Time idle_time(Time bit) const;
  void forget_until(Time time);

  std::deque<Edge> edges_;  ///< after the last character received
  bool level_ = true;       ///< before the first of them
  Time idle_from_ = never;  ///< the end of the last character received; never: the line has been idle since
};

}  // namespace proleg::sim
