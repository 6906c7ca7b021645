// A module that produces SYNC and TICK by its own clock.

#include "test_robot.hpp"

namespace proleg {
namespace {

using canopen::AbortCode;
using canopen::NmtCommand;

constexpr std::uint32_t produces = canopen::produces_sync | canopen::identifier::sync;

class Producer : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(OfTickPeriods, Producer, testing::Values(2'000, 9'999, 10'000, 100'000));

TEST_P(Producer, CountsTicksWithoutDriftAndAnnouncesEveryTenth) {
  const std::uint32_t period = GetParam();
  const std::uint32_t lead = std::min(period / 10, 1'000U);
  test::TestModule robot(test::one_slot(test::algorithm(test::sinusoidal), 1, period));
  robot.set_up_and_start();
  robot.produce_sync();
  constexpr unsigned count = 300;
  robot.run_syncs(count);
  const auto syncs = robot.bus.sent(canopen::identifier::sync);
  const auto ticks = robot.bus.sent(canopen::identifier::tick);
  ASSERT_EQ(syncs.size(), count);
  // A frame that is on the bus delays SYNC, but not the ones after it.
  const Microseconds frame = test::TestBus::frame_time_us;
  const Microseconds first = ticks[0].time + lead + frame;
  for (unsigned k = 0; k < count; ++k) {
    EXPECT_EQ(syncs[k].frame, canopen::encode_sync(k));
    EXPECT_GE(syncs[k].time, first + std::uint64_t{k} * period);
    EXPECT_LE(syncs[k].time, first + std::uint64_t{k} * period + frame);
  }
  ASSERT_EQ(ticks.size(), count / 10);
  for (unsigned i = 0; i < ticks.size(); ++i) {
    EXPECT_EQ(ticks[i].frame, encode(canopen::TickMessage{10 * i, robot.crc()}));
    EXPECT_LE(ticks[i].time, syncs[10 * i].time);
    EXPECT_LE(syncs[10 * i].time - ticks[i].time, lead + frame);
  }
  EXPECT_EQ(robot.kernel().tick(), count) << "it counts its own SYNC as the other modules do";
}

TEST(Producer, ComputesATickAtTheInstantAtWhichTheOthersDo) {
  test::TestRobot robot(test::one_slot(test::algorithm(test::sinusoidal), 3));
  robot.drive();
  robot.run_to(40);
  for (unsigned joint = 1; joint < 3; ++joint) {
    EXPECT_EQ(robot.at(joint).readings, robot.at(0).readings);
  }
}

TEST(Producer, IsSetByTheBitInTheSyncIdentifier) {
  test::TestModule robot;
  robot.boot();
  robot.configure(0);
  EXPECT_EQ(robot.bus.write(5, canopen::object::sync_identifier, produces), AbortCode::refused_by_state);
  robot.start();
  EXPECT_EQ(robot.bus.value(5, canopen::object::sync_identifier), 0x80U);
  robot.produce_sync();
  EXPECT_EQ(robot.bus.value(5, canopen::object::sync_identifier), produces);
  robot.run_syncs(15);
  robot.produce_sync();  // another call has no effect
  robot.run_syncs(1);
  EXPECT_EQ(robot.kernel().tick(), 16U);
  EXPECT_EQ(robot.bus.write(5, canopen::object::sync_identifier, 0x80), AbortCode::none);
  const std::size_t from = robot.bus.log.size();
  robot.bus.run_for(300'000);
  EXPECT_TRUE(robot.bus.sent(canopen::identifier::sync, from).empty());
  EXPECT_TRUE(robot.bus.sent(canopen::identifier::tick, from).empty());
}

TEST(Producer, EndsWithOperational) {
  for (const NmtCommand command : {NmtCommand::stop, NmtCommand::enter_pre_operational, NmtCommand::reset_node}) {
    test::TestModule robot;
    robot.set_up_and_start();
    robot.produce_sync();
    robot.run_syncs(15);
    robot.command(command);
    const std::size_t from = robot.bus.log.size();
    robot.bus.run_for(1'000'000);
    EXPECT_TRUE(robot.bus.sent(canopen::identifier::sync, from).empty());
    EXPECT_TRUE(robot.bus.sent(canopen::identifier::tick, from).empty());
  }
}

TEST(Producer, SyncZeroWaitsForItsTickOnABusyBus) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.produce_sync();
  // Frames of higher priority keep TICK from the bus for some 5 ms.
  for (int i = 0; i < 40; ++i) {
    robot.bus.send({0x300, 8, {}});
  }
  robot.run_syncs(1);
  const auto ticks = robot.bus.sent(canopen::identifier::tick);
  ASSERT_EQ(ticks.size(), 1U);
  const Microseconds sync_zero = robot.bus.sent(canopen::identifier::sync)[0].time;
  EXPECT_GE(sync_zero, ticks[0].time + 1'000);
  EXPECT_LE(sync_zero, ticks[0].time + 1'000 + 2 * test::TestBus::frame_time_us);
  EXPECT_EQ(robot.kernel().tick(), 1U);
}

TEST(Producer, ATickThatIsOvertakenByItsSyncDisturbsNoModule) {
  test::TestRobot robot(test::one_slot(test::algorithm(test::sinusoidal), 2));
  robot.drive();
  robot.run_to(9);
  for (int i = 0; i < 100; ++i) {
    robot.bus.send({0x300, 8, {}});
  }
  robot.run_to(30);
  const auto ticks = robot.bus.sent(canopen::identifier::tick);
  const auto syncs = robot.bus.sent(canopen::identifier::sync);
  ASSERT_GT(ticks[1].time, syncs[10].time) << "the test needs it overtaken";
  for (unsigned joint = 0; joint < 2; ++joint) {
    EXPECT_TRUE(robot.module(joint).synchronised());
    EXPECT_EQ(robot.kernel(joint).tick(), 31U);
    EXPECT_TRUE(robot.bus.emergencies(robot.node(joint)).empty());
  }
}

TEST(Producer, TriesAgainIfTheQueueHasNoRoomForTheFirstTick) {
  test::TestModule robot;
  robot.set_up_and_start();
  for (int i = 0; i < 40; ++i) {
    robot.it().receive(robot.bus.now(), {0x605, 8, {0x40, 0x18, 0x10, 1}});
  }
  robot.it().receive(robot.bus.now(), {0x605, 8, {0x23, 0x05, 0x10, 0, 0x80, 0, 0, 0x40}});
  robot.run_syncs(3);
  EXPECT_EQ(robot.kernel().tick(), 3U);
}

// No node acknowledges the frames of a module that is alone on the bus. That never leads to bus-off (ISO 11898-1).
TEST(Producer, DoesNotMakeUpForSyncsThatNobodyReceived) {
  struct LoosePort final : CanPort {
    bool send(const CanFrame& frame) override {
      if (std::ranges::find(mailboxes, frame.identifier, &CanFrame::identifier) != mailboxes.end() ||
          mailboxes.size() == 3) {
        return false;
      }
      mailboxes.push_back(frame);
      return true;
    }
    std::vector<CanFrame> mailboxes;
  } port;
  firmware::Outbox outbox(port);
  firmware::SyncProducer producer(outbox);
  producer.start(0, 10'000, 42);
  producer.poll(0);
  producer.transmitted(500, port.mailboxes[0]);
  port.mailboxes.clear();
  for (Microseconds now = 500; now < 500'000; now += 500) {
    producer.poll(now);
  }
  // The connector has contact again.
  std::vector<std::uint8_t> counters;
  while (!port.mailboxes.empty()) {
    const CanFrame sent = port.mailboxes.front();
    port.mailboxes.erase(port.mailboxes.begin());
    if (const auto counter = canopen::decode_sync(sent)) {
      counters.push_back(*counter);
    }
    outbox.sent();
  }
  // These are the SYNC that the controller had, and the newest: SYNC 49 at 491.5 ms.
  EXPECT_EQ(counters, (std::vector<std::uint8_t>{1, 50}));
}

TEST(Producer, SkipsSyncsThatAreTooLate) {
  struct FreePort final : CanPort {
    bool send(const CanFrame& frame) override {
      frames.push_back(frame);
      return true;
    }
    std::vector<CanFrame> frames;
  } port;
  firmware::Outbox outbox(port);
  firmware::SyncProducer producer(outbox);
  producer.start(1'000, 10'000, 42);
  producer.poll(1'000);
  ASSERT_EQ(port.frames.size(), 1U);
  EXPECT_EQ(producer.next_deadline(), never);
  producer.transmitted(1'500, port.frames[0]);
  EXPECT_EQ(producer.next_deadline(), 2'500U);
  producer.poll(2'500);
  EXPECT_EQ(port.frames.back(), canopen::encode_sync(0));
  // SYNC 1 is due at 12500 and 17 at 172500.
  producer.poll(172'501);
  EXPECT_EQ(port.frames.back(), canopen::encode_sync(1));
  EXPECT_EQ(producer.next_deadline(), 182'500U);
  producer.poll(182'500);
  EXPECT_EQ(port.frames.back(), canopen::encode_sync(18));
}

}  // namespace
}  // namespace proleg
