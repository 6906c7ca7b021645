#pragma once

// A map of gaits: the best candidate of each cell over measures of the run (MapElitesSettings). The cells are those of
// a grid, or those around centroids.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/experiment/tessellation.hpp"

namespace proleg::optimize {

class GaitMap {
 public:
  /// A cell that is filled.
  struct Elite {
    std::size_t cell = 0;       ///< place(cell) has its place on the axes
    std::size_t candidate = 0;  ///< what add() was given
    double score = 0.0;         ///< of the objective
  };

  /// experiment: has axes, and must outlive the map.
  explicit GaitMap(const Experiment& experiment);

  /// Puts a candidate into its cell if that is empty, or has a worse candidate; an equal one stays. candidate: any
  /// number by which the caller knows it. scores: of all objectives. Returns whether it did; never for a run that
  /// failed, or lacks the measure of an axis.
  bool add(std::size_t candidate, std::span<const double> scores);

  /// The filled cells, in the order in which they were filled.
  [[nodiscard]] const std::vector<Elite>& elites() const { return elites_; }
  [[nodiscard]] std::size_t cells() const { return positions_.size(); }
  /// A number of a place: in a grid there is one for each axis, otherwise only that of the centroid.
  struct PlaceNumber {
    std::string name;     ///< the measure of the axis; "number" of a centroid
    std::uint32_t count;  ///< the number is below it
  };
  [[nodiscard]] std::vector<PlaceNumber> place_numbers() const;
  /// The place of a cell: its number on each axis, or that of its centroid, from 0.
  [[nodiscard]] std::vector<std::uint32_t> place(std::size_t cell) const;
  /// The place as files and commands have it, with numbers from 1: "3,7".
  [[nodiscard]] std::string place_text(std::size_t cell) const;
  /// The cell with this place; nothing if the map has none there.
  [[nodiscard]] std::optional<std::size_t> cell_at(std::span<const std::uint32_t> place) const;
  /// The cell of a run; nothing if it failed, or lacks the measure of an axis. scores: of all objectives.
  [[nodiscard]] std::optional<std::size_t> cell_of(std::span<const double> scores) const;
  /// Null if the cells form a grid.
  [[nodiscard]] const Tessellation* tessellation() const { return tessellation_.get(); }
  /// The middle of a cell, or its centroid: a value of each axis, in its unit.
  [[nodiscard]] std::vector<double> middle(std::size_t cell) const;
  /// The same as shares of the axes: 0 at the lowest, 1 at the highest value.
  [[nodiscard]] std::vector<double> point(std::size_t cell) const;
  /// The candidate of a cell; null if it is empty.
  [[nodiscard]] const Elite* elite_of(std::size_t cell) const;

  /// The filled cells that are nearest to some values, at most `count`, the nearest first; of equally near ones the
  /// better. values: of each axis, in its unit; nothing: any. Each axis counts from 0 (lowest) to 1 (highest), values
  /// beyond it as its ends. A cell of a grid is as far as its nearest point, another one as its centroid.
  [[nodiscard]] std::vector<Elite> nearest(std::span<const std::optional<double>> values, std::size_t count) const;

  /// Whether two cells are the same or touch each other, in a grid also at a corner.
  [[nodiscard]] bool are_neighbours(std::size_t cell, std::size_t other) const;

  /// Share of the cells that are filled.
  [[nodiscard]] double coverage() const { return static_cast<double>(elites_.size()) / static_cast<double>(cells()); }
  /// Sum over the filled cells of how much better their scores are than that of a run that fails (QD score: J. K. Pugh,
  /// L. B. Soros, K. O. Stanley, "Quality diversity: a new frontier for evolutionary computation", Frontiers in
  /// Robotics and AI 3, 2016).
  [[nodiscard]] double qd_score() const { return qd_score_; }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  [[nodiscard]] double distance(std::size_t cell, std::span<const std::optional<double>> values) const;
  [[nodiscard]] double gain(double score) const;

  const Experiment& experiment_;
  std::shared_ptr<const Tessellation> tessellation_;
  std::vector<std::size_t> positions_;  ///< in elites_, by cell; none: empty
  std::vector<Elite> elites_;
  double qd_score_ = 0.0;
};

}  // namespace proleg::optimize
