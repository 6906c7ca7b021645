#pragma once

// The module on the network: the queue of the frames that it sends, and its state as a node (CiA 301, section 7.3.2).

#include <cstdint>

#include "firmware/module/module_identity.hpp"
#include "shared/can/transmit_queue.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::firmware {

/// Sends all frames of a module. A frame that finds the queue full is dropped and counted: it would be out of date
/// before it is sent.
class Outbox {
 public:
  explicit Outbox(CanPort& port) : queue_(port) {}

  /// Whether the frame was accepted.
  bool send(const CanFrame& frame) { return count(open_ && queue_.push(frame)); }
  /// Sends a message that is sent again and again: only the newest one with its identifier waits. Returns whether it
  /// was accepted.
  bool send_newest(const CanFrame& frame) { return count(open_ && queue_.push_newest(frame)); }
  /// Whether no frame waits for a mailbox.
  [[nodiscard]] bool is_empty() const { return queue_.size() == 0; }
  /// Must be called when the controller has sent a frame.
  void sent() { queue_.sent(); }
  void reset() {
    queue_.clear();
    open_ = true;
    dropped_ = 0;
  }

  /// Must be called when the controller is bus-off: drops pending frames, and all frames until open().
  void close() {
    queue_.clear();
    open_ = false;
  }
  void open() { open_ = true; }

  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }

 private:
  bool count(bool is_accepted) {
    dropped_ += is_accepted ? 0U : 1U;
    return is_accepted;
  }

  TransmitQueue queue_;
  bool open_ = true;
  std::uint32_t dropped_ = 0;
};

/// The module as a node of the network: its state, boot-up and its own heartbeat.
class NetworkNode {
 public:
  NetworkNode(const ModuleIdentity& identity, Outbox& outbox) : identity_(identity), outbox_(outbox) {}

  /// Starts the communication. With a node id, boot-up follows after boot_up_delay_us(); without one, nothing follows.
  void start(Microseconds now);
  /// Whether the module was started without a node id, and waits for LSS to give it one.
  [[nodiscard]] bool waits_for_node() const { return waits_for_node_; }
  /// Must be called when the boot-up message was lost.
  void repeat_boot_up(Microseconds now);
  /// Must be called when the controller has sent a frame. True if it is the boot-up message: from then on the network
  /// knows the module.
  [[nodiscard]] bool confirm_boot_up(const CanFrame& frame);
  [[nodiscard]] bool has_sent_boot_up() const { return has_sent_boot_up_; }
  void enter(canopen::NmtState state);
  /// Must be called when another node has sent with an identifier of this node. False if a collision was noticed
  /// before, since start().
  [[nodiscard]] bool notice_collision(std::uint16_t identifier);
  [[nodiscard]] bool has_collided() const { return collision_ != 0; }
  /// Identifier of the first collision; 0: there was none.
  [[nodiscard]] std::uint16_t collision() const { return collision_; }

  /// NMT state; `boot_up` until the boot-up message is in the queue.
  [[nodiscard]] canopen::NmtState state() const { return state_; }
  [[nodiscard]] bool started() const { return state_ != canopen::NmtState::boot_up || boot_up_at_ != never; }
  [[nodiscard]] bool operational() const { return state_ == canopen::NmtState::operational; }

  [[nodiscard]] std::uint16_t heartbeat_period_ms() const { return heartbeat_period_ms_; }
  /// Sets the period of heartbeats; 0: none. The first one is due at once.
  void set_heartbeat_period(Microseconds now, std::uint16_t period_ms);

  /// Sends what is due. Returns whether the module has left the state `boot_up` by this call.
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
