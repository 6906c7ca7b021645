#include "sim/record/series.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

/// tick, time_s and these columns; rows every 10 ms from 0.01 s on.
WriteTable table_with(const std::string& columns, std::uint32_t rows,
                      const std::function<std::string(std::uint32_t row)>& cells) {
  return [=](const std::function<void(std::string_view)>& write) {
    write("tick\ttime_s\t" + columns + "\n");
    for (std::uint32_t row = 0; row < rows; ++row) {
      // In two parts: a table may come in any.
      write(std::to_string(row) + "\t" + std::to_string((row + 1) / 100.0));
      write("\t" + cells(row) + "\n");
    }
  };
}

WriteTable small_table() {
  return table_with("angle_deg.J1\tangle_deg.J2\tangle_degrees\tx_m.Head", 5, [](std::uint32_t row) {
    return std::to_string(row) + "\t" + (row == 2 ? "" : "-1e3") + "\t7\t0.5";
  });
}

std::vector<std::string> names_of(const SeriesSet& set) {
  std::vector<std::string> names;
  for (const Series& series : set.series) {
    names.push_back(series.name);
  }
  return names;
}

TEST(Series, AColumnIsFoundByItsName) {
  const SeriesSet set = collect_series(small_table(), {{"angle_deg.J1"}});
  ASSERT_EQ(names_of(set), std::vector<std::string>{"angle_deg.J1"});
  ASSERT_EQ(set.series[0].points.size(), 5U);
  EXPECT_DOUBLE_EQ(set.series[0].points[4].x, 0.05);
  EXPECT_EQ(set.series[0].points[4].y, 4.0);
  EXPECT_DOUBLE_EQ(set.from_s, 0.01);
  EXPECT_DOUBLE_EQ(set.to_s, 0.05);
}

TEST(Series, TheNameBeforeTheDotMeansAllItsColumnsOnce) {
  EXPECT_EQ(names_of(collect_series(small_table(), {{"angle_deg.J2", "angle_deg", "angle_deg"}})),
            (std::vector<std::string>{"angle_deg.J2", "angle_deg.J1"}));
}

TEST(Series, ANameMayHaveCommasAndAListSeparatesNamesByThem) {
  const WriteTable table = table_with("angle_deg.J,1\tangle_deg.J\tangle_deg.J,1,2\tx_m.Head", 3,
                                      [](std::uint32_t /*row*/) { return "1\t2\t3\t4"; });
  const auto columns = [&](const std::string& list) { return names_of(collect_series(table, {{list}})); };
  using Names = std::vector<std::string>;
  EXPECT_EQ(columns("angle_deg.J,1"), (Names{"angle_deg.J,1"}));
  EXPECT_EQ(columns("angle_deg.J, x_m.Head"), (Names{"angle_deg.J", "x_m.Head"}));
  EXPECT_EQ(columns("x_m,angle_deg.J,1,2,angle_deg.J,1"), (Names{"x_m.Head", "angle_deg.J,1,2", "angle_deg.J,1"}));
  for (const auto& [list, found] : {std::pair("angle_deg.J,2", "'2'"), std::pair("x_m,", "'x_m,'"), std::pair("", "''"),
                                    std::pair("y_m,angle_deg.J,1", "'y_m'")}) {
    EXPECT_NE(
        message_of<InputError>([&, text = list] { columns(text); }).find(std::string("found ") + found + ", expected "),
        std::string::npos)
        << list;
  }
}

TEST(Series, AnEmptyCellIsNotANumber) {
  const SeriesSet set = collect_series(small_table(), {{"angle_deg.J2"}});
  EXPECT_EQ(set.series[0].points[1].y, -1e3);
  EXPECT_TRUE(std::isnan(set.series[0].points[2].y));
}

TEST(Series, AnotherColumnCanBeTheAxis) {
  const SeriesSet set = collect_series(small_table(), {{"x_m.Head"}, "angle_deg.J1", {}});
  EXPECT_EQ(set.x_name, "angle_deg.J1");
  EXPECT_EQ(set.series[0].points[3].x, 3.0);
  EXPECT_EQ(set.series[0].points[3].y, 0.5);
}

TEST(Series, AWindowLeavesOutTheRest) {
  const SeriesSet set = collect_series(small_table(), {{"angle_deg.J1"}, "time_s", {0.015, 0.041}});
  ASSERT_EQ(set.series[0].points.size(), 3U);
  EXPECT_EQ(set.series[0].points[0].y, 1.0);
}

TEST(Series, WhatTheTableLacksIsNamedWithWhatIsMostLikeIt) {
  const auto message = [](const SeriesRequest& request) {
    return message_of<InputError>([&] { static_cast<void>(collect_series(small_table(), request)); });
  };
  EXPECT_EQ(message({{"angel_deg.J1"}}),
            "--series: found 'angel_deg.J1', expected columns of the table of 'proleg export', for example "
            "angle_deg.J1, angle_deg.J2, angle_deg");
  EXPECT_EQ(message({{"zzz"}}),
            "--series: found 'zzz', expected columns of the table of 'proleg export', for example angle_deg, "
            "angle_degrees, tick, time_s, x_m");
  EXPECT_EQ(message({{"tick"}, "tme_s", {}}),
            "--x: found 'tme_s', expected columns of the table of 'proleg export', for example time_s");
  EXPECT_EQ(message({{"tick"}, "angle_deg", {}}),
            "--x: found 'angle_deg', expected columns of the table of 'proleg export', for example "
            "angle_deg.J1, angle_deg.J2")
      << "one column is drawn over one";
  EXPECT_EQ(message({{"tick"}, "time_s", {0.05, {}}}),
            "--from and --to: found one row of the table, expected a window with two or more");
  EXPECT_EQ(message({{"tick"}, "time_s", {5.0, 3.0}}),
            "--from and --to: found 5 s to 3 s, expected a window that ends after it begins");
  const WriteTable cut = table_with("a", 1, [](std::uint32_t) { return "1"; });
  EXPECT_EQ(message_of<InputError>([&] {
              static_cast<void>(collect_series(cut, {{"a"}, "time_s", {}, "run.xml"}));
            }),
            "run.xml: found one row of the table, expected two or more; a line needs two points");
}

TEST(Series, MoreColumnsThanStylesAreRefused) {
  std::string columns = "a.0";
  for (int i = 1; i < 22; ++i) {
    columns += "\ta." + std::to_string(i);
  }
  const WriteTable table = table_with(columns, 3, [](std::uint32_t) { return "1"; });
  EXPECT_EQ(message_of<InputError>([&] { static_cast<void>(collect_series(table, {{"a"}})); }),
            "--series: found 22 columns, expected at most 21");
}

TEST(Series, ALongSeriesOverTimeKeepsItsPeaksInBoundedMemory) {
  constexpr std::uint32_t rows = 200'000;
  constexpr std::uint32_t peak = 123'457;
  const WriteTable table = table_with("a\tb", rows, [](std::uint32_t row) {
    return std::to_string(row == peak ? 1000 : static_cast<int>(row % 7)) + "\t" + std::to_string(row);
  });
  const SeriesSet over_time = collect_series(table, {{"a"}});
  const Polyline& points = over_time.series[0].points;
  EXPECT_LT(points.size(), 70'000U);
  EXPECT_GT(points.size(), 10'000U);
  EXPECT_TRUE(std::ranges::is_sorted(points, {}, &Point::x));
  const auto highest = std::ranges::max_element(points, {}, &Point::y);
  EXPECT_EQ(highest->y, 1000.0);
  EXPECT_NEAR(highest->x, (peak + 1) / 100.0, 1e-6);

  const SeriesSet over_other = collect_series(table, {{"a"}, "b", {}});
  EXPECT_LT(over_other.series[0].points.size(), 70'000U);
  EXPECT_EQ(over_other.series[0].points[1].x - over_other.series[0].points[0].x, 4.0) << "every 4th";
  EXPECT_GT(over_other.series[0].points.back().x, rows - 5.0);
}

TEST(SeriesFigure, AQuantityHasTheUnitOfItsName) {
  const auto expect = [](const std::string& column, const std::string& name, const std::string& unit) {
    EXPECT_EQ(quantity_of(column).name, name);
    EXPECT_EQ(quantity_of(column).unit, unit);
  };
  expect("angle_deg.J1", "angle", "deg");
  expect("offset_rate_per_s.J1", "offset_rate", "1/s");
  expect("time_s", "time", "s");
  expect("realtime_ms", "realtime", "ms");
  expect("acceleration_x_m_per_s2.a.b", "acceleration_x", "m/s^2");
  expect("contact_N.Head", "contact", "N");
  expect("contact_rear.Head", "contact_rear", "");
  expect("servo_speeds.J1", "servo_speeds", "deg/s");
  expect("Angle.3", "Angle", "deg");
}

/// The texts and the polylines of a picture.
struct Picture {
  explicit Picture(const std::string& svg) {
    EXPECT_EQ(document.Parse(svg.c_str()), tinyxml2::XML_SUCCESS) << document.ErrorStr();
    look_at(*document.RootElement());
  }
  void look_at(const tinyxml2::XMLElement& element) {
    if (element.GetText() != nullptr) {
      texts.emplace_back(element.GetText());
    }
    lines += std::string(element.Name()) == "polyline" ? 1 : 0;
    for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      look_at(*child);
    }
  }
  [[nodiscard]] auto count(const std::string& text) const { return std::ranges::count(texts, text); }

  tinyxml2::XMLDocument document;
  std::vector<std::string> texts;
  int lines = 0;
};

TEST(SeriesFigure, EachUnitHasAPanelAndEachSeriesAnEntryInTheLegend) {
  const SeriesSet set = collect_series(small_table(), {{"angle_deg.J1", "x_m.Head", "angle_degrees"}});
  const Picture picture(draw_series(set, "a title", "about"));
  EXPECT_EQ(picture.count("a title"), 2) << "above the panels, and for programs that read pictures aloud";
  for (const char* text : {"about", "angle (deg)", "x (m)", "angle degrees", "angle_deg.J1", "x_m.Head"}) {
    EXPECT_EQ(picture.count(text), 1) << text;
  }
  EXPECT_EQ(picture.count("time (s)"), 3) << "below each panel";
  EXPECT_EQ(picture.lines, 3);
}

TEST(SeriesFigure, WhatIsNotANumberIsAGap) {
  const Picture picture(draw_series(collect_series(small_table(), {{"angle_deg.J2"}}), "t", "a"));
  EXPECT_EQ(picture.lines, 2);
}

TEST(SeriesFigure, AColumnOfInfinitiesIsDrawnAsAnEmptyPanel) {
  const WriteTable table = table_with("Frequency.1", 3, [](std::uint32_t) { return ""; });
  const Picture picture(draw_series(collect_series(table, {{"Frequency.1"}}), "t", "a"));
  EXPECT_EQ(picture.lines, 0);
  EXPECT_EQ(picture.count("Frequency (Hz)"), 1);
}

TEST(SeriesFigure, APathHasTheSameScaleOnBothAxes) {
  const WriteTable table = table_with("x_m.A\ty_m.A", 5, [](std::uint32_t row) {
    return std::to_string(row % 2) + "\t" + std::to_string(10 * (row / 2));  // a path of 1 m by 20 m
  });
  const std::string svg = draw_series(collect_series(table, {{"y_m.A"}, "x_m.A", {}}), "t", "a");
  const Picture picture(svg);
  EXPECT_EQ(picture.count("x of A (m)"), 1);
  // From (0, 0) to (1, 0) and from there to (0, 10), in pixels.
  const std::size_t at = svg.find("<polyline points=\"") + 18;
  double x[3];
  double y[3];
  ASSERT_EQ(std::sscanf(svg.c_str() + at, "%lf,%lf %lf,%lf %lf,%lf", &x[0], &y[0], &x[1], &y[1], &x[2], &y[2]), 6);
  EXPECT_NEAR((y[1] - y[2]) / (x[1] - x[0]), 10.0, 0.05);
}

}  // namespace
}  // namespace proleg::sim
