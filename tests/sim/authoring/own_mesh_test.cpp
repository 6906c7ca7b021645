#include "sim/authoring/own_mesh.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "mesh_shapes.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/robot/bounds.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

constexpr double single = 1e-6;  // coordinates come in single precision

OwnMesh mesh_of(const std::string& name, const std::string& text) { return read_own_mesh({{name, text}}); }

/// A square of 2 x 2 that faces up, or down.
std::string sheet_off(bool faces_up) {
  return std::string("OFF\n4 2 0\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n") +
         (faces_up ? "3 0 1 2\n3 0 2 3\n" : "3 0 2 1\n3 0 3 2\n");
}

template <typename Change>
std::string refusal_in(Draft& draft, const Change& change) {
  const std::string before = text_of(draft, "environment.xml");
  const std::size_t files = draft.changed_files().size();
  std::string message = message_of<InputError>([&] { change_world(draft, change); });
  EXPECT_EQ(text_of(draft, "environment.xml"), before);
  EXPECT_EQ(draft.changed_files().size(), files);
  return message;
}

TEST(OwnMesh, SaysWhatItIsInItsOwnUnit) {
  const OwnMesh own = mesh_of("box.off", box_off);
  EXPECT_TRUE(own.facts.lowest.isApprox(Eigen::Vector3d(-0.1, -0.2, -0.3), single));
  EXPECT_TRUE(own.facts.highest.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3), single));
  EXPECT_NEAR(own.facts.hull_volume.value(), 0.048, single);
  EXPECT_FALSE(own.facts.gap);
  EXPECT_FALSE(own.facts.flaw);
  EXPECT_LT(own.facts.facing.norm(), 1e-12) << "a closed surface faces all sides alike";
  const OwnMesh sheet = mesh_of("sheet.off", sheet_off(true));
  EXPECT_TRUE(sheet.facts.gap);
  EXPECT_FALSE(sheet.facts.hull_volume) << "it is flat";
  EXPECT_TRUE(sheet.facts.facing.isApprox(Eigen::Vector3d(0, 0, 4)));
}

TEST(OwnMesh, ATriangleWithoutAreaIsAFlaw) {
  EXPECT_TRUE(mesh_of("a.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 0\n3 0 1 2\n3 0 1 3\n3 1 3 2\n").facts.flaw);
}

TEST(OwnMesh, WhatIsNoMeshIsRefusedWithOneLine) {
  const std::vector<std::pair<std::string, std::string>> bad{{"a.off", ""},
                                                             {"a.off", "OFF\n"},
                                                             {"a.stl", "solid"},
                                                             {"a.obj", "v 1 2 3\n"},
                                                             {"a.txt", box_off},
                                                             {"../a.off", box_off},
                                                             {".a.off", box_off},
                                                             {"a\xFF.off", box_off},
                                                             {"a\n.off", box_off},
                                                             {std::string(80, 'a') + ".off", box_off},
                                                             {"a.off", "OFF\n3 1 0\n1 1 1\n1 1 1\n1 1 1\n3 0 1 2\n"}};
  for (const auto& file : bad) {
    const std::string message = message_of<InputError>([&] { static_cast<void>(mesh_of(file.first, file.second)); });
    EXPECT_NE(message, "") << file.first;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

// The rotation of a fit, by the angles of a textbook.
TEST(MeshFit, TurnsAboutXThenYThenZ) {
  const auto about = [](unsigned quarters, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(quarters * std::numbers::pi / 2.0, axis).toRotationMatrix();
  };
  for (unsigned x = 0; x < 4; ++x) {
    for (unsigned y = 0; y < 4; ++y) {
      for (unsigned z = 0; z < 4; ++z) {
        const MeshFit fit{1.0, {x, y, z}, {0, 0, 0}};
        const Eigen::Matrix3d expected = about(z, Eigen::Vector3d::UnitZ()) * about(y, Eigen::Vector3d::UnitY()) *
                                         about(x, Eigen::Vector3d::UnitX());
        EXPECT_TRUE(fit.rotation().toRotationMatrix().isApprox(expected, 1e-9)) << x << y << z;
      }
    }
  }
}

class OwnMeshInWorld : public testing::Test {
 protected:
  MemoryFiles files_ = world_files();
  Draft draft_{files_.scenario(), files_};

  void add(const OwnMesh& own, const MeshFit& fit, bool is_sheet = false, double turn = 0.0) {
    change_world(draft_, [&](WorldChange& world) { world.add_mesh(own, fit, is_sheet, {1, 2, 0}, turn); });
  }
  [[nodiscard]] const StaticObject& added() const { return draft_.scenario().environment.objects.at(4); }
  [[nodiscard]] Bounds bounds() const { return bounds_of(added().geometries.at(0), added().pose); }
};

TEST_F(OwnMeshInWorld, StandsOnTheGroundBehindItsFrontEdge) {
  OwnMesh own = mesh_of("my box.off", box_off);
  add(own, {0.5, {1, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(read_world_contents(draft_).objects.at(4).name, "my box");
  // Turned about x the sides are 0.2, 0.6 and 0.4 units.
  EXPECT_TRUE(bounds().lowest.isApprox(Eigen::Vector3d(0.95, 2.0, 0.0), 1e-6)) << bounds().lowest.transpose();
  EXPECT_TRUE(bounds().highest.isApprox(Eigen::Vector3d(1.05, 2.3, 0.2), 1e-6)) << bounds().highest.transpose();
  EXPECT_EQ(draft_.text("meshes/my box.off"), box_off);
  EXPECT_EQ(added().geometries.at(0).mesh->colours.at(0), Eigen::Vector3f(1, 0, 0));
  Simulation simulation(draft_.scenario());
  simulation.advance();
  EXPECT_EQ(simulation.tick(), 1U);
}

TEST_F(OwnMeshInWorld, TurnedItLiesAcrossTheSameWay) {
  add(mesh_of("box.off", box_off), {1.0, {}, {0, 0, 0}}, false, 90.0);
  EXPECT_TRUE(bounds().lowest.isApprox(Eigen::Vector3d(0.6, 1.9, 0.0), 1e-6)) << bounds().lowest.transpose();
  EXPECT_TRUE(bounds().highest.isApprox(Eigen::Vector3d(1.0, 2.1, 0.6), 1e-6)) << bounds().highest.transpose();
}

TEST_F(OwnMeshInWorld, ItsSizeChangesAboutItsFoot) {
  add(mesh_of("box.off", box_off), {0.5, {0, 0, 1}, {1, 0, 0}});
  const WorldShape shape = read_world_contents(draft_).objects.at(4).shapes.at(0);
  ASSERT_EQ(shape.size.size(), 3U);
  EXPECT_NEAR(shape.size[1], 0.2, single) << "along the axes of the file";
  const Bounds before = bounds();
  change_world(draft_, [&](WorldChange& world) {
    world.set_size(4, 0, {2.0 * shape.size[0], 2.0 * shape.size[1], 2.0 * shape.size[2]});
  });
  EXPECT_NEAR(bounds().lowest.z(), 0.0, 1e-6);
  EXPECT_TRUE((bounds().highest - bounds().lowest).isApprox(2.0 * (before.highest - before.lowest), 1e-6));
  EXPECT_NEAR((bounds().lowest + bounds().highest).x(), (before.lowest + before.highest).x(), 1e-5);
  EXPECT_NE(text_of(draft_, "environment.xml").find("<data>meshes/box.off 1</data>"), std::string::npos)
      << text_of(draft_, "environment.xml");
  change_world(draft_, [&](WorldChange& world) { world.set_size(4, 0, {0.2, 0.4, 0.3}); });
  EXPECT_NE(text_of(draft_, "environment.xml").find("<data>meshes/box.off 1 1 0.5</data>"), std::string::npos);
  EXPECT_NE(refusal_in(draft_, [](WorldChange& world) { world.set_size(4, 0, {0.2, 0.0, 0.3}); }), "");
  EXPECT_NE(refusal_in(draft_, [](WorldChange& world) { world.set_size(4, 0, {9e3, 0.1, 0.3}); }), "");
}

TEST_F(OwnMeshInWorld, IsChangedAsOtherObjectsAre) {
  add(mesh_of("box.off", box_off), {});
  change_world(draft_, [](WorldChange& world) { world.set_colour(4, {0, 1, 0}); });
  EXPECT_EQ(added().geometries.at(0).mesh->colours.at(0), Eigen::Vector3f(0, 1, 0));
  change_world(draft_, [](WorldChange& world) { world.set_friction(4, 0.9); });
  change_world(draft_, [](WorldChange& world) { world.duplicate({4}, true, {0.5, 0, 0}, 2); });
  EXPECT_EQ(read_world_contents(draft_).objects.size(), 8U);
  change_world(draft_, [](WorldChange& world) { world.set_moves(4, true); });
  EXPECT_EQ(draft_.scenario().environment.moving_objects.size(), 2U);
  EXPECT_NEAR(read_world_contents(draft_).objects.at(4).mass, 0.048 * 500.0, 24.0 * single);
}

TEST_F(OwnMeshInWorld, ASheetIsAddedOnlyAsOneAndFacingUp) {
  const OwnMesh up = mesh_of("up.off", sheet_off(true));
  const OwnMesh down = mesh_of("down.off", sheet_off(false));
  const auto refusal = [&](const OwnMesh& own, const MeshFit& fit, bool is_sheet) {
    return refusal_in(draft_, [&](WorldChange& world) { world.add_mesh(own, fit, is_sheet, {0, 0, 0}, 0.0); });
  };
  EXPECT_NE(refusal(up, {}, false).find("holes"), std::string::npos);
  EXPECT_NE(refusal(down, {}, true).find("face down"), std::string::npos);
  EXPECT_NE(refusal(up, {1.0, {2, 0, 0}, {0, 0, 0}}, true).find("face down"), std::string::npos);
  add(down, {0.5, {2, 0, 0}, {0, 0, 0}}, true);
  EXPECT_TRUE(draft_.scenario().warnings.empty());
  EXPECT_NEAR(bounds().highest.x() - bounds().lowest.x(), 1.0, 1e-9);
}

TEST_F(OwnMeshInWorld, ValuesOutOfRangeAreRefused) {
  const OwnMesh own = mesh_of("box.off", box_off);
  const auto refusal = [&](const MeshFit& fit) {
    return refusal_in(draft_, [&](WorldChange& world) { world.add_mesh(own, fit, false, {0, 0, 0}, 0.0); });
  };
  for (const double factor : {0.0, -1.0, 1e9, 1e-9, std::nan(""), 1e4, 1e-3 / 0.7}) {
    EXPECT_NE(refusal({factor, {}, {0, 0, 0}}), "") << factor;
  }
  EXPECT_NE(refusal({1.0, {4, 0, 0}, {0, 0, 0}}), "");
  EXPECT_NE(refusal({1.0, {}, {0, 2, 0}}), "");
}

TEST_F(OwnMeshInWorld, UndoTakesItsFilesWithIt) {
  const std::vector<Draft::ChangedFile> none = draft_.changed_files();
  add(mesh_of("box.off", box_off), {});
  EXPECT_EQ(draft_.changed_files().size(), 2U);
  EXPECT_TRUE(draft_.undo());
  EXPECT_EQ(draft_.changed_files().size(), none.size());
  EXPECT_FALSE(draft_.has("meshes/box.off"));
  EXPECT_TRUE(draft_.redo());
  EXPECT_EQ(draft_.text("meshes/box.off"), box_off);
  change_world(draft_, [](WorldChange& world) { world.remove({4}, true); });
  EXPECT_FALSE(draft_.has("meshes/box.off")) << "Save writes no file that nothing names";
  EXPECT_TRUE(draft_.undo());
  EXPECT_EQ(draft_.text("meshes/box.off"), box_off);
}

TEST_F(OwnMeshInWorld, AnotherMeshOfTheSameNameComesIntoAnotherFolder) {
  add(mesh_of("box.off", box_off), {});
  add(mesh_of("box.off", box_off), {});
  add(mesh_of("box.off", std::string(box_off) + "# another\n"), {});
  EXPECT_TRUE(draft_.has("meshes/box.off"));
  EXPECT_TRUE(draft_.has("meshes_2/box.off"));
  EXPECT_EQ(draft_.changed_files().size(), 3U);
  EXPECT_EQ(read_world_contents(draft_).objects.at(5).name, "box 2");
}

TEST_F(OwnMeshInWorld, ABinaryFileIsTheSameBytesAfterwards) {
  const std::string bytes = [] {
    std::string stl(80, '\0');
    const TriangleMesh box = box_mesh({0.1, 0.2, 0.3});
    const auto append = [&stl](const auto& value) { stl.append(reinterpret_cast<const char*>(&value), sizeof value); };
    append(static_cast<std::uint32_t>(box.triangles.size()));
    for (const auto& triangle : box.triangles) {
      stl.append(12, '\0');
      for (const std::uint32_t corner : triangle) {
        for (const double coordinate : box.vertices[corner]) {
          append(static_cast<float>(coordinate));
        }
      }
      stl.append(2, '\0');
    }
    return stl;
  }();
  add(mesh_of("box.STL", bytes), {});
  EXPECT_EQ(bytes_of_source(draft_.text("meshes/box.STL")), bytes);
  EXPECT_EQ(added().geometries.at(0).mesh->triangles.size(), 12U);
}

// A drag reads the scenario at each step: the mesh is imported once.
TEST_F(OwnMeshInWorld, AMeshStaysTheSameFromOneReadToTheNext) {
  add(mesh_of("box.off", box_off), {});
  change_world(draft_, [](WorldChange& world) { world.set_moves(4, true); });
  const auto before = draft_.scenario().environment.moving_objects.at(1).geometries.at(0).mesh;
  change_world(draft_, [](WorldChange& world) { world.set_friction(4, 0.4); });
  EXPECT_EQ(draft_.scenario().environment.moving_objects.at(1).geometries.at(0).mesh, before);
}

}  // namespace
}  // namespace proleg::sim
