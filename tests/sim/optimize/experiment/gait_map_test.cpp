#include "sim/optimize/experiment/gait_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "experiment_files.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"

namespace proleg::optimize {
namespace {

constexpr double failed = -1e12;

Experiment with_axes(const std::vector<std::uint32_t>& cells, Goal goal = Goal::maximise) {
  Experiment experiment;
  experiment.objectives.push_back({"score", {Term{}}, goal, goal == Goal::maximise ? 0.0 : 100.0});
  for (std::size_t i = 0; i < cells.size(); ++i) {
    experiment.axes.push_back({sim::Measure::height, -1.0, 3.0, cells[i]});
    experiment.objectives.push_back({"axis" + std::to_string(i), {Term{}}, Goal::maximise, failed});
  }
  experiment.method = MapElitesSettings{};
  return experiment;
}

TEST(GaitMap, KeepsTheBestOfEachCellAndOfEqualsTheFirst) {
  const Experiment experiment = with_axes({4, 2});
  GaitMap map(experiment);
  EXPECT_EQ(map.cells(), 8U);
  EXPECT_TRUE(map.add(7, std::vector{1.0, -0.5, 2.0}));
  EXPECT_FALSE(map.add(8, std::vector{1.0, -0.1, 2.5})) << "the same cell, and no better";
  EXPECT_TRUE(map.add(9, std::vector{1.5, -0.9, 1.1}));
  EXPECT_TRUE(map.add(10, std::vector{0.5, 2.9, -1.0}));
  ASSERT_EQ(map.elites().size(), 2U);
  EXPECT_EQ(map.elites()[0].candidate, 9U);
  EXPECT_EQ(map.place(map.elites()[0].cell), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(map.place(map.elites()[1].cell), (std::vector<std::uint32_t>{3, 0}));
  EXPECT_EQ(map.coverage(), 0.25);
  EXPECT_EQ(map.qd_score(), 2.0);
}

TEST(GaitMap, HasValuesBeyondAnAxisInItsOutermostCells) {
  const Experiment experiment = with_axes({4, 2});
  GaitMap map(experiment);
  map.add(0, std::vector{1.0, -1e300, 1e300});
  map.add(1, std::vector{1.0, 3.0, -1.0});
  EXPECT_EQ(map.place(map.elites()[0].cell), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(map.place(map.elites()[1].cell), (std::vector<std::uint32_t>{3, 0})) << "the bounds themselves";
}

TEST(GaitMap, FindsACellByItsPlaceAndByAValueAtItsMiddle) {
  const Experiment experiment = with_axes({4, 2, 3});
  GaitMap map(experiment);
  for (std::size_t cell = 0; cell < map.cells(); ++cell) {
    EXPECT_EQ(map.cell_at(map.place(cell)), cell);
    std::vector<double> scores = map.middle(cell);
    scores.insert(scores.begin(), 1.0);
    EXPECT_EQ(map.cell_of(scores), cell);
    EXPECT_EQ(map.elite_of(cell), nullptr);
    map.add(cell, scores);
    ASSERT_NE(map.elite_of(cell), nullptr);
    EXPECT_EQ(map.elite_of(cell)->candidate, cell);
  }
  EXPECT_EQ(map.middle(0), (std::vector{-0.5, 0.0, -1.0 + 2.0 / 3.0}));
  for (const std::vector<std::uint32_t>& place : std::vector<std::vector<std::uint32_t>>{
           {4, 0, 0}, {0, 2, 0}, {0, 0, 3}, {0, 0}, {0, 0, 0, 0}, {0, 0, 0xFFFFFFFF}}) {
    EXPECT_FALSE(map.cell_at(place));
  }
}

/// Candidates of the filled cells that are nearest to some values.
std::vector<std::size_t> nearest(const GaitMap& map, const std::vector<std::optional<double>>& values,
                                 std::size_t count) {
  std::vector<std::size_t> candidates;
  for (const GaitMap::Elite& elite : map.nearest(values, count)) {
    candidates.push_back(elite.candidate);
  }
  return candidates;
}

TEST(GaitMap, NamesTheFilledCellsThatAreNearestToSomeValues) {
  const Experiment experiment = with_axes({4, 2});  // cells of 1 x 2 from -1 to 3
  GaitMap map(experiment);
  map.add(0, std::vector{1.0, -0.5, 0.0});
  map.add(1, std::vector{2.0, -0.5, 2.0});
  map.add(2, std::vector{3.0, 2.5, 2.0});
  using Candidates = std::vector<std::size_t>;
  EXPECT_EQ(nearest(map, {-0.9, 0.9}, 9), (Candidates{0, 1, 2})) << "the cell of the values is first";
  EXPECT_EQ(nearest(map, {-0.9, 1.1}, 1), (Candidates{1}));
  EXPECT_EQ(nearest(map, {1.9, 2.0}, 2), (Candidates{2, 1}));
  EXPECT_EQ(nearest(map, {100.0, 100.0}, 1), (Candidates{2})) << "values beyond an axis are its end";
  EXPECT_EQ(nearest(map, {-0.5, std::nullopt}, 3), (Candidates{1, 0, 2})) << "of equally near cells the better";
  EXPECT_EQ(nearest(map, {std::nullopt, std::nullopt}, 3), (Candidates{2, 1, 0}));
}

TEST(GaitMap, HasNeighboursAlsoAtCorners) {
  const Experiment experiment = with_axes({4, 3});
  const GaitMap map(experiment);
  const auto cell = [&](std::uint32_t x, std::uint32_t y) { return map.cell_at(std::vector{x, y}).value(); };
  EXPECT_TRUE(map.are_neighbours(cell(1, 1), cell(1, 1)));
  EXPECT_TRUE(map.are_neighbours(cell(1, 1), cell(2, 2)));
  EXPECT_TRUE(map.are_neighbours(cell(1, 1), cell(0, 1)));
  EXPECT_FALSE(map.are_neighbours(cell(1, 1), cell(3, 1)));
  EXPECT_FALSE(map.are_neighbours(cell(3, 0), cell(0, 1))) << "their numbers follow each other";
}

TEST(GaitMap, HasTheMiddleOfACellAsSharesOfItsAxes) {
  const Experiment experiment = with_axes({4, 2});
  const GaitMap map(experiment);
  EXPECT_EQ(map.point(0), (std::vector<double>{0.125, 0.25}));
  EXPECT_EQ(map.point(7), (std::vector<double>{0.875, 0.75}));
}

TEST(GaitMap, HasNoRunThatFailedOrLacksAMeasure) {
  const Experiment experiment = with_axes({4, 2});
  GaitMap map(experiment);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<double>& scores : std::vector<std::vector<double>>{
           {0.0, 0.0, 0.0}, {1.0, failed, 0.0}, {1.0, 0.0, failed}, {nan, 0.0, 0.0}, {1.0, nan, 0.0}}) {
    EXPECT_FALSE(map.add(0, scores));
  }
  EXPECT_TRUE(map.elites().empty());
}

TEST(GaitMap, HasLessAsTheBetterScoreIfThatIsTheGoal) {
  const Experiment experiment = with_axes({2, 2}, Goal::minimise);
  GaitMap map(experiment);
  map.add(0, std::vector{30.0, 0.0, 0.0});
  EXPECT_TRUE(map.add(1, std::vector{10.0, 0.0, 0.0}));
  EXPECT_EQ(map.qd_score(), 90.0) << "how much better than a run that fails";
}

TEST(GaitMap, IsThatOfTheDefinitionInFourDimensions) {
  const unsigned seed = 20'261;
  std::mt19937 random(seed);
  const Experiment experiment = with_axes({3, 2, 4, 5});
  GaitMap map(experiment);
  std::map<std::vector<std::uint32_t>, std::pair<double, std::size_t>> expected;
  for (std::size_t i = 0; i < 3000; ++i) {
    std::vector<double> scores{1.0 + static_cast<double>(random() % 50)};
    std::vector<std::uint32_t> place;
    for (const MapAxis& axis : experiment.axes) {
      place.push_back(static_cast<std::uint32_t>(random() % axis.cells));
      scores.push_back(-1.0 + 4.0 * (place.back() + 0.5) / axis.cells);
    }
    const auto [found, is_new] = expected.try_emplace(place, scores.front(), i);
    if (!is_new && scores.front() > found->second.first) {
      found->second = {scores.front(), i};
    }
    map.add(i, scores);
  }
  ASSERT_EQ(map.elites().size(), expected.size()) << "seed " << seed;
  double sum = 0.0;
  for (const GaitMap::Elite& elite : map.elites()) {
    const auto& [score, candidate] = expected.at(map.place(elite.cell));
    EXPECT_EQ(elite.score, score);
    EXPECT_EQ(elite.candidate, candidate);
    sum += score;
  }
  EXPECT_NEAR(map.qd_score(), sum, 1e-9);
}

Experiment with_centroids(std::size_t axes, std::uint32_t centroids) {
  Experiment experiment = with_axes(std::vector<std::uint32_t>(axes, 0));
  experiment.method = MapElitesSettings{.centroids = centroids};
  return experiment;
}

TEST(GaitMapWithCentroids, HasACellOfOneNumberForEach) {
  for (std::size_t axes = min_map_axes; axes <= max_map_axes; ++axes) {
    const Experiment experiment = with_centroids(axes, 50);
    GaitMap map(experiment);
    ASSERT_EQ(map.cells(), 50U);
    ASSERT_EQ(map.place_numbers().size(), 1U);
    EXPECT_EQ(map.place_numbers().front().name, "number");
    EXPECT_EQ(map.place_numbers().front().count, 50U);
    for (std::size_t cell = 0; cell < map.cells(); ++cell) {
      EXPECT_EQ(map.place(cell), std::vector{static_cast<std::uint32_t>(cell)});
      EXPECT_EQ(map.place_text(cell), std::to_string(cell + 1));
      EXPECT_EQ(map.cell_at(map.place(cell)), cell);
      std::vector<double> scores = map.middle(cell);
      ASSERT_EQ(scores.size(), axes);
      scores.insert(scores.begin(), 1.0);
      EXPECT_EQ(map.cell_of(scores), cell);
      EXPECT_TRUE(map.add(cell, scores));
    }
    EXPECT_EQ(map.coverage(), 1.0);
    EXPECT_FALSE(map.cell_at(std::vector<std::uint32_t>{50}));
    EXPECT_FALSE(map.cell_at(std::vector<std::uint32_t>{1, 1}));
    EXPECT_FALSE(map.cell_at(std::vector<std::uint32_t>{}));
  }
}

TEST(GaitMapWithCentroids, HasValuesBeyondAnAxisInTheCellsOfItsEnds) {
  const Experiment experiment = with_centroids(2, 20);
  const GaitMap map(experiment);
  EXPECT_EQ(map.cell_of(std::vector{1.0, -1e300, 1e300}), map.cell_of(std::vector{1.0, -1.0, 3.0}));
  EXPECT_FALSE(map.cell_of(std::vector{1.0, failed, 0.0}));
}

TEST(GaitMapWithCentroids, NamesTheFilledCellWhoseCentroidIsNearest) {
  const Experiment experiment = with_centroids(3, 30);
  GaitMap map(experiment);
  for (std::size_t cell = 0; cell < map.cells(); cell += 2) {
    std::vector<double> scores = map.middle(cell);
    scores.insert(scores.begin(), 1.0 + static_cast<double>(cell));
    map.add(cell, scores);
  }
  const std::vector<double> middle = map.middle(4);
  EXPECT_EQ(nearest(map, {middle[0], middle[1], middle[2]}, 1), (std::vector<std::size_t>{4}));
  EXPECT_EQ(nearest(map, {std::nullopt, std::nullopt, std::nullopt}, 1), (std::vector<std::size_t>{28}))
      << "of equally near ones the best";
}

TEST(CheckMethod, WantsTwoToFourAxesAndOneObjective) {
  const auto refusal = [](Experiment experiment) -> std::string {
    experiment.path = "map.optimise.xml";
    try {
      check_method(experiment);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(with_axes({10, 10})), "");
  EXPECT_EQ(refusal(with_axes({10, 10, 10, 50})), "");
  EXPECT_EQ(refusal(with_axes({10})), "map.optimise.xml: found 1 <axis> in <fitness>, expected two to four");
  EXPECT_EQ(refusal(with_axes({2, 2, 2, 2, 2})),
            "map.optimise.xml: found 5 <axis>es in <fitness>, expected two to four");
  EXPECT_EQ(refusal(with_axes({300, 300})),
            "map.optimise.xml: found more than 50000 cells of the map, expected fewer, in all");
  EXPECT_EQ(refusal(with_centroids(2, 2)), "");
  EXPECT_EQ(refusal(with_centroids(2, 1)), "map.optimise.xml: found 1 centroid, expected 2 or more, or 0 for a grid");
  Experiment two = with_axes({2, 2});
  two.objectives.push_back(two.objectives.front());
  EXPECT_EQ(
      refusal(two),
      "map.optimise.xml: found 2 objectives for map-elites, expected one objective (a weighted sum of measures is "
      "one)");
}

MemoryFiles small_map() {
  MemoryFiles files = small_experiment();
  std::string& text = files.texts["top.optimise.xml"];
  for (const auto& [before, after] : std::vector<std::pair<std::string, std::string>>{
           {"<greatDeluge>", "<mapElites>"},
           {"</greatDeluge>", "</mapElites>"},
           {"<waterLevel>0.1</waterLevel>", "<first>50</first>"},
           {"<objective measure=\"distance\"/>",
            "<objective measure=\"distance\"/><axis measure=\"height\" lowest=\"-0.1\" highest=\"0.2\" "
            "cells=\"30\"/><axis measure=\"duty_factor\" lowest=\"0\" highest=\"1\" cells=\"20\"/>"}}) {
    text.replace(text.find(before), before.size(), after);
  }
  const std::size_t racing = text.find("<racing");
  text.erase(racing, text.find("/>", racing) + 2 - racing);  // it knows one measure
  return files;
}

TEST(MapExperiment, HasTheMeasuresOfItsAxesBehindTheObjective) {
  MemoryFiles files = small_map();
  const Experiment experiment = read_experiment("top.optimise.xml", files);
  EXPECT_NO_THROW(check_method(experiment));
  EXPECT_EQ(std::get<MapElitesSettings>(experiment.method).first, 50U);
  ASSERT_EQ(experiment.axes.size(), 2U);
  EXPECT_EQ(experiment.axes[0].lowest, -0.1);
  EXPECT_EQ(experiment.axes[1].cells, 20U);
  ASSERT_EQ(experiment.objectives.size(), 3U);
  EXPECT_EQ(experiment.objectives[1].name, "height");
  const std::string before = experiment.fingerprint();
  files.replace("top.optimise.xml", "cells=\"30\"", "cells=\"31\"");
  EXPECT_NE(read_experiment("top.optimise.xml", files).fingerprint(), before);
}

TEST(MapExperiment, CanHaveCentroidsInPlaceOfCellsOfTheAxes) {
  MemoryFiles files = small_map();
  const std::string grid = read_experiment("top.optimise.xml", files).fingerprint();
  files.replace("top.optimise.xml", "<first>", "<centroids>0</centroids><first>");
  EXPECT_EQ(read_experiment("top.optimise.xml", files).fingerprint(), grid) << "stores of earlier versions stay valid";
  files.replace("top.optimise.xml", "<centroids>0<", "<centroids>300<");
  try {
    static_cast<void>(read_experiment("top.optimise.xml", files));
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("found cells in <axis> of a map with 300 centroids, expected none: an "
                        "axis has cells in a grid only"),
              std::string::npos)
        << error.what();
  }
  files.replace("top.optimise.xml", "cells=\"30\"", "");
  files.replace("top.optimise.xml", "cells=\"20\"", "");
  const Experiment experiment = read_experiment("top.optimise.xml", files);
  EXPECT_NO_THROW(check_method(experiment));
  EXPECT_EQ(std::get<MapElitesSettings>(experiment.method).centroids, 300U);
  EXPECT_EQ(GaitMap(experiment).cells(), 300U);
  files.replace("top.optimise.xml", "<centroids>300<", "<centroids>301<");
  EXPECT_NE(read_experiment("top.optimise.xml", files).fingerprint(), experiment.fingerprint());
  files.replace("top.optimise.xml", "<centroids>301<", "<centroids>10001<");
  EXPECT_THROW(static_cast<void>(read_experiment("top.optimise.xml", files)), InputError);
}

TEST(MapExperiment, OfWhichAnAxisIsWrongIsRefusedWithItsLine) {
  struct Case {
    std::string before;
    std::string after;
    std::string message;
  };
  for (const Case& wrong : std::vector<Case>{
           {"\"height\"", "\"hight\"", "found unknown measure 'hight', expected one of "},
           {"\"duty_factor\"", "\"distance\"", "found a second 'distance' among objective and axes, expected "},
           {"highest=\"0.2\"", "highest=\"-0.1\"",
            "found highest -0.1 in <axis>, expected more than lowest, which is -0.1"},
           {"cells=\"30\"", "cells=\"1\"", "expected "},
           {"cells=\"30\"", "", "expected "},
           {"lowest=\"0\"", "lowest=\"nan\"", "expected "},
           {"<mapElites>", "<greatDeluge>", ""}}) {
    MemoryFiles files = small_map();
    files.replace("top.optimise.xml", wrong.before, wrong.after);
    if (wrong.before == "<mapElites>") {  // another method has no axes
      files.replace("top.optimise.xml", "</mapElites>", "</greatDeluge>");
      files.replace("top.optimise.xml", "<first>50</first>", "");
    }
    try {
      static_cast<void>(read_experiment("top.optimise.xml", files));
      ADD_FAILURE() << wrong.after;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(wrong.message), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).rfind("top.optimise.xml:", 0), 0U) << error.what();
    }
  }
}

}  // namespace
}  // namespace proleg::optimize
