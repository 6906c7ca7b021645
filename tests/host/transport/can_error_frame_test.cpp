
#include <gtest/gtest.h>

#include "host/transport/can_socket.hpp"

namespace proleg::host {
namespace {

// The bits are those of Linux, include/uapi/linux/can/error.h.
can_frame error_frame(canid_t classes, std::array<std::uint8_t, 8> data = {}) {
  can_frame frame{};
  frame.can_id = 0x20000000U | classes;
  frame.can_dlc = 8;
  std::copy(data.begin(), data.end(), frame.data);
  return frame;
}

TEST(CanErrorFrame, HasTheStateOfTheController) {
  const CanStatus active;
  EXPECT_EQ(read_can_error(error_frame(0x04, {0, 0x08}), active).status.state, CanState::error_warning);
  EXPECT_EQ(read_can_error(error_frame(0x04, {0, 0x04}), active).status.state, CanState::error_warning);
  EXPECT_EQ(read_can_error(error_frame(0x04, {0, 0x30}), active).status.state, CanState::error_passive);
  EXPECT_EQ(read_can_error(error_frame(0x40), active).status, (CanStatus{CanState::bus_off, 0, 256}));
}

TEST(CanErrorFrame, HasCountersSinceLinux5_18) {
  const auto report = read_can_error(error_frame(0x204, {0, 0x20, 0, 0, 0, 0, 128, 7}), {});
  EXPECT_EQ(report.status, (CanStatus{CanState::error_passive, 7, 128}));
}

TEST(CanErrorFrame, KeepsTheStateThatItDoesNotName) {
  const CanStatus passive{CanState::error_passive, 7, 128};
  EXPECT_EQ(read_can_error(error_frame(0x20), passive).status, passive);
}

TEST(CanErrorFrame, SaysThatTheControllerIsActiveAgain) {
  const CanStatus off{CanState::bus_off, 0, 256};
  const auto restarted = read_can_error(error_frame(0x100), off);
  EXPECT_EQ(restarted.status, CanStatus{});
  EXPECT_TRUE(restarted.was_restarted);
  EXPECT_EQ(read_can_error(error_frame(0x04, {0, 0x40}), off).status, CanStatus{});
}

TEST(CanErrorFrame, HasKindsOfErrors) {
  const auto kinds = [](const can_frame& frame) { return read_can_error(frame, {}).errors; };
  EXPECT_TRUE(kinds(error_frame(0x20)).contains(CanErrorKind::acknowledgement));
  EXPECT_TRUE(kinds(error_frame(0x88, {0, 0, 0, 0x19})).contains(CanErrorKind::acknowledgement));
  EXPECT_TRUE(kinds(error_frame(0x88, {0, 0, 0, 0x08})).contains(CanErrorKind::crc));
  EXPECT_TRUE(kinds(error_frame(0x88, {0, 0, 0x02})).contains(CanErrorKind::form));
  EXPECT_TRUE(kinds(error_frame(0x88, {0, 0, 0x04})).contains(CanErrorKind::stuff));
  EXPECT_TRUE(kinds(error_frame(0x88, {0, 0, 0x08})).contains(CanErrorKind::bit_dominant));
  EXPECT_TRUE(kinds(error_frame(0x88, {0, 0, 0x10})).contains(CanErrorKind::bit_recessive));
  EXPECT_TRUE(kinds(error_frame(0x04, {0, 0x01})).contains(CanErrorKind::receive_overrun));
  EXPECT_TRUE(kinds(error_frame(0x04, {0, 0x02})).contains(CanErrorKind::transmit_overrun));
  EXPECT_TRUE(kinds(error_frame(0x02, {0, 0xFF, 0xFF, 0x19})).empty()) << "bytes of other classes are ignored";
}

TEST(CanSocket, TakesStandardDataFramesOnly) {
  can_frame frame{};
  frame.can_id = 0x181;
  frame.can_dlc = 2;
  frame.data[0] = 1;
  frame.data[1] = 2;
  frame.data[2] = 0xFF;  // not part of the frame
  EXPECT_EQ(protocol_frame(frame), (CanFrame{0x181, 2, {1, 2}}));
  for (const canid_t flag : {CAN_EFF_FLAG, CAN_RTR_FLAG, CAN_ERR_FLAG}) {
    can_frame other = frame;
    other.can_id |= flag;
    EXPECT_EQ(protocol_frame(other), std::nullopt);
  }
}

}  // namespace
}  // namespace proleg::host
