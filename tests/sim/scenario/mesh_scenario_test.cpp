// Meshes, height fields, bodies that move and rulers in the files of a scenario.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "memory_files.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/sources.hpp"
#include "tests/sim/mesh/mesh_shapes.hpp"

namespace proleg::sim {
namespace {

constexpr const char* head_geometry = "<Geom type=\"sphere\">\n        <radius>0.03</radius>\n      </Geom>";

MemoryFiles with_head(const std::string& geometry) {
  MemoryFiles files = small_scenario();
  files.texts["box.off"] = box_off;
  files.replace("robot.xml", head_geometry, geometry);
  return files;
}

MemoryFiles with_objects(const std::string& objects) {
  MemoryFiles files = small_scenario();
  files.texts["box.off"] = box_off;
  files.replace("environment.xml", "</Environment>", objects + "</Environment>");
  return files;
}

std::string body(const std::string& type, const std::string& contents) {
  return "<KinBody name=\"thing\"><Body type=\"" + type + "\">" + contents + "</Body></KinBody>";
}

void expect_refused(const MemoryFiles& files, const std::string& part) {
  const std::string text = refusal(files);
  EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_NE(text.find(", expected "), std::string::npos) << text;
}

const Geometry& head_solid(const Scenario& scenario) { return scenario.robot.links.front().geometries.at(0); }

TEST(MeshScenario, AMeshOfALinkBecomesItsHullAndIsShownAsItIs) {
  const Scenario scenario =
      with_head("<Geom type=\"trimesh\"><data>box.off 0.1</data><friction>0.4</friction></Geom>").scenario();
  const Geometry& solid = head_solid(scenario);
  EXPECT_EQ(solid.shape, Shape::hull);
  EXPECT_FALSE(solid.is_shown);
  EXPECT_EQ(solid.friction, 0.4);
  EXPECT_TRUE(solid.extents.isApprox(Eigen::Vector3d(0.01, 0.02, 0.03), 1e-6));
  ASSERT_EQ(scenario.robot.links.front().looks.size(), 1U);
  EXPECT_EQ(scenario.robot.links.front().looks[0].mesh->triangles.size(), 12U);
}

TEST(MeshScenario, AScaleOfThreeNumbersIsForEachAxis) {
  const Scenario scenario = with_head("<Geom type=\"trimesh\"><data>box.off 0.1 0.2 0.3</data></Geom>").scenario();
  EXPECT_TRUE(head_solid(scenario).extents.isApprox(Eigen::Vector3d(0.01, 0.04, 0.09), 1e-6));
}

TEST(MeshScenario, ThePathOfAMeshMayHaveBlanks) {
  const auto has_size = [](const std::string& text, const std::string& name, const Eigen::Vector3d& size) {
    MemoryFiles files = with_head("<Geom type=\"trimesh\"><data>" + text + "</data></Geom>");
    files.texts[name] = box_off;
    return head_solid(files.scenario()).extents.isApprox(size, 1e-6);
  };
  const Eigen::Vector3d half(0.1, 0.2, 0.3);
  EXPECT_TRUE(has_size("my body.off", "my body.off", half));
  EXPECT_TRUE(has_size("my body.off 2", "my body.off", 2.0 * half));
  EXPECT_TRUE(has_size(" my  2 body.off\n1 2 +3 ", "my  2 body.off", {0.1, 0.4, 0.9}));
  EXPECT_TRUE(has_size("sub dir/b.off 2", "sub dir/b.off", 2.0 * half));
  EXPECT_TRUE(has_size("\"sub dir/b.off\" 2", "sub dir/b.off", 2.0 * half));
  EXPECT_TRUE(has_size("'box.off'", "box.off", half));
  EXPECT_TRUE(has_size("box.off 2.off 3", "box.off 2.off", 3.0 * half)) << "the longest beginning that is a file";
}

TEST(MeshScenario, ARenderedPathMayHaveBlanks) {
  MemoryFiles files = with_head("<Geom type=\"sphere\"><radius>0.03</radius><render>my body.off 0.1</render></Geom>");
  files.texts["my body.off"] = box_off;
  EXPECT_EQ(files.scenario().robot.links.front().looks.size(), 1U);
  files.texts.erase("my body.off");
  expect_refused(files, "no such file 'my body.off'");
  expect_refused(with_head("<Geom type=\"sphere\"><radius>0.03</radius><render>banana</render></Geom>"),
                 "'banana' in <render>, expected 'true', '1', 'false' or '0'");
}

TEST(MeshScenario, ARenderedMeshReplacesWhatIsShownAndNotWhatTouches) {
  const Scenario scenario =
      with_head("<Geom type=\"sphere\"><radius>0.03</radius><render>box.off 0.1</render></Geom>").scenario();
  EXPECT_EQ(head_solid(scenario).shape, Shape::sphere);
  EXPECT_FALSE(head_solid(scenario).is_shown);
  EXPECT_EQ(scenario.robot.links.front().looks.size(), 1U);
}

TEST(MeshScenario, AMeshOnlyForTheEyeDoesNotTouch) {
  const Scenario scenario = with_head(std::string(head_geometry) +
                                      "<Geom type=\"trimesh\"><render>box.off 0.1</render>"
                                      "<diffuseColor>1 0 0.5</diffuseColor></Geom>")
                                .scenario();
  EXPECT_EQ(scenario.robot.links.front().geometries.size(), 1U);
  ASSERT_EQ(scenario.robot.links.front().looks.size(), 1U);
  const TriangleMesh& mesh = *scenario.robot.links.front().looks[0].mesh;
  ASSERT_EQ(mesh.colours.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.colours[0], Eigen::Vector3f(1.0F, 0.0F, 0.5F));
}

TEST(MeshScenario, TheMassOfAHullIsThatOfItsSolid) {
  MemoryFiles files = with_objects(body(
      "dynamic",
      "<Geom type=\"trimesh\"><data>box.off</data></Geom><Mass type=\"mimicgeom\"><density>1000</density></Mass>"));
  const MovingObject object = files.scenario().environment.moving_objects.at(0);
  EXPECT_NEAR(object.mass.mass, 48.0, 1e-4);
  EXPECT_NEAR(object.mass.center.norm(), 0.0, 1e-7);
  EXPECT_NEAR(object.mass.inertia(0, 0), 48.0 / 12.0 * (0.16 + 0.36), 1e-4);
}

TEST(MeshScenario, LinksThatNameTheSameFileShareAMesh) {
  const std::string geometry = "<Geom type=\"trimesh\"><data>box.off 0.1</data></Geom>";
  const Scenario scenario = with_head(geometry + geometry).scenario();
  const std::vector<Geometry>& solids = scenario.robot.links.front().geometries;
  EXPECT_EQ(solids.at(0).mesh, solids.at(1).mesh);
}

TEST(MeshScenario, LinksWithTheSameFileAndColourShareAMesh) {
  const auto geometry = [](const std::string& colour) {
    return "<Geom type=\"trimesh\"><data>box.off 0.1</data><diffuseColor>" + colour + "</diffuseColor></Geom>";
  };
  const Scenario scenario = with_head(geometry("1 0 0") + geometry("1 0 0") + geometry("0 0 1")).scenario();
  const std::vector<Look>& looks = scenario.robot.links.front().looks;
  EXPECT_EQ(looks.at(0).mesh, looks.at(1).mesh);
  EXPECT_EQ(looks.at(2).mesh->colours.at(0), Eigen::Vector3f(0.0F, 0.0F, 1.0F));
}

TEST(MeshScenario, AMeshCountsOnceTowardsTheSizeOfAScenario) {
  MemoryFiles files = small_scenario();
  files.texts["box.off"] = box_off + std::string(8U << 20U, '\n');
  std::string geometries;
  for (int count = 0; count < 20; ++count) {
    geometries += "<Geom type=\"trimesh\"><data>box.off 0.1</data></Geom>";
  }
  files.replace("robot.xml", head_geometry, geometries);
  EXPECT_EQ(files.scenario().robot.links.front().geometries.size(), 20U);
}

TEST(MeshScenario, MaterialsAreRecordedAndCountTowardsTheSizeOfAScenario) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl m\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  MemoryFiles files = with_head("<Geom type=\"trimesh\"><data>a.obj 0.1</data></Geom>");
  files.texts["a.obj"] = "mtllib a.mtl\n" + mesh;
  files.texts["a.mtl"] = "newmtl m\nKd 1 0 0\n";
  const Scenario scenario = files.scenario();
  EXPECT_TRUE(std::ranges::any_of(scenario.sources, [](const SourceFile& file) { return file.path == "a.mtl"; }));
  EXPECT_EQ(scenario.robot.links.front().looks.at(0).mesh->colours.at(0), Eigen::Vector3f(1, 0, 0));

  files.texts["a.obj"] = mesh;
  for (const std::string name : {"1.mtl", "2.mtl", "3.mtl", "4.mtl"}) {
    files.texts["a.obj"].insert(0, "mtllib " + name + '\n');
    files.texts[name] = "newmtl m\n" + std::string((16U << 20U) - 10'000, '\n');
  }
  EXPECT_EQ(refusal(files), "nothing");
  files.texts["a.obj"].insert(0, "mtllib a.mtl\n");
  files.texts["a.mtl"].append(100'000, '\n');
  expect_refused(files, "more than 1000 included files or 64 MiB");
}

TEST(MeshScenario, AStaticMeshStaysAsItIs) {
  const Scenario scenario =
      with_objects(body("static", "<Geom type=\"trimesh\"><data>box.off</data></Geom>")).scenario();
  const StaticObject& object = scenario.environment.objects.back();
  EXPECT_EQ(object.geometries.at(0).shape, Shape::surface);
  EXPECT_TRUE(object.geometries[0].is_shown);
  EXPECT_EQ(object.geometries[0].mesh->triangles.size(), 12U);
}

TEST(MeshScenario, AMeshCanBeTextAndFacesOutwards) {
  // A tetrahedron whose triangles are listed inwards.
  const Scenario scenario = with_objects(body("static",
                                              "<Geom type=\"trimesh\"><vertices>0 0 0  1 0 0  0 1 0  0 0 1</vertices>"
                                              "<triangles>0 1 2  0 3 1  0 2 3  1 3 2</triangles></Geom>"))
                                .scenario();
  const TriangleMesh& mesh = *scenario.environment.objects.back().geometries.at(0).mesh;
  EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 2, 1})) << "the lowest side faces down";
}

TEST(MeshScenario, ThreeVerticesAreATriangleWithoutNumbers) {
  const Scenario scenario = with_objects(body("static",
                                              "<Geom type=\"trimesh\" open=\"1\"><vertices>0 0 0  1 0 0  0 1 0  "
                                              "1 0 0  1 1 0  0 1 0</vertices></Geom>"))
                                .scenario();
  EXPECT_EQ(scenario.environment.objects.back().geometries.at(0).mesh->triangles.size(), 2U);
}

TEST(MeshScenario, ARobotOnAMeshStartsAboveIt) {
  // The top of the box is at 0.3; the bottom of the robot 0.03 below its origin.
  MemoryFiles files = with_objects(body("static", "<Geom type=\"trimesh\"><data>box.off 10 10 1</data></Geom>"));
  files.replace("environment.xml", "Pose: ,0 0 0.1,0 0 0,", "Pose: ,0 0 0,0 0 0,");
  const Scenario scenario = files.scenario();
  EXPECT_NEAR(scenario.environment.robot_pose.position.z(), 0.33, 1e-6);
  EXPECT_NE(scenario.remarks.back().find("rests on 'thing'"), std::string::npos) << scenario.remarks.back();
  EXPECT_TRUE(scenario.warnings.empty());
}

TEST(MeshScenario, AHeightFieldHasRowsAlongYAndColumnsAlongX) {
  const Scenario scenario =
      with_objects(body("static",
                        "<Geom type=\"heightfield\"><extents>1 2</extents><columns>3</columns><rows>2</rows>"
                        "<heights>0 0 0.1  0 0 0.2</heights></Geom>"))
          .scenario();
  const Geometry& field = scenario.environment.objects.back().geometries.at(0);
  EXPECT_EQ(field.shape, Shape::height_field);
  EXPECT_EQ(field.mesh->vertices.at(2), Eigen::Vector3d(1, -2, 0.1));
  EXPECT_EQ(field.mesh->vertices.at(5), Eigen::Vector3d(1, 2, 0.2));
}

TEST(MeshScenario, HeightsMayBeInAFile) {
  MemoryFiles files = with_objects(body("static",
                                        "<Geom type=\"heightfield\"><extents>1 1</extents><columns>2</columns>"
                                        "<rows>2</rows><data>heights.txt</data></Geom>"));
  files.texts["heights.txt"] = "0.1 0.2\n0.3 0.4\n";
  EXPECT_EQ(files.scenario().environment.objects.back().geometries.at(0).heights->heights,
            (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
  files.texts["heights.txt"] = "0.1 0.2 0.3";
  expect_refused(files, "3 heights in 'heights.txt', expected 4, one for each column of each row");
  files.texts["heights.txt"] = "0.1 0.2\n0.3 x\n";
  expect_refused(files, "'x' in line 2 of 'heights.txt', expected numbers");
  files.texts["heights.txt"] = "0.1 0.2\n0.3 0.4\n0.5 0.6\n";
  expect_refused(files, "more than 4 numbers in 'heights.txt'");
  files.texts["heights.txt"] =
      "\xEF\xBB\xBF"
      "0.1 0.2\r\n0.3 0.4\r\n";  // as Notepad writes it
  EXPECT_EQ(files.scenario().environment.objects.back().geometries.at(0).heights->heights,
            (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
}

TEST(MeshScenario, NumbersForUnknownHeightsAreNoHeights) {
  MemoryFiles files = with_objects(body("static",
                                        "<Geom type=\"heightfield\"><extents>1 1</extents><columns>2</columns>"
                                        "<rows>2</rows><data>dem.asc</data></Geom>"));
  // As GDAL, GRASS and ArcGIS write them: for whole numbers of 16 and 32 bits, and for floating point.
  for (const std::string unknown : {"-9999", "-9999.0", "-9.999e3", "-32768", "-32767", "-2147483648", "1e20", "-99999",
                                    "-3.4028235e+38", "3.40282e38", "nan", "NaN", "*"}) {
    files.texts["dem.asc"] = "0.1 0.2\n0.3 " + unknown + "\n";
    expect_refused(files, "found '" + unknown + "' in line 2 of 'dem.asc'");
    expect_refused(files, "height");
  }
  files.texts["dem.asc"] = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n1 2\n3 4\n";
  expect_refused(files,
                 "found 'ncols' in line 1 of 'dem.asc', expected numbers from -10000 to 10000 m; a file has heights");
  expect_refused(with_objects(body("static",
                                   "<Geom type=\"heightfield\"><extents>1 1</extents><columns>2</columns>"
                                   "<rows>2</rows><heights>0 0 -9999 0</heights></Geom>")),
                 "found '-9999' in <heights>, which stands for an unknown height");
}

TEST(MeshScenario, NumbersMayHaveAPlus) {
  const Scenario scenario = with_objects(body("static",
                                              "<translation>+1 +2.5 +0</translation>"
                                              "<Geom type=\"heightfield\"><extents>+1 +1</extents><columns>+2</columns>"
                                              "<rows>+2</rows><heights>+0.1 -0.2 +3e-1 +0</heights></Geom>"))
                                .scenario();
  EXPECT_EQ(scenario.environment.objects.back().pose.position, Eigen::Vector3d(1, 2.5, 0));
  EXPECT_EQ(scenario.environment.objects.back().geometries.at(0).heights->heights,
            (std::vector<double>{0.1, -0.2, 0.3, 0.0}));
}

TEST(MeshScenario, ABodyThatMovesHasItsPoseMassAndShape) {
  const Scenario scenario = with_objects(
                                "<KinBody name=\"ball\"><Body type=\"dynamic\"><translation>0 2 0.1"
                                "</translation><Geom type=\"sphere\"><radius>0.1</radius><friction>0.3"
                                "</friction></Geom><Mass type=\"mimicgeom\"><total>2</total></Mass></Body>"
                                "</KinBody>")
                                .scenario();
  EXPECT_EQ(scenario.environment.objects.size(), 1U) << "only the floor stands still";
  const MovingObject& ball = scenario.environment.moving_objects.at(0);
  EXPECT_EQ(ball.name, "ball");
  EXPECT_EQ(ball.pose.position, Eigen::Vector3d(0, 2, 0.1));
  EXPECT_NEAR(ball.mass.inertia(0, 0), 0.4 * 2.0 * 0.01, 1e-12);
  EXPECT_EQ(ball.geometries.at(0).friction, 0.3);
}

TEST(MeshScenario, ARulerHasItsEndsAndSegments) {
  const Scenario scenario =
      with_objects("<ruler><from>0 1 0</from><to>0 6 0</to><division>0.5</division></ruler>").scenario();
  const Ruler& ruler = scenario.environment.rulers.at(0);
  EXPECT_EQ(ruler.to, Eigen::Vector3d(0, 6, 0));
  EXPECT_EQ(ruler.division, 0.5);
  EXPECT_EQ(ruler.width, 0.1);
}

TEST(MeshScenario, BadMeshesAreRefusedWithFileAndLine) {
  const auto of_link = [](const std::string& text) { return with_head("<Geom type=\"trimesh\">" + text + "</Geom>"); };
  const auto of_world = [](const std::string& text) {
    return with_objects(body("static", "<Geom type=\"trimesh\">" + text + "</Geom>"));
  };
  expect_refused(of_link("<data>missing.stl</data>"), "robot.xml:");
  expect_refused(of_link("<data>missing.stl</data>"), "no such file 'missing.stl'");
  expect_refused(of_link("<data>my missing.stl 1 2 3</data>"), "no such file 'my missing.stl'");
  expect_refused(of_link("<data>box.off 1 2 3 4</data>"), "a file and 1 or 3 scales");
  expect_refused(of_link("<data>box.off x</data>"), "the scale 'x'");
  expect_refused(of_link("<data></data>"), "a file and 1 or 3 scales");
  expect_refused(of_link("<data>\"\"</data>"), "a file and 1 or 3 scales");
  expect_refused(of_link("<data>\"box.off</data>"), "no such file '\"box.off'");
  expect_refused(of_link("<data>box.off 100</data>"), "a mesh of 20 x 40 x 60 m");
  expect_refused(of_link("<data>box.off 100</data>"), "needs the scale 0.001");
  expect_refused(of_link("<data>box.off 0.0001</data>"), "needs the scale 1000");
  expect_refused(of_link("<data>box.off 1 2</data>"), "a file and 1 or 3 scales");
  expect_refused(of_link("<data>box.off -1</data>"), "the scale '-1'");
  expect_refused(of_link("<data>box.off</data><collision>box.off</collision>"), "more than one of");
  expect_refused(of_link("<data>box.off</data><triangles>0 1 2</triangles>"), "<triangles> without <vertices>");
  expect_refused(of_link(""), "no mesh in <Geom>");
  expect_refused(of_link("<vertices>0 0 0 1 0 0 0 1 0</vertices>"), "a flat mesh");
  expect_refused(of_world("<vertices>0 0 0 1 0 0 0 1 0</vertices>"), "a mesh with holes: 3 of 3 edges");
  expect_refused(of_world("<vertices>0 0 0 1 0 0 2 0 0</vertices>"), "without area");
  expect_refused(of_world("<vertices>0 0 0 1 0</vertices>"), "5 numbers");
  expect_refused(of_world("<vertices>0 0 0 1 0 0 0 1 nan</vertices>"), "'nan'");
  expect_refused(of_world("<vertices>0 0 0 1 0 0 0 1 0</vertices><triangles>0 1 3</triangles>"), "'3' in <triangles>");
  expect_refused(of_world("<vertices>0 0 0 1 0 0 0 1 0</vertices><triangles>0 1</triangles>"), "2 corners");
}

TEST(MeshScenario, ADamagedFileIsRefused) {
  MemoryFiles files = with_head("<Geom type=\"trimesh\"><data>box.off</data></Geom>");
  files.texts["box.off"] = "OFF\n8 6 0\n0 0";
  expect_refused(files, "'box.off'");
}

TEST(MeshScenario, BadBodiesAndRulersAreRefused) {
  const std::string ball = "<Geom type=\"sphere\"><radius>0.1</radius></Geom>";
  const std::string mass = "<Mass type=\"mimicgeom\"><total>1</total></Mass>";
  expect_refused(with_objects(body("dynamic", ball)), "<Mass>");
  expect_refused(with_objects(body("dynamic", "<Mass type=\"box\"><total>1</total><extents>1 1 1</extents></Mass>")),
                 "without a <Geom>");
  expect_refused(with_objects(body("loose", ball + mass)), "'static' for an object that stays");
  expect_refused(with_objects("<KinBody name=\"a\"><Body>" + ball + "</Body></KinBody>"), "no type in <Body>");
  expect_refused(with_objects(body("dynamic",
                                   "<Geom type=\"heightfield\"><extents>1 1</extents><columns>2</columns><rows>2"
                                   "</rows><heights>0 0 0 0</heights></Geom>" +
                                       mass)),
                 "a height field in a body that moves");
  expect_refused(with_objects("<ruler><from>0 0 0</from><to>0 0 0</to></ruler>"), "a ruler of 0 m");
  expect_refused(with_objects("<ruler><from>0 0 0</from><to>0 9 0</to><division>0.001</division></ruler>"),
                 "1 to 1000 segments");
}

TEST(MeshScenario, AFileOfBytesIsKeptAsTextAndReadAgain) {
  std::string bytes(84, '\0');
  bytes[83] = '\x01';
  bytes += std::string("\xff\xfe\x00\x80", 4);
  for (std::size_t cut = 0; cut < 3; ++cut) {
    const std::string part = bytes.substr(0, bytes.size() - cut);
    const std::string text = data_url(part);
    EXPECT_EQ(bytes_of_source(text), part);
    EXPECT_EQ(size_of_source(text), part.size());
    EXPECT_EQ(text.find('\0'), std::string::npos);
  }
  EXPECT_EQ(bytes_of_source("solid a"), "solid a");
  EXPECT_EQ(data_url("Man"), "data:application/octet-stream;base64,TWFu");
  EXPECT_EQ(data_url("Ma"), "data:application/octet-stream;base64,TWE=");
}

TEST(MeshScenario, TheSourcesOfAScenarioReadAgainAreTheSameScenario) {
  MemoryFiles files = with_head("<Geom type=\"trimesh\"><data>box.off 0.1</data></Geom>");
  const Scenario scenario = files.scenario();
  SourceTexts again;
  for (const SourceFile& source : scenario.sources) {
    again.add(source.path, source.text);
  }
  const Scenario second = read_scenario("top.xml", again);
  EXPECT_EQ(head_solid(second).mesh->vertices, head_solid(scenario).mesh->vertices);
}

TEST(MeshScenario, ALargeFileOfBytesIsReadAgainThoughItsTextIsLonger) {
  MemoryFiles files = with_head("<Geom type=\"trimesh\"><data>box.off 0.1</data></Geom>");
  files.texts["box.off"] += std::string(std::size_t{13} << 20U, '\0');
  SourceTexts again;
  for (const SourceFile& source : files.scenario().sources) {
    again.add(source.path, source.text);
  }
  EXPECT_EQ(head_solid(read_scenario("top.xml", again)).mesh->vertices.size(), 8U);
}

}  // namespace
}  // namespace proleg::sim
