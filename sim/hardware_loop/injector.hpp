#pragma once

#include <deque>
#include <span>

#include "sim/bus/bus.hpp"

namespace proleg::sim {

/// A frame that a node other than host and modules sends on the bus, right after a SYNC.
struct InjectedFrame {
  std::uint32_t tick;
  CanFrame frame;
};

/// A node that sends given frames and ignores what it receives.
class Injector final : private BusListener {
 public:
  /// Attaches to the bus. frames: by ascending tick; they must outlive the injector.
  Injector(Bus& bus, std::span<const InjectedFrame> frames) : frames_(frames), controller_(bus.attach(*this)) {}
  Injector(const Injector&) = delete;
  Injector& operator=(const Injector&) = delete;

  /// Sends a frame now, after those that wait.
  void send_now(const CanFrame& frame) {
    pending_.push_back(frame);
    send();
  }

  /// At the SYNC of this tick: sends the frames that are due.
  void advance_to(std::uint32_t tick) {
    for (; !frames_.empty() && frames_.front().tick <= tick; frames_ = frames_.subspan(1)) {
      pending_.push_back(frames_.front().frame);
    }
    send();
  }

 private:
  void received(BusTime /*time*/, const CanFrame& /*frame*/) override {}
  void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override { send(); }

  void send() {
    while (!pending_.empty() && controller_.send(pending_.front())) {
      pending_.pop_front();
    }
  }

  std::span<const InjectedFrame> frames_;
  std::deque<CanFrame> pending_;
  Controller& controller_;
};

}  // namespace proleg::sim
