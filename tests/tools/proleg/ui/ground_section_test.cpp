#include "tools/proleg/ui/ground_section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

namespace proleg::tools {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

class GroundSectionTest : public ::testing::Test {
 protected:
  void add(sim::Shape shape, const Vector3d& place, const Vector3d& extents, double tilt = 0.0) {
    sim::StaticObject object;
    object.pose.position = place;
    object.pose.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Vector3d::UnitX()));
    sim::Geometry geometry;
    geometry.shape = shape;
    geometry.extents = extents;
    object.geometries.push_back(geometry);
    environment_.objects.push_back(object);
  }
  [[nodiscard]] std::optional<double> height(double x, double y) const {
    return GroundHeights(environment_).at({x, y});
  }
  sim::EnvironmentModel environment_;
};

TEST_F(GroundSectionTest, KnowsTheTopOfEachShape) {
  EXPECT_EQ(height(0, 0), std::nullopt);
  add(sim::Shape::box, {0, 0, -0.5}, {10, 10, 0.5});
  add(sim::Shape::sphere, {1, 0, 0}, {0.3, 0, 0});
  add(sim::Shape::cylinder, {3, 0, 0}, {0.2, 0.5, 0});
  EXPECT_NEAR(*height(0, 5), 0.0, 1e-12);
  EXPECT_NEAR(*height(1, 0), 0.3, 1e-12);
  EXPECT_NEAR(*height(1.18, 0), 0.24, 1e-12);  // sqrt(0.3^2 - 0.18^2)
  EXPECT_NEAR(*height(3.12, 0.4), 0.16, 1e-12);
  EXPECT_NEAR(*height(3, 0.6), 0.0, 1e-12) << "beyond the end of the cylinder, which lies along y";
  EXPECT_EQ(height(11, 0), std::nullopt);
}

TEST_F(GroundSectionTest, KnowsTheSlopeOfARamp) {
  constexpr double tilt = std::numbers::pi / 6.0;
  add(sim::Shape::box, {0, 0, 0}, {1, 1, 0.1}, tilt);
  const double top = 0.1 / std::cos(tilt);  // over the middle
  EXPECT_NEAR(*height(0, 0), top, 1e-12);
  EXPECT_NEAR(*height(0, 0.5), top + 0.5 * std::tan(tilt), 1e-12);
}

TEST_F(GroundSectionTest, KnowsTheSurfaceOfAMesh) {
  sim::StaticObject object;
  sim::Geometry geometry;
  geometry.shape = sim::Shape::surface;
  geometry.mesh =
      std::make_shared<sim::TriangleMesh>(sim::TriangleMesh{{{0, 0, 0}, {2, 0, 0}, {0, 2, 1}}, {{0, 1, 2}}, {}});
  object.pose.position = {0, 0, 3};
  object.geometries.push_back(geometry);
  environment_.objects.push_back(object);
  EXPECT_NEAR(*height(0.5, 1.0), 3.5, 1e-12);
  EXPECT_EQ(height(1.5, 1.0), std::nullopt);
}

TEST_F(GroundSectionTest, HasFewPointsAndUprightSteps) {
  add(sim::Shape::box, {0, 0, -0.5}, {10, 10, 0.5});
  const GroundHeights flat(environment_);
  EXPECT_EQ(ground_section(flat, {0, 0}, {1, 0}, 2.0, 0.001, 0.0).size(), 2U);
  add(sim::Shape::box, {1.013, 0, 0}, {0.3, 1, 0.2});
  const GroundHeights step(environment_);
  const std::vector<SectionPoint> section = ground_section(step, {0, 0}, {1, 0}, 2.0, 0.001, 0.0);
  ASSERT_EQ(section.size(), 6U);
  EXPECT_NEAR(section[1].x(), 0.713, 0.001);
  EXPECT_EQ(section[1].x(), section[2].x());
  EXPECT_NEAR(section[2].y(), 0.2, 1e-12);
  EXPECT_NEAR(section[3].x(), 1.313, 0.001);
}

TEST_F(GroundSectionTest, HasTheGivenHeightWhereThereIsNoGround) {
  add(sim::Shape::box, {0, 0, -0.5}, {1, 1, 0.5});
  const GroundHeights ground(environment_);
  EXPECT_EQ(ground_section(ground, {0, 0}, {1, 0}, 2.0, 0.001, -7.0).back(), SectionPoint(2.0, -7.0));
}

}  // namespace
}  // namespace proleg::tools
