#pragma once

#include <cstdint>

namespace proleg::firmware {

/// What is to be done at a SYNC.
struct SyncMeaning {
  enum class Action : std::uint8_t {
    none,
    compute,  ///< the tick of this SYNC, and `missed` ticks before it
    join,     ///< tick + 1 is the first that the module can compute
  };

  Action action = Action::none;
  std::uint8_t missed = 0;  ///< to compute: SYNCs that were not heard
  bool joined = false;      ///< to compute: these are the first ticks since the module joined
  std::uint32_t tick = 0;   ///< to join: the tick of this SYNC
  bool lost = false;        ///< the SYNC fits no tick that the module expected
};

/// Knows which tick a SYNC is: SYNC counts modulo 128, and TICK announces the absolute tick of the SYNC that follows
/// it. The coming tick of the module, which it computes at the next SYNC, is Kernel::tick().
class TickKeeper {
 public:
  /// So many SYNCs in a row may be missed without the tick being lost.
  static constexpr unsigned most_missed = 8;
  /// So many SYNCs may overtake the TICK that announces the first of them: its identifier is higher than those of SDOs.
  static constexpr unsigned most_late = 8;

  /// Knows no tick.
  void lose() { *this = {}; }

  /// TICK with this tick was heard. False if it contradicts the coming tick, which is lost then.
  /// One that comes late, or that tells of SYNCs missed, is no contradiction.
  [[nodiscard]] bool announce(std::uint32_t tick, std::uint32_t coming);
  /// SYNC with this counter, 1 to 128, was heard.
  [[nodiscard]] SyncMeaning sync(std::uint8_t counter, std::uint32_t coming);

  /// Whether the coming tick is known.
  [[nodiscard]] bool keeps_tick() const { return state_ != State::lost; }
  /// Whether a tick was computed since, so that the set-point is that of the robot's tick.
  [[nodiscard]] bool synchronised() const { return state_ == State::computing; }

 private:
  enum class State : std::uint8_t { lost, joining, computing };

  State state_ = State::lost;
  bool announced_ = false;
  std::uint32_t announced_tick_ = 0;
};

}  // namespace proleg::firmware
