#include "tools/proleg/document/robot_document.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "shipped.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

std::shared_ptr<const sim::TriangleMesh> coloured_triangle() {
  sim::TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {3, 0, 0}, {1, 4, 2}};
  mesh.triangles = {{0, 1, 2}};
  mesh.colours = {{1, 0, 0}, {0, 1, 0}, {0, 0, 0.5F}};
  return std::make_shared<const sim::TriangleMesh>(mesh);
}

TEST(RobotDocument, ShapesThatShareAMeshNameItByItsNumber) {
  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  const auto mesh = coloured_triangle();
  scenario.robot.links[0].looks.push_back({{{0, 0, 10}, {1, 0, 0, 0}}, mesh});
  scenario.robot.links[1].looks.push_back({{}, mesh});
  const json document = robot_document(scenario, "simulation");
  ASSERT_EQ(document["meshes"].size(), 1U);
  const json& shape = document["links"][0]["shapes"].back();
  EXPECT_EQ(shape["kind"], "mesh");
  EXPECT_EQ(shape["mesh"], 0);
  EXPECT_EQ(shape["size"], json({1.0, 2.0, 1.0})) << "half of the box around it";
  EXPECT_EQ(shape["pose"], json({2.0, 2.0, 11.0, 1.0, 0.0, 0.0, 0.0})) << "the middle of this box";
  EXPECT_EQ(document["links"][1]["shapes"].back()["mesh"], 0);
  // By Python: base64.b64encode(struct.pack("<9f", -1, -2, -1, 1, -2, -1, -1, 2, 1)), and so on.
  EXPECT_EQ(document["meshes"][0]["vertices"], "AACAvwAAAMAAAIC/AACAPwAAAMAAAIC/AACAvwAAAEAAAIA/");
  EXPECT_EQ(document["meshes"][0]["triangles"], "AAAAAAEAAAACAAAA");
  EXPECT_EQ(document["meshes"][0]["colours"], "/wAAAP8AAACA");
}

TEST(RobotDocument, AShapeThatALookReplacesIsNotThere) {
  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  scenario.robot.links[0].geometries[0].is_shown = false;
  EXPECT_TRUE(robot_document(scenario, "simulation")["links"][0]["shapes"].empty());
}

TEST(RobotDocument, HasObjectsThatMoveAndRulers) {
  sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  scenario.environment.moving_objects.push_back({"ball", {{1, 2, 3}, {1, 0, 0, 0}}, {}, {sim::Geometry{}}, {}});
  scenario.environment.rulers.push_back({{0, 0, 0}, {0, 5, 0}, 1.0, 0.2});
  const json document = robot_document(scenario, "simulation");
  EXPECT_EQ(document["objects"][0]["name"], "ball");
  EXPECT_EQ(document["objects"][0]["pose"][2], 3.0);
  EXPECT_EQ(document["objects"][0]["shapes"][0]["kind"], "box");
  EXPECT_EQ(document["rulers"][0],
            json({{"from", {0.0, 0.0, 0.0}}, {"to", {0.0, 5.0, 0.0}}, {"division", 1.0}, {"width", 0.2}}));
}

}  // namespace
}  // namespace proleg::tools
