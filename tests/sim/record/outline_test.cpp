#include "sim/record/outline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

namespace proleg::sim {
namespace {

const View from_side{Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};

double area(const Polyline& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point a = polygon[i];
    const Point b = polygon[(i + 1) % polygon.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum / 2.0;
}

Geometry solid(Shape shape, const Eigen::Vector3d& extents) {
  Geometry geometry;
  geometry.shape = shape;
  geometry.extents = extents;
  return geometry;
}

TEST(Outline, OfABoxIsItsFace) {
  const Polyline face = outline_of(solid(Shape::box, {1, 2, 3}), Pose{}, from_side);
  ASSERT_EQ(face.size(), 4U);
  EXPECT_NEAR(area(face), 4 * 6, 1e-12);
  for (const Point& corner : face) {
    EXPECT_NEAR(std::abs(corner.x), 2.0, 1e-12);
    EXPECT_NEAR(std::abs(corner.y), 3.0, 1e-12);
  }
}

TEST(Outline, OfACubeOnItsCornerIsAHexagon) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::Ones(), Eigen::Vector3d::UnitX());
  const Polyline outline = outline_of(solid(Shape::box, {0.5, 0.5, 0.5}), {{7, 8, 9}, turn}, from_side);
  EXPECT_EQ(outline.size(), 6U);
  EXPECT_NEAR(area(outline), std::sqrt(3.0), 1e-9) << "the largest projection of a unit cube";
}

TEST(Outline, OfASphereIsACircleAndOfACylinderARectangleOrACircle) {
  EXPECT_NEAR(area(outline_of(solid(Shape::sphere, {0.1, 0, 0}), Pose{}, from_side)), std::numbers::pi * 0.01, 0.0005);
  const Geometry cylinder = solid(Shape::cylinder, {0.1, 0.3, 0});
  EXPECT_NEAR(area(outline_of(cylinder, Pose{}, from_side)), 0.2 * 0.6, 1e-9) << "its axis is y";
  const View along_its_axis{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()};
  EXPECT_NEAR(area(outline_of(cylinder, Pose{}, along_its_axis)), std::numbers::pi * 0.01, 0.0005);
}

/// A prism across x, from -half to half, over a triangle with its tip up: 2 m wide along y, 1 m high.
TriangleMesh roof(double half) {
  TriangleMesh mesh;
  for (const double x : {-half, half}) {
    mesh.vertices.insert(mesh.vertices.end(), {{x, -1, 0}, {x, 1, 0}, {x, 0, 1}});
  }
  mesh.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  return mesh;
}

TEST(Outline, OfAHullIsThatOfItsCorners) {
  Geometry hull = solid(Shape::hull, {1, 1, 1});
  hull.mesh = std::make_shared<const TriangleMesh>(roof(0.3));
  EXPECT_NEAR(area(outline_of(hull, Pose{}, from_side)), 1.0, 1e-9);
}

TEST(MeshSection, HasTheShapeOfTheMeshWithinTheSlab) {
  MeshSection section(from_side, 0.0, 0.1, -2.0, 2.0);
  section.add(roof(0.3), Pose{});
  const std::vector<Polyline> polygons = section.polygons();
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_NEAR(std::abs(area(polygons[0])), 1.0, 0.05);
  for (const Point& point : polygons[0]) {
    EXPECT_LE(point.y, 1.0 - std::abs(point.x) + 1e-9) << "under the roof";
    EXPECT_GE(point.y, -1e-9);
  }
}

TEST(MeshSection, LeavesOutWhatIsBesideTheSlab) {
  MeshSection section(from_side, 0.0, 0.1, -2.0, 2.0);
  section.add(roof(0.3), {{0.5, 0, 0}, {1, 0, 0, 0}});
  EXPECT_TRUE(section.polygons().empty());
}

TEST(MeshSection, TwoPartsWithAGapAreTwoPolygons) {
  MeshSection section(from_side, 0.0, 0.1, -4.0, 4.0);
  section.add(roof(0.3), {{0, -2.0, 0}, {1, 0, 0, 0}});
  section.add(roof(0.3), {{0, 2.0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(section.polygons().size(), 2U);
}

TEST(Clipped, HasTheAreaThatLiesInTheRectangle) {
  const Polyline square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  EXPECT_NEAR(area(clipped(square, {-1, -1}, {3, 3})), 4.0, 1e-12) << "all of it";
  EXPECT_NEAR(area(clipped(square, {1, 1}, {3, 3})), 1.0, 1e-12);
  EXPECT_NEAR(area(clipped(square, {0.5, 0.5}, {1, 1})), 0.25, 1e-12) << "the rectangle";
  EXPECT_TRUE(clipped(square, {5, 5}, {6, 6}).empty());
}

TEST(Clipped, KeepsEveryPointInTheRectangle) {
  constexpr unsigned seed = 11;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  for (int run = 0; run < 200; ++run) {
    Geometry box = solid(Shape::box, {0.2, 1.0, 0.7});
    box.pose.orientation = Eigen::Quaterniond::UnitRandom();
    const Polyline outline = outline_of(box, {{0, place(random), place(random)}, {1, 0, 0, 0}}, from_side);
    const Polyline inside = clipped(outline, {-1, -1}, {1, 1});
    for (const Point& point : inside) {
      EXPECT_LE(std::max(std::abs(point.x), std::abs(point.y)), 1.0 + 1e-12) << "seed " << seed;
    }
    EXPECT_LE(area(inside), area(outline) + 1e-12);
  }
}

}  // namespace
}  // namespace proleg::sim
