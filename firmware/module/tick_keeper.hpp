#pragma once

#include <cstdint>

namespace proleg::firmware {

/// The action that a SYNC demands of a module.
struct SyncMeaning {
  enum class Action : std::uint8_t {
    none,
    compute,  ///< compute the tick of this SYNC, and `missed` ticks before it
    join,     ///< join: the module can first compute tick + 1
  };

  Action action = Action::none;
  std::uint8_t missed = 0;  ///< with compute: number of SYNCs that were not received
  bool joined = false;      ///< with compute: these are the first ticks since the module joined
  std::uint32_t tick = 0;   ///< with join: the tick of this SYNC
  bool lost = false;        ///< the SYNC fits no tick that the module expected
};

/// Finds the tick of a SYNC: SYNC counts modulo 128, and TICK announces the absolute tick of the SYNC that follows it.
/// The coming tick of the module, which it computes at the next SYNC, is Kernel::tick().
class TickKeeper {
 public:
  /// Number of successive SYNCs that may be missed while the tick stays known.
  static constexpr unsigned max_missed = 8;
  /// Number of SYNCs that may overtake the TICK that announces the first of them: TICK's identifier is higher than
  /// those of SDOs.
  static constexpr unsigned max_late = 8;

  /// Forgets the tick.
  void lose() { *this = {}; }

  /// Must be called when TICK with this tick was received. False if it contradicts the coming tick, which is lost then.
  /// A late TICK is no contradiction, nor is one after missed SYNCs.
  [[nodiscard]] bool announce(std::uint32_t tick, std::uint32_t coming);
  /// Must be called when SYNC with this counter, 1 to 128, was received.
  [[nodiscard]] SyncMeaning sync(std::uint8_t counter, std::uint32_t coming);

  /// Whether the coming tick is known.
  [[nodiscard]] bool keeps_tick() const { return state_ != State::lost; }
  /// Whether a tick was computed since the tick is known, so that the set-point is that of the robot's tick.
  [[nodiscard]] bool synchronised() const { return state_ == State::computing; }

 private:
  enum class State : std::uint8_t { lost, joining, computing };

  State state_ = State::lost;
  bool announced_ = false;
  std::uint32_t announced_tick_ = 0;
};

}  // namespace proleg::firmware
