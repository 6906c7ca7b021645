#include "shared/can/transmit_queue.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

namespace proleg {
namespace {

/// A controller with some mailboxes, which keeps the frames that it took in order.
class Mailboxes final : public CanPort {
 public:
  explicit Mailboxes(unsigned free) : free_(free) {}

  [[nodiscard]] bool send(const CanFrame& frame) override {
    if (free_ == 0) {
      return false;
    }
    --free_;
    taken.push_back(frame);
    return true;
  }
  /// The controller has sent a frame.
  void release() { ++free_; }

  std::vector<CanFrame> taken;

 private:
  unsigned free_;
};

CanFrame frame(std::uint16_t identifier, std::uint8_t mark = 0) { return {identifier, 1, {mark}}; }

TEST(TransmitQueue, HandsAFrameOnAtOnceWhileAMailboxIsFree) {
  Mailboxes port(2);
  TransmitQueue queue(port);
  EXPECT_TRUE(queue.push(frame(0x300)));
  EXPECT_TRUE(queue.push(frame(0x200)));
  EXPECT_EQ(queue.size(), 0U);
  EXPECT_EQ(port.taken, (std::vector<CanFrame>{frame(0x300), frame(0x200)}));
  EXPECT_TRUE(queue.push(frame(0x100)));
  EXPECT_EQ(queue.size(), 1U);
  EXPECT_EQ(port.taken.size(), 2U);
}

TEST(TransmitQueue, LetsLowerIdentifiersGoFirstAndEqualOnesInTheirOrder) {
  Mailboxes port(0);
  TransmitQueue queue(port);
  for (const CanFrame& waiting : {frame(0x300), frame(0x100, 1), frame(0x200), frame(0x100, 2), frame(0x080)}) {
    EXPECT_TRUE(queue.push(waiting));
  }
  for (int i = 0; i < 5; ++i) {
    port.release();
    queue.sent();
  }
  EXPECT_EQ(port.taken,
            (std::vector<CanFrame>{frame(0x080), frame(0x100, 1), frame(0x100, 2), frame(0x200), frame(0x300)}));
  queue.sent();
  EXPECT_EQ(port.taken.size(), 5U) << "no frame waits";
}

TEST(TransmitQueue, RefusesWhatItHasNoRoomForAndKeepsTheRest) {
  Mailboxes port(0);
  TransmitQueue queue(port);
  for (std::uint16_t i = 0; i < TransmitQueue::capacity; ++i) {
    EXPECT_TRUE(queue.push(frame(static_cast<std::uint16_t>(0x200 + i))));
  }
  EXPECT_FALSE(queue.push(frame(0x001)));
  EXPECT_EQ(queue.size(), TransmitQueue::capacity);
  port.release();
  EXPECT_TRUE(queue.push(frame(0x001))) << "a mailbox became free without notice";
  EXPECT_EQ(port.taken, std::vector<CanFrame>{frame(0x200)});
}

TEST(TransmitQueue, KeepsTheNewestOfAMessageThatIsSentAgainAndAgain) {
  Mailboxes port(0);
  TransmitQueue queue(port);
  EXPECT_TRUE(queue.push(frame(0x300)));
  for (std::uint8_t mark = 1; mark <= 100; ++mark) {
    EXPECT_TRUE(queue.push_newest(frame(0x080, mark)));
    EXPECT_TRUE(queue.push_newest(frame(0x181, mark)));
  }
  EXPECT_EQ(queue.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    port.release();
    queue.sent();
  }
  EXPECT_EQ(port.taken, (std::vector<CanFrame>{frame(0x080, 100), frame(0x181, 100), frame(0x300)}));
}

TEST(TransmitQueue, KeepsTheNewestAlsoWhenItIsFull) {
  Mailboxes port(0);
  TransmitQueue queue(port);
  for (std::uint16_t i = 0; i < TransmitQueue::capacity; ++i) {
    EXPECT_TRUE(queue.push(frame(static_cast<std::uint16_t>(0x200 + i))));
  }
  EXPECT_TRUE(queue.push_newest(frame(0x200, 7)));
  EXPECT_FALSE(queue.push_newest(frame(0x100)));
  port.release();
  queue.sent();
  EXPECT_EQ(port.taken, std::vector<CanFrame>{frame(0x200, 7)});
}

TEST(TransmitQueue, DropsItsFramesWhenCleared) {
  Mailboxes port(0);
  TransmitQueue queue(port);
  EXPECT_TRUE(queue.push(frame(0x200)));
  queue.clear();
  port.release();
  queue.sent();
  EXPECT_EQ(queue.size(), 0U);
  EXPECT_TRUE(port.taken.empty());
}

TEST(TransmitQueue, BehavesAsAListSortedByIdentifierAndArrival) {
  constexpr std::uint32_t seed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  Mailboxes port(3);
  TransmitQueue queue(port);
  unsigned free = 3;
  std::multimap<std::uint16_t, CanFrame> waiting;  // equal keys stay in the order of insertion
  std::vector<CanFrame> expected;
  const auto hand_over = [&] {
    while (free > 0 && !waiting.empty()) {
      expected.push_back(waiting.begin()->second);
      waiting.erase(waiting.begin());
      --free;
    }
  };
  for (int step = 0; step < 20'000; ++step) {
    if (random() % 100 < 52) {
      const CanFrame next = frame(static_cast<std::uint16_t>(random() % 8), static_cast<std::uint8_t>(step));
      const bool room = waiting.size() < TransmitQueue::capacity;
      ASSERT_EQ(queue.push(next), room);
      if (room) {
        waiting.emplace(next.identifier, next);
      }
    } else {
      port.release();
      ++free;
      queue.sent();
    }
    hand_over();
    ASSERT_EQ(queue.size(), waiting.size());
    ASSERT_EQ(port.taken, expected) << "step " << step;
    port.taken.clear();
    expected.clear();
  }
}

}  // namespace
}  // namespace proleg
