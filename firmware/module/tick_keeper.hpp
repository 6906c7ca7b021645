#pragma once

#include <cstdint>

namespace proleg::firmware {

/// What a module must do at a SYNC.
struct SyncMeaning {
  enum class Action : std::uint8_t {
    none,
    compute,  ///< the tick of this SYNC, and `missed` ticks before it
    join,     ///< tick + 1 is the first that the module can compute
  };

  Action action = Action::none;
  std::uint8_t missed = 0;  ///< of compute: SYNCs that were not received
  bool joined = false;      ///< of compute: these are the first ticks since the module joined
  std::uint32_t tick = 0;   ///< of join: the tick of this SYNC
  bool lost = false;        ///< the SYNC fits no tick that the module expected
};

/// Finds the tick of a SYNC: SYNC counts modulo 128, and TICK announces the absolute tick of the SYNC that follows it.
/// The coming tick of the module, which it computes at the next SYNC, is Kernel::tick().
class TickKeeper {
 public:
  /// Successive SYNCs that may be missed without the tick being lost.
  static constexpr unsigned max_missed = 8;
  /// SYNCs that may overtake the TICK that announces the first of them: its identifier is higher than those of SDOs.
  static constexpr unsigned max_late = 8;

  /// From now on no tick is known.
  void lose() { *this = {}; }

  /// TICK with this tick was received. False if it contradicts the coming tick, which is lost then. A late TICK is no
  /// contradiction, nor one after missed SYNCs.
  [[nodiscard]] bool announce(std::uint32_t tick, std::uint32_t coming);
  /// SYNC with this counter, 1 to 128, was received.
  [[nodiscard]] SyncMeaning sync(std::uint8_t counter, std::uint32_t coming);

  /// Whether the coming tick is known.
  [[nodiscard]] bool keeps_tick() const { return state_ != State::lost; }
  /// Whether a tick was computed since it is known, so that the set-point is that of the robot's tick.
  [[nodiscard]] bool synchronised() const { return state_ == State::computing; }

 private:
  enum class State : std::uint8_t { lost, joining, computing };

  State state_ = State::lost;
  bool announced_ = false;
  std::uint32_t announced_tick_ = 0;
};

}  // namespace proleg::firmware
