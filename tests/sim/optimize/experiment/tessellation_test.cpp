#include "sim/optimize/experiment/tessellation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace proleg::optimize {
namespace {

using Corner = std::array<double, 2>;

constexpr unsigned point_seed = 20'261'129;

double squared_distance(std::span<const double> one, std::span<const double> other) {
  double sum = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    sum += (one[i] - other[i]) * (one[i] - other[i]);
  }
  return sum;
}

std::vector<double> any_point(std::mt19937& random, std::size_t dimensions) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<double> point(dimensions);
  for (double& value : point) {
    value = share(random);
  }
  return point;
}

TEST(Tessellation, GivesEachPointToTheNearestCentroid) {
  std::mt19937 random(point_seed);
  for (std::size_t dimensions = 2; dimensions <= 4; ++dimensions) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{200}}) {
      const Tessellation cells(dimensions, count);
      ASSERT_EQ(cells.count(), count);
      for (int i = 0; i < 500; ++i) {
        const std::vector<double> point = any_point(random, dimensions);
        std::size_t expected = 0;
        for (std::size_t number = 1; number < count; ++number) {
          if (squared_distance(point, cells.centroid(number)) < squared_distance(point, cells.centroid(expected))) {
            expected = number;
          }
        }
        ASSERT_EQ(cells.nearest(point), expected) << dimensions << " dimensions, " << count << ", seed " << point_seed;
      }
    }
  }
}

TEST(Tessellation, HasEachCentroidInItsOwnCellAndWithinTheCube) {
  for (std::size_t dimensions = 2; dimensions <= 4; ++dimensions) {
    const Tessellation cells(dimensions, 300);
    for (std::size_t number = 0; number < cells.count(); ++number) {
      EXPECT_EQ(cells.nearest(cells.centroid(number)), number);
      for (const double coordinate : cells.centroid(number)) {
        EXPECT_TRUE(coordinate > 0.0 && coordinate < 1.0) << coordinate;
      }
    }
  }
}

/// In two dimensions the best of all tessellations has hexagons: mean squared distance to the centroid 5 / (18 sqrt(3))
/// of a cell's area (L. Fejes Toth, 1959). Random points have 1 / pi.
TEST(Tessellation, IsNearlyAsEvenAsTheBestThereIs) {
  constexpr std::size_t count = 500;
  const Tessellation cells(2, count);
  std::mt19937 random(point_seed);
  constexpr int points = 50'000;
  double sum = 0.0;
  for (int i = 0; i < points; ++i) {
    const std::vector<double> point = any_point(random, 2);
    sum += squared_distance(point, cells.centroid(cells.nearest(point)));
  }
  const double best = 5.0 / (18.0 * std::sqrt(3.0)) / count;
  EXPECT_GT(sum / points, best);
  EXPECT_LT(sum / points, 1.15 * best) << "seed " << point_seed;
}

double area_of(const std::vector<Corner>& corners) {
  double doubled = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& next = corners[(i + 1) % corners.size()];
    doubled += corners[i][0] * next[1] - next[0] * corners[i][1];
  }
  return doubled / 2.0;
}

TEST(Tessellation, HasCellsThatCoverTheSquareOnceWithCornersAsFarFromTwoOtherCentroidsOrOnTheEdge) {
  const Tessellation cells(2, 150);
  double area = 0.0;
  for (std::size_t number = 0; number < cells.count(); ++number) {
    const std::vector<Corner> corners = cells.corners(number);
    ASSERT_GE(corners.size(), 3U);
    area += area_of(corners);
    for (const Corner& corner : corners) {
      const double own = std::sqrt(squared_distance(corner, cells.centroid(number)));
      int as_near = 0;
      for (std::size_t other = 0; other < cells.count(); ++other) {
        const double distance = std::sqrt(squared_distance(corner, cells.centroid(other)));
        EXPECT_GT(distance, own - 1e-9);
        as_near += other != number && distance < own + 1e-9 ? 1 : 0;
      }
      for (const double coordinate : corner) {
        as_near += coordinate < 1e-12 || coordinate > 1.0 - 1e-12 ? 1 : 0;
      }
      EXPECT_GE(as_near, 2);
    }
  }
  EXPECT_NEAR(area, 1.0, 1e-9);
}

TEST(Tessellation, HasTheNearestOtherCentroidAsANeighbourAndNoneAcrossTheSquare) {
  const Tessellation cells(2, 60);
  for (std::size_t one = 0; one < cells.count(); ++one) {
    EXPECT_TRUE(cells.are_neighbours(one, one));
    std::size_t nearest = one == 0 ? 1 : 0;
    for (std::size_t other = 0; other < cells.count(); ++other) {
      const double distance = squared_distance(cells.centroid(one), cells.centroid(other));
      nearest =
          other != one && distance < squared_distance(cells.centroid(one), cells.centroid(nearest)) ? other : nearest;
      EXPECT_EQ(cells.are_neighbours(one, other), cells.are_neighbours(other, one));
      EXPECT_FALSE(distance > 0.25 && cells.are_neighbours(one, other));
    }
    EXPECT_TRUE(cells.are_neighbours(one, nearest));
  }
}

}  // namespace
}  // namespace proleg::optimize
