#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "firmware/module/board_record.hpp"
#include "firmware/module/tick_record.hpp"
#include "shared/canopen/power_state.hpp"
#include "sim/bus/controller.hpp"
#include "sim/serial/serial_line.hpp"

namespace proleg::sim {

/// The feedback potentiometer of each simulated joint, as its ADC of 12 bits reads it.
struct Potentiometer {
  static constexpr std::uint16_t at_minus_90 = 410;
  static constexpr std::uint16_t at_plus_90 = 3686;

  /// angle: 90 degrees = 2^30.
  [[nodiscard]] static constexpr std::uint16_t reading_of(std::int32_t angle) {
    constexpr std::int64_t right_angle = std::int64_t{1} << 30U;
    const std::int64_t reading = at_minus_90 + (angle + right_angle) * (at_plus_90 - at_minus_90) / (2 * right_angle);
    return static_cast<std::uint16_t>(std::clamp<std::int64_t>(reading, 0, firmware::BoardRecord::max_reading));
  }
};

/// A joint module on the simulated bus. This computer or a virtual chip runs its program.
class JointModule {
 public:
  virtual ~JointModule() = default;

  /// Switches it on, or restarts it: only its identity and its flash remain, and the servo goes
  /// limp.
  virtual void power_on(BusTime now) = 0;
  /// Time at which the module acts next.
  [[nodiscard]] virtual BusTime next_event() const = 0;
  /// Does what is due. The module gets no input before `quiet_until`, which is later than now, so a program that takes
  /// time to execute may be executed up to there.
  virtual void advance_to(BusTime now, BusTime quiet_until) = 0;

  // A part of advance_to() may be done before it, on another thread.
  /// Whether prepare() may be called with `from`, which is next_event() or later.
  [[nodiscard]] virtual bool can_prepare(BusTime /*from*/) const { return false; }
  /// Takes to the bus what its program has requested of it up to now. Before prepare(now, quiet_until).
  virtual void submit(BusTime /*now*/) {}
  /// Does the part of advance_to(from, a time not before quiet_until) that needs no bus. Between the two calls nothing
  /// else may be called that changes the module, and next_event() is `from`. Several modules may do it at a time, each
  /// on a thread of its own; the bus is shared (Bus::begin_sharing()), and the signals of their pins stand still. All
  /// functions that the module was given are called by advance_to(), except those that read signals.
  virtual void prepare(BusTime /*from*/, BusTime /*quiet_until*/) {}

  /// Called before its readings change, and before pulse(), with the time, which next_event() does not precede. What it
  /// measured before are the readings as they are.
  virtual void catch_up_before(BusTime /*time*/) {}

  /// Called before a restart: does what is due up to `until` without input. What it sends is lost.
  virtual void run_out(BusTime now, BusTime until) = 0;

  // What fails outside of the program, and comes back. It lasts over a restart.
  /// Of its chip, in mV; 3,300 from the start. Below the reset threshold the module has no power.
  virtual void set_supply(BusTime now, std::uint32_t mv) = 0;
  /// Whether its converter makes new measurements.
  virtual void set_adc(BusTime now, bool converts) = 0;
  /// Whether the crystal oscillates, and the PLL can lock. A native module has neither.
  virtual void set_crystal(BusTime /*now*/, bool /*runs*/) {}
  virtual void set_pll(BusTime /*now*/, bool /*locks*/) {}

  /// The state of its drive now, as its program has it. Meaningless while it has no power.
  [[nodiscard]] virtual canopen::PowerState power() const = 0;
  /// A pulse that the program requested, or that a virtual chip has measured at its pin when it ended.
  struct WatchedPulse {
    BusTime begin;
    std::int32_t width;                  ///< twelfths of a microsecond
    canopen::PowerState power;           ///< of the drive when it began
    std::optional<bool> follows_pulses;  ///< whether the servo had pulses before; nothing: not known
    bool is_whole = true;                ///< false: it was cut off, because the chip lost its power or its clock
  };
  /// To be set before power_on().
  using PulseWatch = std::function<void(const WatchedPulse&)>;
  virtual void set_pulse_watch(PulseWatch watch) = 0;
  /// Called when the program gives its servo a pulse width, in twelfths of a microsecond, with the time: of a virtual
  /// chip, of the instruction that writes the timer. To be set before power_on().
  using CommandWatch = std::function<void(BusTime time, std::int32_t width)>;
  virtual void set_command_watch(CommandWatch watch) = 0;

  /// A character begins at the input of its serial line (docs/board.md, gateway), with the sender's bit time in ns. The
  /// one before must be over. Lost while the module does not read its line.
  virtual void begin_serial_input(BusTime now, const SerialCharacter& character, BusTime bit) = 0;
  /// Called with each character that it sends on that line, and the time at which its stop bit ends, which may be a
  /// little later than that of the bus. To be set before power_on().
  using SerialWatch = std::function<void(BusTime time, std::uint8_t byte)>;
  virtual void set_serial_watch(SerialWatch watch) = 0;

  /// What it computed at its last tick.
  [[nodiscard]] virtual firmware::TickRecord last_tick() const = 0;
  /// The pulse that the servo gets, in twelfths of a microsecond; none if it is off.
  [[nodiscard]] virtual std::optional<std::int32_t> pulse() const = 0;
  /// Index of its controller.
  [[nodiscard]] virtual std::size_t controller() const = 0;

  /// A SYNC ends now; for modules that count what follows it.
  virtual void note_sync(std::uint32_t /*tick*/) {}
  /// A tick has begun without its SYNC.
  virtual void note_missing_sync() {}
  /// The oldest problem that this function has not returned yet, as text for a person: a fault of the program, a reset
  /// by the watchdog.
  [[nodiscard]] virtual std::optional<std::string> take_problem() { return std::nullopt; }
  /// Whether the last problem that take_problem() has returned ends the module: what a real one would do is not known.
  [[nodiscard]] virtual bool leaves_model() const { return false; }
};

/// Whether this tick is the last one that a module has computed, for its joint.
[[nodiscard]] inline bool has_computed(const firmware::TickRecord& record, unsigned joint, std::uint32_t tick) {
  return record.tick == tick && record.joint == joint;
}

}  // namespace proleg::sim
