#pragma once

#include <cstdint>

#include "shared/can/transmit_queue.hpp"

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

}  // namespace proleg::firmware
