#pragma once

#include "firmware/module/board.hpp"
#include "firmware/module/outbox.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::firmware {

/// The module as a node of the network (CiA 301, section 7.3.2): its state, boot-up and its own heartbeat.
class NetworkNode {
 public:
  NetworkNode(const Board& board, Outbox& outbox) : board_(board), outbox_(outbox) {}

  /// Boot-up follows after 1 to 16 ms, which depend on the unique id: of two modules with one node id that are switched
  /// on together, one hears the other.
  void start(Microseconds now);
  /// The boot-up message was lost.
  void repeat_boot_up(Microseconds now);
  void enter(canopen::NmtState state);

  /// `boot_up` until the boot-up message is sent.
  [[nodiscard]] canopen::NmtState state() const { return state_; }
  [[nodiscard]] bool started() const { return state_ != canopen::NmtState::boot_up || boot_up_at_ != never; }
  [[nodiscard]] bool operational() const { return state_ == canopen::NmtState::operational; }

  [[nodiscard]] std::uint16_t heartbeat_period_ms() const { return heartbeat_period_ms_; }
  /// The first heartbeat is due at once. 0: no heartbeats.
  void set_heartbeat_period(Microseconds now, std::uint16_t period_ms);

  void poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;

 private:
  void poll_boot_up(Microseconds now);
  void poll_heartbeat(Microseconds now);

  const Board& board_;
  Outbox& outbox_;
  canopen::NmtState state_ = canopen::NmtState::boot_up;
  Microseconds boot_up_at_ = never;
  std::uint16_t heartbeat_period_ms_ = 0;
  Microseconds heartbeat_at_ = never;
};

}  // namespace proleg::firmware
