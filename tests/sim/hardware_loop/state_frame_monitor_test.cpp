#include "sim/hardware_loop/state_frame_monitor.hpp"

#include <gtest/gtest.h>

#include "shipped.hpp"

namespace proleg::sim {
namespace {

CanFrame state_frame(unsigned identifier, std::uint8_t label) {
  CanFrame frame{static_cast<std::uint16_t>(identifier), 8, {}};
  frame.data[7] = label;
  return frame;
}

class StateFrames : public testing::Test {
 protected:
  void note(unsigned sender, unsigned node, std::uint8_t label) {
    monitor_.note({0, 0, state_frame(canopen::identifier::state_frame + node, label), sender});
  }

  Scenario scenario_ = shipped("travelling_wave/coupled");  // joint j has node j + 1
  StateFrameMonitor monitor_{scenario_};
};

TEST_F(StateFrames, AfterSyncKAreThoseWithTheLabelKPlus1) {
  monitor_.begin_tick(300);
  note(2, 3, 300 % 256);
  EXPECT_FALSE(monitor_.has_sent(2)) << "label of the tick before";
  note(2, 3, 301 % 256);
  EXPECT_TRUE(monitor_.has_sent(2));
  EXPECT_FALSE(monitor_.has_sent(1));
  monitor_.begin_tick(301);
  EXPECT_FALSE(monitor_.has_sent(2));
}

TEST_F(StateFrames, CountOnlyIfTheModuleOfTheNodeSendsThem) {
  monitor_.begin_tick(7);
  note(5, 3, 8);
  note(1, 3, 8);
  EXPECT_FALSE(monitor_.has_sent(1));
  EXPECT_FALSE(monitor_.has_sent(2));
}

TEST_F(StateFrames, AreLostByTickSenderChannelAndReceiver) {
  const Losses losses({{8, 2, 0, 1}, {8, 2, 1, 0}});
  monitor_.begin_tick(7);
  const CanFrame first = state_frame(canopen::identifier::state_frame + 3, 8);
  const CanFrame second = state_frame(canopen::identifier::second_state + 3, 8);
  EXPECT_TRUE(monitor_.is_lost(losses, first, 1));
  EXPECT_FALSE(monitor_.is_lost(losses, first, 0));
  EXPECT_TRUE(monitor_.is_lost(losses, second, 0));
  EXPECT_FALSE(monitor_.is_lost(losses, second, 1));
  EXPECT_FALSE(monitor_.is_lost(losses, state_frame(canopen::identifier::state_frame + 2, 8), 1)) << "other sender";
  EXPECT_FALSE(monitor_.is_lost(losses, state_frame(canopen::identifier::state_frame + 99, 8), 1)) << "unknown node";
  monitor_.begin_tick(8);
  EXPECT_FALSE(monitor_.is_lost(losses, first, 1)) << "other tick";
}

TEST_F(StateFrames, AloneAreLost) {
  const Losses losses(RandomLosses{1, 0xFFFF'FFFF, 0, 100});
  monitor_.begin_tick(7);
  EXPECT_TRUE(monitor_.is_lost(losses, state_frame(canopen::identifier::state_frame + 3, 8), 1));
  EXPECT_FALSE(monitor_.is_lost(losses, state_frame(canopen::identifier::sdo_request + 3, 8), 1));
  EXPECT_FALSE(monitor_.is_lost(losses, state_frame(canopen::identifier::state_frame, 8), 1)) << "node 0";
  EXPECT_FALSE(monitor_.is_lost(losses, state_frame(canopen::identifier::state_frame + 3, 8), 5)) << "the host";
}

}  // namespace
}  // namespace proleg::sim
