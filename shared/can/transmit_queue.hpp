#pragma once

#include <array>
#include <cstddef>

#include "shared/can/can_port.hpp"

namespace proleg {

/// Frames that wait for a mailbox of the controller: lower identifiers first, equal ones in the order of their push().
class TransmitQueue {
 public:
  static constexpr std::size_t capacity = 16;

  explicit TransmitQueue(CanPort& port) : port_(port) {}

  /// Sends the frame now or queues it. False, without an effect, if the queue is full.
  [[nodiscard]] bool push(const CanFrame& frame);
  /// Sends or queues a message that is sent again and again. It replaces one with the same identifier that waits, since
  /// that one is out of date. So each message needs one buffer, and a node that was alone on the bus does not send a
  /// backlog.
  [[nodiscard]] bool push_newest(const CanFrame& frame);
  /// Must be called when the controller has sent a frame.
  void sent();
  void clear() { size_ = 0; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void hand_over();

  CanPort& port_;
  std::array<CanFrame, capacity> frames_;
  std::size_t size_ = 0;
};

}  // namespace proleg
