#include "sim/optimize/report/crossing_figure.hpp"

#include <cmath>

#include "made_up.hpp"

namespace proleg::optimize {
namespace {

sim::Geometry box(double half_length) {
  sim::Geometry geometry;
  geometry.shape = sim::Shape::box;
  geometry.extents = {0.5, half_length, 0.01};
  return geometry;
}

/// A floor of 2 m, and an obstacle from y = 1 m to 1.5 m. The robot has two links.
sim::Scenario small_scenario() {
  sim::Scenario scenario;
  sim::StaticObject floor;
  floor.name = "floor";
  floor.geometries = {box(2.0)};
  sim::StaticObject obstacle;
  obstacle.name = "obstacle";
  obstacle.geometries = {box(0.25)};
  obstacle.pose.position = {0.0, 1.25, 0.02};
  scenario.environment.objects = {floor, obstacle};
  scenario.robot.links.resize(2);
  for (sim::Link& link : scenario.robot.links) {
    link.geometries = {box(0.03)};
  }
  return scenario;
}

CrossingStage stage_at(double y, const std::string& name) {
  CrossingStage stage{name, 12.34, std::vector<sim::Pose>(2), {0, 1}};
  stage.link_poses[0].position = {0.0, y, 0.05};
  stage.link_poses[1].position = {0.0, y - 0.07, 0.05};
  return stage;
}

TEST(ObstacleExtent, IsThatOfTheObjectOfThisName) {
  sim::Scenario scenario = small_scenario();
  const ObstacleExtent extent = obstacle_extent(scenario.environment);
  EXPECT_DOUBLE_EQ(extent.from, 1.0);
  EXPECT_DOUBLE_EQ(extent.to, 1.5);
  scenario.environment.objects.pop_back();
  EXPECT_EQ(obstacle_extent(scenario.environment).to, 0.0);
}

TEST(CrossingFigure, HasAPictureOfEachStage) {
  const sim::Scenario scenario = small_scenario();
  const std::vector<CrossingStage> stages{stage_at(1.1, "on the first hill"), stage_at(1.4, "on the last hill")};
  Picture picture(draw_crossing(scenario, stages));
  EXPECT_TRUE(picture.has_text("(a) on the first hill, after 12.3 s"));
  EXPECT_TRUE(picture.has_text("(b) on the last hill, after 12.3 s"));
  EXPECT_EQ(picture.lines("robot"), 4U) << "two links in each stage";
  EXPECT_EQ(picture.lines("world"), 4U) << "floor and obstacle";
}

TEST(CrossingFigure, LeavesOutWhatIsOutsideOfThePicture) {
  const sim::Scenario scenario = small_scenario();
  Picture picture(draw_crossing(scenario, std::vector{stage_at(99.0, "far away")}));
  EXPECT_EQ(picture.lines("robot"), 0U);
  EXPECT_FALSE(Picture(draw_crossing(scenario, {})).has_text("(a)"));
}

TEST(DistanceFigure, HasAMarkForEachGaitAndASegmentForEachMetre) {
  const sim::Scenario scenario = small_scenario();
  const std::vector<RulerMark> marks{{"no reflex", 1.43}, {"genetic", 4.01}};
  Picture picture(draw_distances(scenario, marks));
  EXPECT_TRUE(picture.has_text("no reflex 1.43 m"));
  EXPECT_TRUE(picture.has_text("genetic 4.01 m"));
  EXPECT_TRUE(picture.has_text("5 m"));
}

TEST(DistanceFigure, IsDrawnWhateverTheDistances) {
  const sim::Scenario scenario = small_scenario();
  EXPECT_TRUE(Picture(draw_distances(scenario, {})).has_text("1 m"));
  EXPECT_TRUE(Picture(draw_distances(scenario, std::vector<RulerMark>{{"back", -3.0}, {"", 0.0}})).has_text("back"));
}

}  // namespace
}  // namespace proleg::optimize
