#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <string>

#include "sim/mesh/mesh_checks.hpp"
#include "sim/mesh/mesh_file.hpp"
#include "sim/mesh/mesh_geometry.hpp"
#include "tests/sim/mesh/mesh_shapes.hpp"

namespace proleg::sim {
namespace {

constexpr const char* box_obj = R"(mtllib box.mtl
v -0.1 -0.2 -0.3
v -0.1 -0.2 0.3
v -0.1 0.2 -0.3
v -0.1 0.2 0.3
v 0.1 -0.2 -0.3
v 0.1 -0.2 0.3
v 0.1 0.2 -0.3
v 0.1 0.2 0.3
usemtl red
f 1 2 4 3
f 5 7 8 6
f 1 5 6 2
f 3 4 8 7
usemtl blue
f 1 3 7 5
f 2 6 8 4
)";

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  const auto append = [&bytes](const auto& value) {
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    bytes += raw;
  };
  append(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      append(0.0F);  // the normal
    }
    for (const std::uint32_t corner : triangle) {
      for (const double coordinate : mesh.vertices[corner]) {
        append(static_cast<float>(coordinate));
      }
    }
    append(std::uint16_t{0});
  }
  return bytes;
}

std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid box\n";
  for (const auto& triangle : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t corner : triangle) {
      const Eigen::Vector3d& vertex = mesh.vertices[corner];
      text += "vertex " + std::to_string(vertex.x()) + ' ' + std::to_string(vertex.y()) + ' ' +
              std::to_string(vertex.z()) + '\n';
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

std::string collada(const std::string& unit, const std::string& up) {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter=")" +
         unit + R"("/><up_axis>)" + up + R"(</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse><color>0.2 0.4 0.8 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 3 0 0 0 2 0 0 0 1</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4" material="mm"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="mm" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

TriangleMesh read(const std::string& name, const std::string& bytes,
                  const std::map<std::string, std::string>& beside = {}) {
  return read_mesh_file(name, bytes, [&](const std::string& file) -> std::optional<std::string> {
    const auto found = beside.find(file.substr(file.find_last_of('/') + 1));
    return found == beside.end() ? std::nullopt : std::optional(found->second);
  });
}

std::string refusal(const std::string& name, const std::string& bytes) {
  try {
    static_cast<void>(read(name, bytes));
  } catch (const MeshError& error) {
    EXPECT_EQ(error.found.find('\n'), std::string::npos);
    return error.found;
  }
  return "nothing";
}

void expect_box(const TriangleMesh& mesh) {
  require_closed(mesh);
  EXPECT_NEAR(solid_of(mesh).volume, 0.048, 1e-7);
}

TEST(MeshFile, ReadsABoxFromEachFormat) {
  expect_box(read("box.off", box_off));
  expect_box(read("BOX.OBJ", box_obj));
  const TriangleMesh box = box_mesh({0.1, 0.2, 0.3});
  expect_box(read("box.stl", ascii_stl(box)));
  expect_box(read("box.stl", binary_stl(box)));
}

TEST(MeshFile, ColladaKeepsItsAxesAndItsUnitBecomesMetres) {
  for (const std::string up : {"Z_UP", "Y_UP"}) {
    const TriangleMesh mesh = read("t.dae", collada("0.01", up));
    EXPECT_NEAR(solid_of(mesh).volume, 1e-6, 1e-12) << up;
    EXPECT_TRUE(solid_of(mesh).center.isApprox(Eigen::Vector3d(0.0075, 0.005, 0.0025), 1e-5)) << up;
    ASSERT_EQ(mesh.colours.size(), mesh.vertices.size());
    EXPECT_TRUE(mesh.colours[0].isApprox(Eigen::Vector3f(0.2F, 0.4F, 0.8F), 0.01F));
  }
}

TEST(MeshFile, ColoursOfMaterialsAreKept) {
  const TriangleMesh mesh = read("box.obj", box_obj, {{"box.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n"}});
  ASSERT_EQ(mesh.colours.size(), mesh.vertices.size());
  std::size_t red = 0;
  std::size_t blue = 0;
  for (const auto& triangle : mesh.triangles) {
    red += mesh.colours[triangle[0]] == Eigen::Vector3f(1, 0, 0) ? 1U : 0U;
    blue += mesh.colours[triangle[0]] == Eigen::Vector3f(0, 0, 1) ? 1U : 0U;
  }
  EXPECT_EQ(red, 8U);
  EXPECT_EQ(blue, 4U);
}

TEST(MeshFile, AByteOrderMarkIsNoPartOfAFile) {
  const std::string mark = "\xEF\xBB\xBF";
  expect_box(read("box.off", mark + box_off));
  expect_box(read("box.stl", mark + ascii_stl(box_mesh({0.1, 0.2, 0.3}))));
  const std::string without_head = std::string(box_obj).substr(std::string(box_obj).find("v "));
  expect_box(read("box.obj", mark + without_head));
  expect_box(read("box.obj", mark + "v 9 9 9\n" + without_head.substr(0, without_head.find('f')) +
                                 "f 2 3 5 4\nf 6 8 9 7\nf 2 6 7 3\nf 4 5 9 8\nf 2 4 8 6\nf 3 7 9 5\n"));
  EXPECT_NEAR(solid_of(read("t.dae", mark + collada("0.01", "Z_UP"))).volume, 1e-6, 1e-12);
  const TriangleMesh mesh =
      read("box.obj", mark + box_obj, {{"box.mtl", mark + "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 1 0 0\n"}});
  ASSERT_EQ(mesh.colours.size(), mesh.vertices.size());
  for (const Eigen::Vector3f& colour : mesh.colours) {
    EXPECT_EQ(colour, Eigen::Vector3f(1, 0, 0));
  }
}

TEST(MeshFile, MaterialsInUtf16AreRefusedByTheirName) {
  try {
    static_cast<void>(read("box.obj", box_obj, {{"box.mtl", std::string("\xFF\xFEn\0e\0w\0", 8)}}));
    ADD_FAILURE() << "no error";
  } catch (const MeshError& error) {
    EXPECT_EQ(error.found, "text in UTF-16, 'box.mtl'");
  }
}

TEST(MeshFile, StlFilesOfOtherProgramsAreRead) {
  const TriangleMesh box = box_mesh({0.1, 0.2, 0.3});
  std::string capitals = ascii_stl(box);
  std::ranges::transform(capitals, capitals.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 32) : c; });
  expect_box(read("box.stl", capitals));
  expect_box(read("box.stl", "solid 4\nendsolid\n" + ascii_stl(box)));
  expect_box(read("box.stl", "\n" + ascii_stl(box) + "solid 4\nendsolid\n"));
  expect_box(read("box.stl", binary_stl(box) + "\r\n\r\n"));
}

TEST(MeshFile, AMeshThatANodeOfAColladaFileNamesTwiceIsOne) {
  std::string text = collada("0.01", "Z_UP");
  const std::size_t begin = text.find("<instance_geometry");
  const std::string end = "</instance_geometry>";
  text.insert(begin, text.substr(begin, text.find(end) + end.size() - begin));
  EXPECT_NEAR(solid_of(read("t.dae", text)).volume, 1e-6, 1e-12);
}

TEST(MeshFile, CamerasAndLightsOfAColladaFileAreNoPartOfItsMesh) {
  // Blender writes the same camera and light for each of its scenes.
  std::string stage;
  std::string nodes;
  for (const char* name : {"one", "two"}) {
    stage += std::string(R"(<library_cameras><camera id="c" name=")") + name +
             R"("><optics><technique_common><perspective><xfov>40</xfov><znear>0.1</znear><zfar>9</zfar></perspective>)"
             R"(</technique_common></optics></camera></library_cameras><library_lights><light id="l" name=")" +
             name +
             R"("><technique_common><point><color>1 1 1</color></point></technique_common></light></library_lights>)";
    nodes +=
        R"(<node id="C" name="C"><instance_camera url="#c"/></node><node id="L" name="L"><instance_light url="#l"/>)"
        "</node>";
  }
  std::string text = collada("0.01", "Z_UP");
  text.insert(text.find("<library_geometries>"), stage);
  text.insert(text.find("</visual_scene>"), nodes);
  EXPECT_NEAR(solid_of(read("t.dae", text)).volume, 1e-6, 1e-12);
}

TEST(MeshFile, APointerOfGitLfsIsNamed) {
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:12\nsize 5\n";
  for (const char* name : {"a.stl", "a.dae", "a.obj", "a.off"}) {
    EXPECT_EQ(refusal(name, pointer), std::string("a pointer of Git LFS instead of the mesh, '") + name + "'");
  }
}

TEST(MeshFile, AMeshOfAColladaFileWithSeveralMaterialsIsWhole) {
  const auto replace = [](std::string text, const std::string& before, const std::string& after) {
    EXPECT_NE(text.find(before), std::string::npos) << before;
    return text.replace(text.find(before), before.size(), after);
  };
  std::string text = replace(collada("0.01", "Z_UP"), "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>",
                             "<p>0 2 1 0 1 3</p></triangles><triangles count=\"2\" material=\"nn\"><input "
                             "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 3 2 1 2 3</p></triangles>");
  text = replace(text, "<triangles count=\"4\"", "<triangles count=\"2\"");
  text = replace(text, "<library_materials>",
                 "<library_materials><material id=\"n\" name=\"n\"><instance_effect url=\"#e\"/></material>");
  const std::string two = replace(text, "<instance_material symbol=\"mm\" target=\"#m\"/>",
                                  "<instance_material symbol=\"mm\" target=\"#m\"/>"
                                  "<instance_material symbol=\"nn\" target=\"#n\"/>");
  EXPECT_NEAR(solid_of(read("t.dae", two)).volume, 1e-6, 1e-12);
  // Two instances that differ in their materials only.
  const std::size_t begin = two.find("<instance_geometry");
  const std::string end = "</instance_geometry>";
  std::string instance = two.substr(begin, two.find(end) + end.size() - begin);
  instance = replace(instance, "target=\"#m\"", "target=\"#n\"");
  std::string twice = two;
  twice.insert(begin, instance);
  EXPECT_NEAR(solid_of(read("t.dae", twice)).volume, 1e-6, 1e-12);
}

TEST(MeshFile, ANegativeVertexOfAnOffFileIsRefused) {
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n0 0 -1\n";
  for (const std::string start : {"OFF\n4 2 0\n", "OFF 4 2 0\n", "# a comment\nOFF\n\n4 2 0 # counts\n"}) {
    EXPECT_EQ(refusal("a.off", start + corners + "3 0 1 2\n3 0 1 -3\n"), "a face with the vertex '-3' in 'a.off'");
    EXPECT_EQ(refusal("a.off", start + corners + "x 0 1 2\n3 0 1 3\n"), "a face with 'x' corners in 'a.off'");
  }
}

TEST(MeshFile, AUnitOfAColladaFileIsANumberAboveZero) {
  for (const char* unit : {"abc", "-1", "0", "", "1 2", "inf"}) {
    EXPECT_NE(refusal("a.dae", collada(unit, "Z_UP")).find("a <unit> of "), std::string::npos) << unit;
  }
}

TEST(MeshFile, AFileWithoutColoursHasNone) { EXPECT_TRUE(read("box.off", box_off).colours.empty()); }

TEST(MeshFile, DamagedFilesAreRefusedInOneLine) {
  const std::string stl = binary_stl(box_mesh({0.1, 0.2, 0.3}));
  EXPECT_NE(refusal("a.stl", stl.substr(0, stl.size() / 2)), "nothing");
  EXPECT_NE(refusal("a.stl", ""), "nothing");
  EXPECT_NE(refusal("a.obj", "v 0 0 0\n"), "nothing");
  EXPECT_NE(refusal("a.dae", collada("1", "Z_UP").substr(0, 900)), "nothing");
  EXPECT_NE(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"), "nothing");
  // Assimp takes another vertex for one that is not there, and its assertions do not end the program.
  EXPECT_NE(
      refusal("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 7\n3 0 1 2\n").find("index is out of range"),
      std::string::npos);
  static_cast<void>(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n"));
}

TEST(MeshFile, NumbersThatAreNotFiniteAreRefused) {
  std::string text = box_obj;
  text.replace(text.find("-0.1 -0.2 -0.3"), 4, "nan ");
  EXPECT_NE(refusal("a.obj", text), "nothing");
}

TEST(MeshFile, OtherEndingsAreRefused) {
  EXPECT_EQ(refusal("a.blend", "BLENDER"), "a mesh file of another kind, 'a.blend'");
}

TEST(MeshFile, TooManyTrianglesAreRefused) {
  TriangleMesh mesh = box_mesh({0.1, 0.2, 0.3});
  const std::size_t sides = mesh.triangles.size();
  while (mesh.triangles.size() <= max_triangles) {
    mesh.triangles.push_back(mesh.triangles[mesh.triangles.size() - sides]);
  }
  EXPECT_EQ(refusal("a.stl", binary_stl(mesh)), "more than 100000 triangles in 'a.stl'");
}

/// A COLLADA file with other nodes beside those of its scene.
std::string collada_with_nodes(const std::string& nodes, const std::string& scene) {
  std::string text = collada("1", "Z_UP");
  text.insert(text.find("<library_visual_scenes>"), "<library_nodes>" + nodes + "</library_nodes>");
  const std::string node = R"(<node id="n">)";
  return text.insert(text.find(node) + node.size(), scene);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

constexpr const char* ends_assimp = "a file at which the mesh library ends with signal 11, 'a.dae'";

TEST(MeshFile, AFileThatEndsAssimpIsRefused) {
  const std::string cycle = R"(<node id="a0"><instance_node url="#a0"/></node>)";
  EXPECT_EQ(refusal("a.dae", collada_with_nodes(cycle, R"(<instance_node url="#a0"/>)")), ends_assimp);
  EXPECT_EQ(refusal("a.dae", replaced(collada("1", "Z_UP"), R"(stride="3")", R"(stride="3000000000")")), ends_assimp);
  std::string open;
  std::string close;
  for (int level = 0; level < 60'000; ++level) {
    open += "<node>";
    close += "</node>";
  }
  EXPECT_EQ(refusal("a.dae", collada_with_nodes("", open + close)), ends_assimp);
}

TEST(MeshFile, AFileThatNeedsTooMuchMemoryIsRefused) {
  const std::string too_much = "a file that needs more than 2 GiB of memory, ";
  EXPECT_EQ(refusal("a.off", "OFF\n400000000 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), too_much + "'a.off'");
  EXPECT_EQ(refusal("a.off", "OFF\n3 400000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), too_much + "'a.off'");
  std::string nodes;
  for (int level = 0; level < 30; ++level) {
    const std::string next = R"(<instance_node url="#a)" + std::to_string(level + 1) + R"("/>)";
    nodes += R"(<node id="a)" + std::to_string(level) + R"(">)" + next + next + "</node>";
  }
  nodes += R"(<node id="a30"/>)";
  EXPECT_EQ(refusal("a.dae", collada_with_nodes(nodes, R"(<instance_node url="#a0"/>)")), too_much + "'a.dae'");
  // AddressSanitizer reserves the memory of these numbers, which are not there.
  EXPECT_NE(refusal("a.dae", replaced(collada("1", "Z_UP"), R"(count="12")", R"(count="2000000000")")), "nothing");
}

}  // namespace
}  // namespace proleg::sim
