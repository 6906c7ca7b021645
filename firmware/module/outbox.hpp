#pragma once

#include <cstdint>

#include "shared/can/transmit_queue.hpp"

namespace proleg::firmware {

/// The way out for all frames of a module. What finds no room is dropped and counted: whoever fills the queue would
/// only send older news later.
class Outbox {
 public:
  explicit Outbox(CanPort& port) : queue_(port) {}

  /// Whether the frame was taken.
  bool send(const CanFrame& frame) {
    const bool taken = queue_.push(frame);
    dropped_ += taken ? 0U : 1U;
    return taken;
  }
  /// To be called when the controller has sent a frame.
  void sent() { queue_.sent(); }
  void reset() {
    queue_.clear();
    dropped_ = 0;
  }

  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }

 private:
  TransmitQueue queue_;
  std::uint32_t dropped_ = 0;
};

}  // namespace proleg::firmware
