#include "sim/record/plot_frame.hpp"

#include <gtest/gtest.h>

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>

namespace proleg::sim {
namespace {

TEST(Axis, MapsItsEndsToPixels) {
  const Axis axis{-2.0, 6.0, 300.0, 100.0};
  EXPECT_DOUBLE_EQ(axis.pixel(-2.0), 300.0);
  EXPECT_DOUBLE_EQ(axis.pixel(6.0), 100.0);
  EXPECT_DOUBLE_EQ(axis.pixel(2.0), 200.0);
}

TEST(NiceStep, IsTheNextOfOneTwoFive) {
  EXPECT_DOUBLE_EQ(nice_step(1.0), 1.0);
  EXPECT_DOUBLE_EQ(nice_step(1.1), 2.0);
  EXPECT_DOUBLE_EQ(nice_step(2.1), 5.0);
  EXPECT_DOUBLE_EQ(nice_step(7.0), 10.0);
  EXPECT_DOUBLE_EQ(nice_step(0.3 / 3.0), 0.1);
  EXPECT_DOUBLE_EQ(nice_step(0.00021), 0.0005);
  EXPECT_DOUBLE_EQ(nice_step(34'000.0), 50'000.0);
}

TEST(Multiples, IncludeTheEndsOfTheRange) {
  const std::vector<double> values = multiples(-0.3, 0.3, 0.1);
  ASSERT_EQ(values.size(), 7U);
  EXPECT_NEAR(values.front(), -0.3, 1e-12);
  EXPECT_EQ(values[3], 0.0);
  EXPECT_TRUE(multiples(0.11, 0.19, 0.1).empty());
}

TEST(Spread, DoesNotMoveWhatIsApart) {
  EXPECT_EQ(spread({50.0, 10.0, 90.0}, 15.0, 0.0, 100.0), (std::vector<double>{50.0, 10.0, 90.0}));
}

TEST(Spread, KeepsTheGapTheOrderAndTheRange) {
  const std::vector<double> crowded{99.0, 98.0, 50.0, 97.0, 50.0};
  const std::vector<double> places = spread(crowded, 15.0, 0.0, 100.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_GE(places[i], 0.0);
    EXPECT_LE(places[i], 100.0);
    for (std::size_t j = 0; j < places.size(); ++j) {
      if (i != j) {
        EXPECT_GE(std::abs(places[i] - places[j]), 15.0);
      }
      if (crowded[i] < crowded[j]) {
        EXPECT_LT(places[i], places[j]);
      }
    }
  }
}

TEST(AxisOver, ContainsItsValuesWithRoomAroundThem) {
  for (const auto& [low, high] : {std::pair(0.0, 1.0), std::pair(-3e-5, 2e-5), std::pair(1e6, 1e6 + 1.0),
                                  std::pair(5.0, 5.0), std::pair(0.0, 0.0), std::pair(-1e12, 1e12)}) {
    const Axis axis = axis_over(low, high, 100.0, 0.0);
    EXPECT_LT(axis.low, low);
    EXPECT_GT(axis.high, high);
    EXPECT_TRUE(std::isfinite(axis.pixel(low)) && std::isfinite(axis.pixel(high)));
    EXPECT_GT(axis.pixel(low), axis.pixel(high) - 1e-9);
  }
}

TEST(ToPixels, KeepsEveryPeakOfALongLineAndFewPoints) {
  Polyline trace;
  for (int i = 0; i < 100'000; ++i) {
    trace.push_back({static_cast<double>(i), i == 54'321 ? 3.0 : i == 77'777 ? -2.0 : 0.001 * (i % 7)});
  }
  const Axis x{0.0, 100'000.0, 0.0, 500.0};
  const Axis y{-2.0, 3.0, 100.0, 0.0};
  const Polyline pixels = to_pixels(trace, x, y);
  EXPECT_LE(pixels.size(), 4U * 500U);
  const auto has = [&](double height) {
    return std::ranges::any_of(pixels, [height](const Point& point) { return point.y == height; });
  };
  EXPECT_TRUE(has(0.0));
  EXPECT_TRUE(has(100.0));
}

TEST(ToPixels, StaysWithinTheAxes) {
  const Axis x{0.0, 10.0, 100.0, 200.0};
  const Axis y{0.0, 1.0, 50.0, 0.0};
  for (const Point& point : to_pixels({{0.0, -1e300}, {5.0, 1e300}, {11.0, 0.5}}, x, y)) {
    EXPECT_TRUE(point.x >= 100.0 && point.x <= 200.0 && point.y >= 0.0 && point.y <= 50.0);
  }
}

TEST(ToMarks, OmitsHiddenMarks) {
  const Axis x{0.0, 100.0, 0.0, 100.0};
  const Axis y{0.0, 100.0, 100.0, 0.0};
  Polyline cloud;
  for (int i = 0; i < 200'000; ++i) {
    cloud.push_back({std::fmod(i * 0.618034, 1.0) * 100.0, std::fmod(i * 0.414214, 1.0) * 100.0});
  }
  EXPECT_LE(to_marks(cloud, x, y, 5.0).size(), 21U * 21U);
  EXPECT_EQ(to_marks({{10.0, 10.0}, {60.0, 60.0}, {10.0, 10.0}}, x, y, 5.0).size(), 2U);
}

TEST(PlotGrid, NumbersItsAxesSoThatNeighboursDiffer) {
  for (const auto& [low, high] : {std::pair(0.0, 1.0), std::pair(2e-9, 5e-9), std::pair(3e8, 9e8),
                                  std::pair(1e8, 1.0000001e8), std::pair(-0.4, 0.3)}) {
    Svg svg(400.0, 400.0, "", "");
    draw_plot_grid(svg, axis_over(low, high, 50.0, 350.0), axis_over(0.0, 1.0, 350.0, 50.0), "x", "y");
    tinyxml2::XMLDocument document;
    ASSERT_EQ(document.Parse(svg.finish().c_str()), tinyxml2::XML_SUCCESS);
    std::vector<std::string> numbers;
    for (const auto* text = document.RootElement()->FirstChildElement("text"); text != nullptr;
         text = text->NextSiblingElement("text")) {
      if (std::string(text->Attribute("text-anchor")) == "middle" && std::string(text->GetText()) != "x") {
        numbers.emplace_back(text->GetText());
      }
    }
    ASSERT_GE(numbers.size(), 3U);
    for (std::size_t i = 1; i < numbers.size(); ++i) {
      EXPECT_LT(std::stod(numbers[i - 1]), std::stod(numbers[i]));
      EXPECT_LE(numbers[i].size(), 10U) << numbers[i];
    }
  }
}

TEST(Legend, ShowsASampleAndAName) {
  Svg svg(400.0, 100.0, "", "");
  const std::vector<LegendEntry> entries{{"a line", R"(stroke="#000000")", ""},
                                         {"a <dot>", R"(stroke="#111111")", "h0"}};
  draw_legend(svg, 380.0, 50.0, entries);
  const std::string picture = svg.finish();
  EXPECT_NE(picture.find(">a line<"), std::string::npos);
  EXPECT_NE(picture.find(">a &lt;dot&gt;<"), std::string::npos);
  EXPECT_NE(picture.find("<path d=\"M"), std::string::npos);
}

TEST(LineNames, KeepApart) {
  Svg svg(400.0, 400.0, "", "");
  const std::vector<LineName> names{{1.0, "one", "#000000"}, {1.0, "two", "#000000"}, {1e300, "three", "#000000"}};
  draw_line_names(svg, {0.0, 2.0, 350.0, 50.0}, 300.0, names);
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(svg.finish().c_str()), tinyxml2::XML_SUCCESS);
  std::vector<double> heights;
  for (const auto* text = document.RootElement()->FirstChildElement("text"); text != nullptr;
       text = text->NextSiblingElement("text")) {
    heights.push_back(text->DoubleAttribute("y"));
  }
  ASSERT_EQ(heights.size(), 3U);
  EXPECT_GE(std::abs(heights[0] - heights[1]), 14.9);
  EXPECT_GE(std::abs(heights[1] - heights[2]), 14.9);
}

}  // namespace
}  // namespace proleg::sim
