#pragma once

#include "firmware/module/outbox.hpp"

namespace proleg::firmware {

/// Produces SYNC and TICK (CiA 301, section 7.2.5; docs/protocol.md) while it runs: TICK of tick 0, then SYNC 0, then a
/// SYNC every period of the module's own clock, without drift, and TICK before every tenth. TICK is handed over 1 ms
/// before its SYNC, or a tenth of a period if that is less. SYNC 0 follows TICK when that was sent, so that on a busy
/// bus it cannot overtake it; later ones may, and nobody minds (TickKeeper).
class SyncProducer {
 public:
  static constexpr std::uint32_t ticks_between_announcements = 10;

  explicit SyncProducer(Outbox& outbox) : outbox_(outbox) {}

  /// Begins at tick 0; nothing changes if it runs already.
  void start(Microseconds now, std::uint32_t tick_period_us, std::uint32_t configuration_crc);
  void stop() { state_ = State::stopped; }
  [[nodiscard]] bool runs() const { return state_ != State::stopped; }

  /// The controller has forgotten what it had to send.
  void bus_off(Microseconds now);

  void poll(Microseconds now);
  /// The controller has sent a frame of the module.
  void transmitted(Microseconds now, const CanFrame& frame);
  [[nodiscard]] Microseconds next_deadline() const;

 private:
  enum class State : std::uint8_t {
    stopped,
    starting,   ///< TICK 0 is to be handed over
    announced,  ///< TICK 0 is on its way
    running,
  };

  [[nodiscard]] bool to_be_announced() const { return tick_ % ticks_between_announcements == 0 && !tick_sent_; }
  bool send_tick();
  void send_sync(Microseconds now);

  Outbox& outbox_;
  State state_ = State::stopped;
  bool tick_sent_ = false;  ///< before the next SYNC
  std::uint32_t tick_period_us_ = 0;
  std::uint32_t configuration_crc_ = 0;
  std::uint32_t lead_us_ = 0;
  std::uint32_t tick_ = 0;      ///< of the next SYNC
  Microseconds next_sync_ = 0;  ///< starting: the next attempt to hand over TICK 0
};

}  // namespace proleg::firmware
