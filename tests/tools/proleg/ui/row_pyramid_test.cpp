#include "tools/proleg/ui/recorded_run.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "host/server/telemetry.hpp"

namespace proleg::tools {
namespace {

using Row = std::vector<std::int32_t>;

/// First row, minima and maxima of some rows, value by value.
Row summary_of(const std::vector<Row>& rows, std::size_t begin, std::size_t end) {
  const std::size_t width = rows.front().size();
  Row block = rows[begin];
  block.resize(3 * width, host::no_value);
  for (std::size_t i = 0; i < width; ++i) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::int32_t value = rows[row][i];
      if (value == host::no_value) {
        continue;
      }
      std::int32_t& minimum = block[width + i];
      std::int32_t& maximum = block[2 * width + i];
      minimum = minimum == host::no_value || value < minimum ? value : minimum;
      maximum = maximum == host::no_value || value > maximum ? value : maximum;
    }
  }
  return block;
}

TEST(RowPyramid, BlocksAreThoseOfASearchThroughAllRows) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (const std::size_t width : {1U, 3U}) {
    RowPyramid pyramid(width);
    std::vector<Row> rows;
    std::uniform_int_distribution<std::int32_t> any_value(INT32_MIN, INT32_MAX);
    for (int part = 0; part < 30; ++part) {
      // Grows, and is read in between.
      for (unsigned more = random() % 700; more > 0; --more) {
        Row row(width);
        for (std::int32_t& value : row) {
          value = random() % 4 == 0 ? host::no_value : any_value(random);
        }
        pyramid.add(row);
        rows.push_back(row);
      }
      ASSERT_EQ(pyramid.rows(), rows.size());
      for (const std::uint32_t size : RowPyramid::block_rows) {
        const std::size_t known = (rows.size() + size - 1) / size;
        const std::size_t first = random() % (known + 1);
        const std::size_t count = random() % (known - first + 1);
        Row expected;
        for (std::size_t block = first; block < first + count; ++block) {
          const Row summary = summary_of(rows, block * size, std::min(rows.size(), (block + 1) * size));
          expected.insert(expected.end(), summary.begin(), summary.end());
        }
        ASSERT_EQ(pyramid.blocks(size, first, count), expected) << size << " rows, blocks from " << first;
      }
    }
  }
}

TEST(RowPyramid, RejectsBlocksThatItDoesNotHave) {
  RowPyramid pyramid(1);
  EXPECT_THROW(static_cast<void>(pyramid.blocks(8, 0, 1)), std::invalid_argument);
  pyramid.add(Row{5});
  EXPECT_EQ(pyramid.blocks(4096, 0, 1), (Row{5, 5, 5}));
  EXPECT_THROW(static_cast<void>(pyramid.blocks(8, 0, 2)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(pyramid.blocks(8, UINT64_MAX, 2)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(pyramid.blocks(8, 1, UINT64_MAX)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(pyramid.blocks(7, 0, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace proleg::tools
