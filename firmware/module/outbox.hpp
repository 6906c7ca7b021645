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
    const bool taken = open_ && queue_.push(frame);
    dropped_ += taken ? 0U : 1U;
    return taken;
  }
  /// To be called when the controller has sent a frame.
  void sent() { queue_.sent(); }
  void reset() {
    queue_.clear();
    open_ = true;
    dropped_ = 0;
  }

  /// The controller is bus-off: forgets what waits, and drops everything until open().
  void close() {
    queue_.clear();
    open_ = false;
  }
  void open() { open_ = true; }

  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }

 private:
  TransmitQueue queue_;
  bool open_ = true;
  std::uint32_t dropped_ = 0;
};

}  // namespace proleg::firmware
