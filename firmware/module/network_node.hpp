#pragma once

#include "firmware/module/module_identity.hpp"
#include "firmware/module/outbox.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::firmware {

/// The module as a node of the network (CiA 301, section 7.3.2): its state, boot-up and its own heartbeat.
class NetworkNode {
 public:
  NetworkNode(const ModuleIdentity& identity, Outbox& outbox) : identity_(identity), outbox_(outbox) {}

  /// Without a node id nothing follows. Else boot-up follows after boot_up_delay_us().
  void start(Microseconds now);
  /// Since start() without a node id: the module waits for LSS to give it one.
  [[nodiscard]] bool waits_for_node() const { return waits_for_node_; }
  /// The boot-up message was lost.
  void repeat_boot_up(Microseconds now);
  /// The controller has sent a frame. True if it is the boot-up message: from then on the network knows of the module.
  [[nodiscard]] bool confirm_boot_up(const CanFrame& frame);
  [[nodiscard]] bool has_sent_boot_up() const { return has_sent_boot_up_; }
  void enter(canopen::NmtState state);
  /// Another node has sent with this identifier, which is one of this node's. False: a collision was noticed before,
  /// since start().
  [[nodiscard]] bool notice_collision(std::uint16_t identifier);
  [[nodiscard]] bool has_collided() const { return collision_ != 0; }
  /// The identifier of the first collision; 0: there was none.
  [[nodiscard]] std::uint16_t collision() const { return collision_; }

  /// `boot_up` until the boot-up message is in the queue.
  [[nodiscard]] canopen::NmtState state() const { return state_; }
  [[nodiscard]] bool started() const { return state_ != canopen::NmtState::boot_up || boot_up_at_ != never; }
  [[nodiscard]] bool operational() const { return state_ == canopen::NmtState::operational; }

  [[nodiscard]] std::uint16_t heartbeat_period_ms() const { return heartbeat_period_ms_; }
  /// The first heartbeat is due at once. 0: no heartbeats.
  void set_heartbeat_period(Microseconds now, std::uint16_t period_ms);

  /// Whether the module has left the state `boot_up` now.
  [[nodiscard]] bool poll(Microseconds now);
  [[nodiscard]] Microseconds next_deadline() const;

 private:
  [[nodiscard]] bool poll_boot_up(Microseconds now);
  void poll_heartbeat(Microseconds now);

  const ModuleIdentity& identity_;
  Outbox& outbox_;
  canopen::NmtState state_ = canopen::NmtState::boot_up;
  bool waits_for_node_ = false;
  bool has_sent_boot_up_ = false;
  std::uint16_t collision_ = 0;
  Microseconds boot_up_at_ = never;
  std::uint16_t heartbeat_period_ms_ = 0;
  Microseconds heartbeat_at_ = never;
};

}  // namespace proleg::firmware
