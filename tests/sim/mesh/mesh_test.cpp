#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "sim/mesh/mesh_checks.hpp"
#include "sim/mesh/mesh_geometry.hpp"
#include "tests/sim/mesh/mesh_shapes.hpp"

namespace proleg::sim {
namespace {

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const MeshError& error) {
    EXPECT_FALSE(error.expected.empty());
    return error.found;
  }
  return "nothing";
}

TEST(MeshSolid, ABoxHasItsVolumeCentreAndInertia) {
  const Eigen::Vector3d half(0.1, 0.2, 0.3);
  const Eigen::Vector3d middle(1.0, -2.0, 0.5);
  const MeshSolid solid = solid_of(box_mesh(half, middle));
  EXPECT_NEAR(solid.volume, 8.0 * half.prod(), 1e-12);
  EXPECT_TRUE(solid.center.isApprox(middle, 1e-12));
  const Eigen::Vector3d squares = half.cwiseProduct(half);
  const Eigen::Vector3d moments =
      8.0 * half.prod() / 3.0 *
      Eigen::Vector3d(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y());
  EXPECT_NEAR((solid.inertia - Eigen::Matrix3d(moments.asDiagonal())).norm(), 0.0, 1e-12);
}

TEST(MeshSolid, ATetrahedronHasASixthOfItsBoxAndItsCentreInTheMeanOfItsCorners) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const MeshSolid solid = solid_of(mesh);
  EXPECT_NEAR(solid.volume, 1.0, 1e-12);
  EXPECT_TRUE(solid.center.isApprox(Eigen::Vector3d(0.75, 0.5, 0.25), 1e-12));
}

TEST(ConvexHull, OfABoxWithPointsInsideIsTheBox) {
  TriangleMesh mesh = box_mesh({0.1, 0.2, 0.3});
  for (const double share : {0.0, 0.5, 0.9}) {
    mesh.vertices.emplace_back(share * 0.1, -share * 0.2, share * 0.3);
  }
  mesh.vertices.emplace_back(0.1, 0.0, 0.0);  // in the middle of a side
  const ConvexHull hull = convex_hull(mesh);
  EXPECT_EQ(hull.deviation, 0.0);
  EXPECT_NEAR(solid_of(hull.mesh).volume, 0.048, 1e-9);
  require_closed(hull.mesh);
}

TEST(ConvexHull, OfAnLIsTheSolidWithoutTheNotch) {
  // Two boxes of 2 x 1 x 1 and 1 x 1 x 1 above its end: the hull adds a prism of half a unit cube.
  TriangleMesh mesh = box_mesh({1.0, 0.5, 0.5}, {1.0, 0.5, 0.5});
  const TriangleMesh upper = box_mesh({0.5, 0.5, 0.5}, {0.5, 0.5, 1.5});
  mesh.vertices.insert(mesh.vertices.end(), upper.vertices.begin(), upper.vertices.end());
  EXPECT_NEAR(solid_of(convex_hull(mesh).mesh).volume, 3.5, 1e-9);
}

TEST(ConvexHull, WithManyCornersKeepsTheOutermostAndSaysHowFarItIsOff) {
  constexpr double radius = 0.05;
  const ConvexHull hull = convex_hull(sphere_points(radius, 40, 60));
  EXPECT_LE(hull.mesh.vertices.size(), max_hull_corners);
  EXPECT_GT(hull.deviation, 0.0);
  EXPECT_LT(hull.deviation, 0.1 * radius);
  for (const Eigen::Vector3d& vertex : hull.mesh.vertices) {
    EXPECT_NEAR(vertex.norm(), radius, 1e-12);
  }
  const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  EXPECT_LT(solid_of(hull.mesh).volume, volume);
  EXPECT_GT(solid_of(hull.mesh).volume, 0.8 * volume);
}

TEST(ConvexHull, OfAFlatMeshIsRefused) {
  EXPECT_EQ(refusal([] { static_cast<void>(convex_hull(sheet(3, 0.1))); }), "a flat mesh, which has no volume");
}

TEST(MeshChecks, AClosedMeshPassesAndOneWithAHoleNot) {
  TriangleMesh mesh = box_mesh({0.1, 0.1, 0.1});
  require_closed(mesh);
  mesh.triangles.pop_back();
  EXPECT_EQ(refusal([&] { require_closed(mesh); }),
            "a mesh with holes: 3 of 33 edges belong to no second triangle or to more, the first near -0.1 -0.1 0.1");
}

TEST(MeshChecks, VerticesAtTheSamePlaceAreOne) {
  TriangleMesh mesh = box_mesh({0.1, 0.1, 0.1});
  TriangleMesh apart;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t corner : triangle) {
      apart.vertices.push_back(mesh.vertices[corner]);
    }
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_NO_THROW(require_closed(apart));
}

TEST(MeshChecks, ATriangleThatFacesTheOtherWayIsAHole) {
  TriangleMesh mesh = box_mesh({0.1, 0.1, 0.1});
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  EXPECT_NE(refusal([&] { require_closed(mesh); }), "nothing");
}

TEST(MeshChecks, TrianglesWithoutAreaAreFoundAndLeftOut) {
  TriangleMesh mesh = box_mesh({0.1, 0.1, 0.1});
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_EQ(refusal([&] { require_area(mesh); }), "triangle 13, at -0.1 -0.1 -0.1, without area");
  EXPECT_EQ(without_slivers(mesh).triangles.size(), 12U);
  mesh.triangles = {{0, 1, 1}};
  EXPECT_EQ(refusal([&] { static_cast<void>(without_slivers(mesh)); }), "a mesh whose triangles have no area");
}

TEST(MeshChecks, AMeshInMillimetresIsRefusedWithTheFactor) {
  try {
    require_size(box_mesh({26.0, 36.0, 26.0}), 0.001, 5.0);
    FAIL() << "accepted";
  } catch (const MeshError& error) {
    EXPECT_EQ(error.found, "a mesh of 52 x 72 x 52 m");
    EXPECT_NE(error.expected.find("needs the scale 0.001"), std::string::npos);
  }
  EXPECT_NE(refusal([] { require_size(box_mesh({1e-5, 1e-5, 1e-5}), 0.001, 5.0); }), "nothing");
  EXPECT_NO_THROW(require_size(box_mesh({0.026, 0.036, 0.026}), 0.001, 5.0));
}

TEST(HeightMesh, HasTheHeightsAtItsPlacesAndFacesUpwards) {
  const TriangleMesh mesh =
      surface_of({.columns = 3, .rows = 2, .half_x = 1, .half_y = 2, .heights = {1, 2, 3, 4, 5, 6}});
  ASSERT_EQ(mesh.vertices.size(), 6U);
  EXPECT_EQ(mesh.vertices[0], Eigen::Vector3d(-1, -2, 1));
  EXPECT_EQ(mesh.vertices[1], Eigen::Vector3d(0, -2, 2));
  EXPECT_EQ(mesh.vertices[5], Eigen::Vector3d(1, 2, 6));
  ASSERT_EQ(mesh.triangles.size(), 4U);
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
    EXPECT_GT((mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).z(), 0.0);
  }
}

}  // namespace
}  // namespace proleg::sim
