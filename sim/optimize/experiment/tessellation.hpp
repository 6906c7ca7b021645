#pragma once

// Cells of about equal size in a space of any number of dimensions: those of a centroidal Voronoi tessellation of the
// unit cube. A point belongs to the centroid that is nearest to it. In a map of gaits their number does not grow with
// the number of axes, as that of a grid does (V. Vassiliades, K. Chatzilygeroudis, J.-B. Mouret, "Using centroidal
// Voronoi tessellations to scale up the multidimensional archive of phenotypic elites algorithm", IEEE Transactions on
// Evolutionary Computation 22, 2018).

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace proleg::optimize {

class Tessellation {
 public:
  /// The same dimensions and count give the same centroids, to the last bit, on every computer. Lloyd's algorithm (IEEE
  /// Transactions on Information Theory 28, 1982) moves them over the points of a Halton sequence.
  /// dimensions: 2 to 4. count: number of centroids, at least 1.
  Tessellation(std::size_t dimensions, std::size_t count);

  [[nodiscard]] std::size_t count() const { return coordinates_.size() / dimensions_; }
  /// A coordinate for each dimension, 0 to 1.
  [[nodiscard]] std::span<const double> centroid(std::size_t number) const {
    return std::span(coordinates_).subspan(number * dimensions_, dimensions_);
  }
  /// The number of the centroid that is nearest to a point; of equally near ones the smallest.
  [[nodiscard]] std::size_t nearest(std::span<const double> point) const;
  /// Whether two cells are the same, or have a common border that the line between their centroids crosses.
  [[nodiscard]] bool are_neighbours(std::size_t one, std::size_t other) const;

  /// The corners of a cell, in their order around it. For two dimensions only.
  [[nodiscard]] std::vector<std::array<double, 2>> corners(std::size_t number) const;

 private:
  struct Found;

  void make_tree(std::size_t first, std::size_t end, std::size_t depth);
  void search(std::size_t first, std::size_t end, std::size_t depth, std::span<const double> point, Found& best) const;

  std::size_t dimensions_;
  std::vector<double> coordinates_;  ///< of centroid after centroid
  /// Numbers of the centroids as a k-d tree: in the middle of a range stands one that divides the others by a
  /// coordinate, that of the range's depth.
  std::vector<std::size_t> tree_;
};

}  // namespace proleg::optimize
