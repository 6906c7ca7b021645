#pragma once

#include "firmware/module/outbox.hpp"

namespace proleg::firmware {

/// Produces SYNC and TICK (CiA 301, section 7.2.5; docs/protocol.md) while it runs: TICK of tick 0, then SYNC 0, then a
/// SYNC every period of the module's own clock, without drift, and TICK before every tenth SYNC. TICK is passed to the
/// queue 1 ms before its SYNC, or a tenth of a period if that is less. SYNC 0 waits until TICK was sent, so that it
/// cannot overtake it on a busy bus. Later SYNCs may overtake their TICK: TickKeeper allows it.
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

}  // namespace proleg::firmware
