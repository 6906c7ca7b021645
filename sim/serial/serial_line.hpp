#pragma once

// An asynchronous serial line: its characters, both halves of a UART, and the host at the other end of a module's line.

#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>

#include "sim/bus/controller.hpp"

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

/// The other end of a module's serial line: a host, or a substitute for one.
class SerialHost {
 public:
  /// Receives a character from the module; its stop bit ends at this time. A module whose program runs ahead of the bus
  /// may report it up to 200 us early: the answer of a host takes longer.
  virtual void received(BusTime time, std::uint8_t byte) = 0;
  /// Time at which it sends the next character; never_on_bus if it waits for a character.
  [[nodiscard]] virtual BusTime next_event() const = 0;
  /// Takes the character that begins now; nothing if none does. A character must end before the next one begins.
  [[nodiscard]] virtual std::optional<SerialCharacter> take(BusTime now) = 0;
  /// Duration of a bit that it sends, in ns.
  [[nodiscard]] virtual BusTime bit_time() const = 0;

 protected:
  ~SerialHost() = default;
};

}  // namespace proleg::sim
