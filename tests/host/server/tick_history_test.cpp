#include "host/server/telemetry.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "decoded_rows.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

/// Rows of four values: the tick, its negative, the run, and the least number that there is.
class History : public testing::Test {
 protected:
  History() { subscription.generation = history.reset(4); }
  void add(std::uint16_t run, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t tick = first; tick < first + count; ++tick) {
      const auto value = static_cast<std::int32_t>(tick);
      history.add(run, tick, std::vector<std::int32_t>{value, -value, run, no_value});
    }
  }
  std::optional<DecodedRows> next(std::uint32_t stride = 1) {
    const std::optional<std::string> bytes = history.encode_rows(subscription, stride, cursor);
    return bytes ? std::optional<DecodedRows>(*bytes) : std::nullopt;
  }

  TickHistory history{1 << 20};
  Subscription subscription{3, 0, {{0, 1}, {3, 1}}};
  HistoryCursor cursor;
};

TEST_F(History, GivesTheSelectedValuesOfEachRow) {
  add(2, 100, 3);
  const auto rows = next();
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->subscription, 3U);
  EXPECT_EQ(rows->tick, 100U);
  EXPECT_EQ(rows->rows, 3U);
  EXPECT_EQ(rows->stride, 1U);
  EXPECT_EQ(rows->run, 2U);
  EXPECT_EQ(rows->flags, 0U);
  EXPECT_EQ(rows->values, (std::vector<std::int32_t>{100, no_value, 101, no_value, 102, no_value}));
  EXPECT_FALSE(next()) << "each row is sent once";
}

TEST_F(History, GivesTheSignalsInTheOrderOfTheSubscription) {
  subscription.columns = {{2, 2}, {0, 2}};
  add(2, 7, 1);
  EXPECT_EQ(next()->values, (std::vector<std::int32_t>{2, no_value, 7, -7}));
}

TEST_F(History, IsWrittenInLittleEndianNumbers) {
  add(0x0102, 0x01020304, 1);
  EXPECT_EQ(history.encode_rows(subscription, 1, cursor), std::string("\x03\0\0\0"
                                                                      "\x04\x03\x02\x01"
                                                                      "\x01\0"
                                                                      "\x01\0"
                                                                      "\x02\x01"
                                                                      "\0\0"
                                                                      "\x04\x03\x02\x01"
                                                                      "\0\0\0\x80",
                                                                      24));
}

TEST_F(History, GivesAtMostSixtyFourRowsAtOnce) {
  add(1, 0, 100);
  EXPECT_EQ(next()->rows, 64U);
  const auto rest = next();
  EXPECT_EQ(rest->tick, 64U);
  EXPECT_EQ(rest->rows, 36U);
  EXPECT_EQ(rest->flags, 0U);
}

TEST_F(History, WithAStrideHasTicksThatAreMultiplesOfIt) {
  add(1, 5, 20);
  const auto rows = next(8);
  EXPECT_EQ(rows->tick, 8U);
  EXPECT_EQ(rows->stride, 8U);
  EXPECT_EQ(rows->values, (std::vector<std::int32_t>{8, no_value, 16, no_value, 24, no_value}));
  add(1, 25, 7);
  EXPECT_FALSE(next(8));
  add(1, 32, 1);
  const auto last = next(8);
  EXPECT_EQ(last->tick, 32U);
  EXPECT_EQ(last->flags, 0U) << "ticks that the stride leaves out are not missing";
}

TEST_F(History, KeepsTheRowsBehindTheLastMultipleForASmallerStride) {
  add(1, 0, 7);
  EXPECT_EQ(next(4)->values, (std::vector<std::int32_t>{0, no_value, 4, no_value}));
  EXPECT_FALSE(next(4));
  const auto rest = next(1);
  EXPECT_EQ(rest->tick, 5U);
  EXPECT_EQ(rest->rows, 2U);
  EXPECT_EQ(rest->flags, 0U);
}

TEST_F(History, BeginsAnotherMessageWithAnotherRun) {
  add(1, 50, 2);
  add(2, 0, 3);
  EXPECT_EQ(next()->rows, 2U);
  const auto rows = next();
  EXPECT_EQ(rows->run, 2U);
  EXPECT_EQ(rows->tick, 0U);
  EXPECT_EQ(rows->rows, 3U);
  EXPECT_EQ(rows->flags, 0U);
}

TEST_F(History, ReportsTicksThatTheRobotLeftOut) {
  add(1, 0, 2);
  add(1, 5, 2);
  EXPECT_EQ(next()->rows, 2U);
  const auto rows = next();
  EXPECT_EQ(rows->tick, 5U);
  EXPECT_EQ(rows->flags, 1U);
  add(1, 7, 1);
  EXPECT_EQ(next()->flags, 0U);
}

TEST_F(History, ReportsAGapAlsoIfTheStrideLeavesOutTheRowBehindIt) {
  add(1, 0, 1);
  EXPECT_TRUE(next(4));
  add(1, 2, 1);
  EXPECT_FALSE(next(4));
  add(1, 3, 2);
  EXPECT_EQ(next(4)->flags, 1U);
}

TEST_F(History, KeepsTheNewestRowsInBoundedMemory) {
  TickHistory small(1000);
  subscription.generation = small.reset(4);
  const auto capacity = static_cast<std::uint32_t>(small.capacity());
  EXPECT_LE(capacity * 16, 1000U);
  EXPECT_GE(capacity, 30U);
  for (std::uint32_t tick = 0; tick < 1000; ++tick) {
    small.add(1, tick, std::vector<std::int32_t>{static_cast<std::int32_t>(tick), 0, 0, 0});
  }
  const DecodedRows rows(small.encode_rows(subscription, 1, cursor).value());
  EXPECT_EQ(rows.tick, 1000 - capacity);
  EXPECT_EQ(rows.flags, 1U) << "the viewer has missed rows";
  EXPECT_EQ(rows.values.front(), static_cast<std::int32_t>(1000 - capacity));
}

TEST_F(History, GivesNothingForAnotherLayout) {
  add(1, 0, 5);
  const std::uint64_t old = subscription.generation;
  subscription.generation = history.reset(2);
  EXPECT_NE(subscription.generation, old);
  EXPECT_FALSE(next()) << "the old rows are forgotten";
  history.add(1, 0, std::vector<std::int32_t>{1, 2});
  subscription.columns = {{0, 2}};
  EXPECT_EQ(next()->values, (std::vector<std::int32_t>{1, 2}));
  history.add(1, 1, std::vector<std::int32_t>{1, 2});
  subscription.generation = old;
  EXPECT_FALSE(next());
}

TEST_F(History, RefusesARowOfAnotherSize) {
  EXPECT_EQ(message_of<std::invalid_argument>([this] {
              history.add(1, 0, std::vector<std::int32_t>{1, 2, 3});
            }),
            "found a row of 3 values, expected 4");
  TickHistory without_layout(1000);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { without_layout.add(1, 0, {}); }),
            "found a row of 0 values, expected 0");
}

TEST_F(History, IsReadWhileAnotherThreadWrites) {
  constexpr std::uint32_t count = 50'000;
  std::thread writer([this] { add(1, 0, count); });
  std::int32_t last = -1;
  while (last + 1 < static_cast<std::int32_t>(count)) {
    const auto rows = next();
    for (std::size_t i = 0; rows && i < rows->values.size(); i += 2) {
      EXPECT_GT(rows->values[i], last);
      EXPECT_TRUE(rows->values[i] == last + 1 || rows->flags == 1);
      last = rows->values[i];
    }
  }
  writer.join();
}

}  // namespace
}  // namespace proleg::host
