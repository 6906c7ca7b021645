#pragma once

// Columns of a table over time, or over another column, for a plot.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/record/figure_contents.hpp"
#include "sim/record/svg.hpp"

namespace proleg::sim {

/// Writes a table with a header line, tab-separated, with a column time_s: write_tsv() of a recording, or the same of a
/// data file.
using WriteTable = std::function<void(const std::function<void(std::string_view)>&)>;

struct SeriesRequest {
  /// Columns, or what comes before the dot of several: "angle_deg" means angle_deg.J1, angle_deg.J2 and so on. One text
  /// may have several names with commas between them. The name of a column, which has that of a joint, may have commas:
  /// the longest name that the table has counts.
  std::vector<std::string> names;
  std::string x = "time_s";
  TimeWindow window = {};  ///< by default the whole table
  std::string file = {};   ///< of the table, for messages
};

/// A column. What is empty in the table is not a number here.
struct Series {
  std::string name;
  Polyline points;
};

struct SeriesSet {
  std::string x_name;
  std::vector<Series> series;
  double from_s = 0.0;  ///< the first and the last time in the window
  double to_s = 0.0;
};

/// Series with the most distinct styles that a plot has.
inline constexpr std::size_t max_series = 21;

/// Reads a table once and keeps a bounded number of points: of a long series over time the lowest and the highest in
/// each part, of one over another column every n-th. Throws InputError for a name that the table does not have, with
/// those that are most like it, for more than max_series columns, and if fewer than two rows are in the window.
[[nodiscard]] SeriesSet collect_series(const WriteTable& table, const SeriesRequest& request);

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
