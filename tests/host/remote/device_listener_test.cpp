#include "host/remote/device_listener.hpp"

#include <gtest/gtest.h>

namespace proleg::host {
namespace {

TEST(Element, GoesFromMinusOneToOneOverTheRangeOfTheAxis) {
  const AxisRange stick{-32768, 32767, 0};
  EXPECT_EQ(normalised(stick, -32768), -1);
  EXPECT_EQ(normalised(stick, 32767), 1);
  EXPECT_NEAR(normalised(stick, 16384), 0.5, 1e-4);
  const AxisRange trigger{0, 255, 0};
  EXPECT_EQ(normalised(trigger, 0), -1);
  EXPECT_EQ(normalised(trigger, 255), 1);
  const AxisRange hat{-1, 1, 0};
  EXPECT_EQ(normalised(hat, 0), 0);
  EXPECT_EQ(normalised(hat, -1), -1);
}

TEST(Element, IsZeroWhereTheDeviceSaysThatItRests) {
  const AxisRange stick{-100, 100, 20};
  EXPECT_EQ(normalised(stick, 20), 0);
  EXPECT_EQ(normalised(stick, -20), 0);
  EXPECT_NEAR(normalised(stick, 60), 0.5, 1e-9);  // without a jump beyond it
  EXPECT_EQ(normalised(stick, 100), 1);
}

TEST(Element, StaysInItsRangeWhateverADriverSends) {
  EXPECT_EQ(normalised({-100, 100, 0}, 5000), 1);
  EXPECT_EQ(normalised({0, 0, 0}, 7), 0);
  EXPECT_EQ(normalised({10, -10, 0}, 7), 0);
  EXPECT_EQ(normalised({-2147483647 - 1, 2147483647, 0}, -2147483647 - 1), -1);
  EXPECT_EQ(normalised({-10, 10, 1000}, 10), 1);
}

TEST(Element, IsPressedBeyondAHalfAndReleasedClearlyBelow) {
  EXPECT_TRUE(is_pressed(1, false));
  EXPECT_FALSE(is_pressed(0, true));
  EXPECT_FALSE(is_pressed(0.45, false));
  EXPECT_TRUE(is_pressed(0.45, true));
}

}  // namespace
}  // namespace proleg::host
