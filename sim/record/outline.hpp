#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "sim/record/svg.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// A direction from which solids are seen without perspective. Points of the view are in metres, y upwards.
struct View {
  Eigen::Vector3d right;  ///< unit vectors in the world, perpendicular to each other
  Eigen::Vector3d up;

  [[nodiscard]] Point of(const Eigen::Vector3d& point) const { return {right.dot(point), up.dot(point)}; }
};

/// The outline of a solid: a convex polygon, of a mesh the one around it. link: pose of the frame that holds it. Curves
/// have 24 corners.
[[nodiscard]] Polyline outline_of(const Geometry& solid, const Pose& link, const View& view);

/// A section through a mesh: where it reaches from and to in each of some columns of a view, within a slab that is
/// parallel to the view. An upright strip of the view is a column.
class MeshSection {
 public:
  /// The slab reaches half_thickness (m) to both sides of the depth `middle`, which counts along right x up. The
  /// columns are those between low and high, which are places along view.right.
  MeshSection(const View& view, double middle, double half_thickness, double low, double high);
  /// pose: of the mesh in the world.
  void add(const TriangleMesh& mesh, const Pose& pose);
  /// One polygon for each part without a gap: its upper edge, then its lower edge backwards.
  [[nodiscard]] std::vector<Polyline> polygons() const;

 private:
  void add_edge(Point from, Point to);
  [[nodiscard]] double place_of(std::size_t column) const;

  View view_;
  double middle_;
  double half_thickness_;
  double low_;
  double high_;
  std::vector<double> tops_;  ///< of the columns; below the bottom where there is nothing
  std::vector<double> bottoms_;
};

/// The part of a convex polygon within a rectangle; empty if there is none.
[[nodiscard]] Polyline clipped(const Polyline& polygon, Point low, Point high);

}  // namespace proleg::sim
