#pragma once

// SYNC and TICK (CiA 301, section 7.2.5; docs/protocol.md): how a module produces them, and how each module finds the
// tick of a SYNC.

#include <cstdint>

#include "firmware/module/network_node.hpp"

namespace proleg::firmware {

/// Produces SYNC and TICK while it runs: TICK of tick 0, then SYNC 0, then a SYNC every period of the module's own
/// clock, without drift, and TICK before every tenth SYNC. TICK is passed to the queue 1 ms before its SYNC, or a tenth
/// of a period if that is less. SYNC 0 waits until TICK was sent, so that it cannot overtake it on a busy bus. Later
/// SYNCs may overtake their TICK: TickKeeper allows it.
class SyncProducer {
 public:
  static constexpr std::uint32_t ticks_between_announcements = 10;

  explicit SyncProducer(Outbox& outbox) : outbox_(outbox) {}

  /// Starts at tick 0; nothing changes if it runs already.
  void start(Microseconds now, std::uint32_t tick_period_us, std::uint32_t configuration_crc);
  void stop() { state_ = State::stopped; }
  [[nodiscard]] bool runs() const { return state_ != State::stopped; }

  /// Must be called when the controller has dropped its pending frames.
  void bus_off(Microseconds now);

  void poll(Microseconds now);
  /// Must be called when the controller has sent a frame of the module.
  void transmitted(Microseconds now, const CanFrame& frame);
  [[nodiscard]] Microseconds next_deadline() const;

 private:
  enum class State : std::uint8_t {
    stopped,
    starting,   ///< TICK 0 must be passed to the queue
    announced,  ///< TICK 0 is pending
    running,
  };

  [[nodiscard]] bool must_announce() const { return tick_ % ticks_between_announcements == 0 && !tick_sent_; }
  bool send_tick();
  void send_sync(Microseconds now);

  Outbox& outbox_;
  State state_ = State::stopped;
  bool tick_sent_ = false;  ///< whether TICK was sent before the next SYNC
  std::uint32_t tick_period_us_ = 0;
  std::uint32_t configuration_crc_ = 0;
  std::uint32_t lead_us_ = 0;
  std::uint32_t tick_ = 0;      ///< tick of the next SYNC
  Microseconds next_sync_ = 0;  ///< time of the next SYNC; in `starting`, of the next attempt to pass TICK 0
};

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
