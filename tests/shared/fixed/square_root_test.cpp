#include "shared/fixed/square_root.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

namespace proleg {
namespace {

TEST(SquareRoot, IsTheLargestIntegerWhoseSquareFits) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 100'000; ++i) {
    const std::uint64_t value = random() >> (random() % 64U);
    const std::uint64_t root = square_root(value);
    ASSERT_LE(root * root, value);
    ASSERT_TRUE(root == 0xFFFF'FFFFU || (root + 1) * (root + 1) > value) << value;
  }
}

TEST(SquareRoot, IsExactForSquaresAndAtTheEnds) {
  EXPECT_EQ(square_root(0), 0U);
  EXPECT_EQ(square_root(1), 1U);
  EXPECT_EQ(square_root(144), 12U);
  EXPECT_EQ(square_root(0xFFFF'FFFF'FFFF'FFFFU), 0xFFFF'FFFFU);
  EXPECT_EQ(square_root(0xFFFF'FFFE'0000'0001U), 0xFFFF'FFFFU);
  EXPECT_EQ(square_root(0xFFFF'FFFE'0000'0000U), 0xFFFF'FFFEU);
}

}  // namespace
}  // namespace proleg
