#pragma once

#include <string>
#include <string_view>

#include "sim/record/series.hpp"

namespace proleg::sim {

/// Name of a column without its unit and the part behind the dot, and the unit: "angle_deg.J1" is {"angle", "deg"}. The
/// types of the thesis's data files have no unit in their names; theirs are those of docs/recordings.md.
struct Quantity {
  std::string name;
  std::string unit;  ///< empty: a number without unit
};
[[nodiscard]] Quantity quantity_of(std::string_view column);

/// Draws series as an SVG picture: a panel for each unit, all over the same axis, each with a legend. If the one unit
/// is that of the axis too (a path, y over x), both axes have the same scale. Infinite numbers and those that are none
/// are gaps.
[[nodiscard]] std::string draw_series(const SeriesSet& set, std::string_view title, std::string_view subtitle);

}  // namespace proleg::sim
