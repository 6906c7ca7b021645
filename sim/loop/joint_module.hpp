#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "firmware/module/tick_record.hpp"
#include "sim/bus/controller.hpp"

namespace proleg::sim {

/// A joint module on the simulated bus, whatever runs its program: this computer, or a virtual chip.
class JointModule {
 public:
  virtual ~JointModule() = default;

  /// Switches it on, or restarts it: nothing is known but the board, the servo goes limp.
  virtual void power_on(BusTime now) = 0;
  /// When it wants to do something next.
  [[nodiscard]] virtual BusTime next_event() const = 0;
  /// Does what is due. Nothing reaches the module from outside before `quiet_until`, which is later than now: a program
  /// that takes time to execute may be executed up to there.
  virtual void advance_to(BusTime now, BusTime quiet_until) = 0;

  /// Before it is restarted: does what is due up to `until`, by itself. What it sends is lost.
  virtual void run_out(BusTime now, BusTime until) = 0;

  /// What it computed last.
  [[nodiscard]] virtual firmware::TickRecord last_tick() const = 0;
  /// The pulse that the servo gets, in twelfths of a microsecond; none if it is off.
  [[nodiscard]] virtual std::optional<std::int32_t> pulse() const = 0;
  /// Index of its controller.
  [[nodiscard]] virtual std::size_t controller() const = 0;

  /// SYNC is heard now; for those who count what follows.
  virtual void note_sync(std::uint32_t /*tick*/) {}
  /// What went wrong with it since it was asked last, as text for a person, oldest first: a fault of the program, a
  /// reset by the watchdog.
  [[nodiscard]] virtual std::optional<std::string> take_problem() { return std::nullopt; }
};

/// Whether a module has computed this tick of its joint, and nothing since.
[[nodiscard]] inline bool has_computed(const firmware::TickRecord& record, unsigned joint, std::uint32_t tick) {
  return record.tick == tick && record.joint == joint;
}

}  // namespace proleg::sim
