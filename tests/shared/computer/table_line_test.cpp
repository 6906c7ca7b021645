#include "shared/computer/text/table_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace proleg {
namespace {

TEST(TableLine, HasTabsBetweenCellsAndALineEnd) {
  TableLine line;
  line.add("tick");
  line.add(std::uint64_t{18446744073709551615U});
  line.add(0.1);
  EXPECT_EQ(line.finish(), "tick\t18446744073709551615\t0.1\n");
}

TEST(TableLine, IsEmptyAgainAfterItsEnd) {
  TableLine line;
  line.add("first");
  EXPECT_EQ(line.finish(), "first\n");
  line.add("second");
  EXPECT_EQ(line.finish(), "second\n");
}

TEST(TableLine, LeavesACellEmptyForANumberThatIsNotFinite) {
  TableLine line;
  line.add(1U);
  line.add(NAN);
  line.add(INFINITY);
  line.add(2U);
  EXPECT_EQ(line.finish(), "1\t\t\t2\n");
}

}  // namespace
}  // namespace proleg
