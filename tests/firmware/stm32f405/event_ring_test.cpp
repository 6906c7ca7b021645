#include "firmware/stm32f405/event_ring.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <random>

namespace proleg::stm32f405 {
namespace {

using Ring = EventRing<int, 8>;

TEST(EventRingTest, IsEmptyAtFirst) {
  const Ring ring;
  EXPECT_EQ(ring.front(), nullptr);
  EXPECT_EQ(ring.room(), 8U);
}

TEST(EventRingTest, TakesAsMuchAsItsSizeAndNoMore) {
  Ring ring;
  for (int i = 0; i < 8; ++i) {
    ASSERT_NE(ring.back(), nullptr);
    *ring.back() = i;
    ring.push();
  }
  EXPECT_EQ(ring.back(), nullptr);
  EXPECT_EQ(ring.room(), 0U);
  EXPECT_EQ(*ring.front(), 0);
  ring.pop();
  EXPECT_NE(ring.back(), nullptr);
}

TEST(EventRingTest, WhatIsNotPushedIsNotThere) {
  Ring ring;
  *ring.back() = 5;
  EXPECT_EQ(ring.front(), nullptr);
}

TEST(EventRingTest, BehavesAsAQueueHoweverItIsFilledAndEmptied) {
  constexpr unsigned seed = 8;
  std::mt19937 random(seed);
  Ring ring;
  std::deque<int> expected;
  for (int i = 0; i < 100'000; ++i) {
    if (random() % 2 == 0) {
      int* const place = ring.back();
      ASSERT_EQ(place != nullptr, expected.size() < 8);
      if (place != nullptr) {
        *place = i;
        ring.push();
        expected.push_back(i);
      }
    } else {
      const int* const front = ring.front();
      ASSERT_EQ(front != nullptr, !expected.empty());
      if (front != nullptr) {
        ASSERT_EQ(*front, expected.front());
        ring.pop();
        expected.pop_front();
      }
    }
    ASSERT_EQ(ring.room(), 8 - expected.size());
  }
}

}  // namespace
}  // namespace proleg::stm32f405
