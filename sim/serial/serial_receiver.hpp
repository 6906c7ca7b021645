#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace proleg::sim {

/// A character on an asynchronous serial line: a start bit (low), eight data bits, lowest first, and a stop bit.
struct SerialCharacter {
  std::uint8_t byte = 0;
  bool has_stop_bit = true;  ///< false: the line stays low instead of the stop bit, as in a break

  friend bool operator==(const SerialCharacter&, const SerialCharacter&) = default;
};
inline constexpr unsigned serial_character_bits = 10;

/// The receiving half of a UART. It samples the line in the middle of each bit, by its own bit time: a sender with
/// another baud rate leads to other characters, as on a real line. All times have one unit, which may be any.
class SerialReceiver {
 public:
  using Time = std::uint64_t;
  static constexpr Time never = ~Time{0};

  enum class Kind : std::uint8_t {
    character,
    idle,  ///< the line was high for the length of a character; once after each character
  };
  struct Event {
    Kind kind = Kind::character;
    SerialCharacter character;  ///< the received character; without a stop bit it is a framing error
    Time time = 0;              ///< of a character: middle of its stop bit
  };

  /// Sets the line high, with nothing received.
  void reset() { *this = SerialReceiver(); }
  /// A character begins on the line; the one before must have ended.
  void begin(Time start, const SerialCharacter& character, Time bit);

  /// Time of the next event if no character begins before; `never` if no event will occur. bit: the receiver's bit
  /// time.
  [[nodiscard]] Time next_event(Time bit) const;
  /// Takes the oldest event up to `now`.
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
  /// Time of the first falling edge after the last character.
  [[nodiscard]] Time next_start() const;
  [[nodiscard]] Time idle_time(Time bit) const;
  void forget_until(Time time);

  std::deque<Edge> edges_;  ///< edges after the last character received
  bool level_ = true;       ///< level before the first of edges_
  Time idle_from_ = never;  ///< end of the last character received; never: the line has been idle since
};

}  // namespace proleg::sim
