#pragma once

// LSS slaves on the simulated bus, for tests of LSS masters.

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "shared/canopen/lss_slave.hpp"
#include "sim/bus/bus.hpp"

namespace proleg::canopen {

/// A node with an LSS slave. It boots when it gets a node id, or is reset, and has faults that a test chooses.
class SlaveNode final : public sim::BusListener, LssStorage {
 public:
  SlaveNode(sim::Bus& bus, const LssAddress& its_address) : address(its_address), controller_(bus.attach(*this)) {}

  /// Makes a node without a node id.
  void power_on() {
    slave_ = {};
    node = 0;
  }

  LssAddress address;
  std::uint8_t node = 0;
  std::vector<std::uint8_t> stored;
  Result store_result;
  bool boots = true;
  unsigned answers_left = ~0U;       ///< number of answers before it is silent
  std::uint8_t refuses_service = 0;  ///< service that it answers with error 1
  lss::Service ignores{};            ///< service that it does not answer
  unsigned answered = 0;
  unsigned resets = 0;

 private:
  void received(sim::BusTime /*time*/, const CanFrame& frame) override {
    std::optional<CanFrame> answer = slave_.serve(frame, address, node, *this);
    if (answer && answers_left > 0 && lss::service_of(*answer) != ignores) {
      --answers_left;
      ++answered;
      answer->data[1] = answer->data[0] == refuses_service ? 1 : answer->data[1];
      EXPECT_TRUE(controller_.send(*answer));
    }
    const bool is_released = node == 0 && slave_.state() == lss::State::waiting;
    const bool is_reset = frame == encode(NmtRequest{NmtCommand::reset_node, 0}) ||
                          (node != 0 && frame == encode(NmtRequest{NmtCommand::reset_node, node}));
    resets += is_reset ? 1U : 0U;
    if ((is_released || is_reset) && slave_.pending_node() != 0 && boots) {
      node = slave_.pending_node();
      EXPECT_TRUE(controller_.send(encode(Heartbeat{node, NmtState::boot_up})));
    }
  }
  void transmitted(sim::BusTime /*time*/, const CanFrame& /*frame*/) override {}
  [[nodiscard]] Result store_node(std::uint8_t its_node) override {
    stored.push_back(its_node);
    return store_result;
  }

  LssSlave slave_;
  sim::Controller& controller_;
};

}  // namespace proleg::canopen
