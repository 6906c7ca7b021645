#pragma once

#include <deque>
#include <span>

#include "sim/bus/bus.hpp"

namespace proleg::sim {

/// A frame that somebody else sends on the bus, right after a SYNC.
struct InjectedFrame {
  std::uint32_t tick;
  CanFrame frame;
};

/// A node that sends what it is told to and does not listen.
class Injector final : private BusListener {
 public:
  /// Attaches to the bus. frames: by ascending tick; they must outlive the injector.
  Injector(Bus& bus, std::span<const InjectedFrame> frames) : frames_(frames), controller_(bus.attach(*this)) {}
  Injector(const Injector&) = delete;
  Injector& operator=(const Injector&) = delete;

  /// SYNC of this tick was heard.
  void advance_to(std::uint32_t tick) {
    for (; !frames_.empty() && frames_.front().tick <= tick; frames_ = frames_.subspan(1)) {
      waiting_.push_back(frames_.front().frame);
    }
    send();
  }

 private:
  void received(BusTime /*time*/, const CanFrame& /*frame*/) override {}
  void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override { send(); }

  void send() {
    while (!waiting_.empty() && controller_.send(waiting_.front())) {
      waiting_.pop_front();
    }
  }

  std::span<const InjectedFrame> frames_;
  std::deque<CanFrame> waiting_;
  Controller& controller_;
};

}  // namespace proleg::sim
