#include "tools/proleg/ui/mesh_session.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>

#include "mesh_shapes.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/sources.hpp"
#include "viewers.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

std::string base64(std::string_view bytes) {
  const std::string url = sim::data_url(bytes);
  return url.substr(url.find(',') + 1);
}

/// A binary STL file with so many triangles, all of them the same.
std::string stl_of(std::uint32_t triangles) {
  std::string bytes(80, '\0');
  bytes.resize(84 + std::size_t{50} * triangles);
  std::memcpy(bytes.data() + 80, &triangles, sizeof triangles);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const std::array<float, 9> corners{0, 0, 0, 1, 0, 0, 0, 1, static_cast<float>(i)};
    std::memcpy(bytes.data() + 84 + std::size_t{50} * i + 12, corners.data(), sizeof corners);
  }
  return bytes;
}

class MeshSessionTest : public ::testing::Test {
 protected:
  explicit MeshSessionTest(MeshSessionOptions options = {}) { session_.emplace(meshes_, requests_, viewers_, options); }

  Viewers::Answer ask(const std::string& name, const json& arguments) {
    requests_.operate({++request_, name, arguments, 1, "a test"});
    return viewers_.answer(request_);
  }
  json must(const std::string& name, const json& arguments) {
    const Viewers::Answer answer = ask(name, arguments);
    EXPECT_TRUE(answer.is_done) << name << ": " << answer.text;
    return answer.is_done ? json::parse(answer.text) : json();
  }
  static json declared(const std::vector<sim::NamedBytes>& files) {
    json list = json::array();
    for (const sim::NamedBytes& file : files) {
      list.push_back({{"name", file.name}, {"bytes", file.bytes.size()}});
    }
    return {{"files", list}};
  }
  /// Sends a mesh in parts. Returns its number.
  std::uint64_t send(const std::vector<sim::NamedBytes>& files, std::size_t part = 40'000) {
    const json mesh = must("mesh.begin", declared(files))["mesh"];
    for (std::size_t i = 0; i < files.size(); ++i) {
      for (std::size_t at = 0; at < files[i].bytes.size(); at += part) {
        must("mesh.part", {{"mesh", mesh}, {"file", i}, {"at", at}, {"data", base64(files[i].bytes.substr(at, part))}});
      }
    }
    return mesh;
  }
  std::string refusal(const std::string& name, const json& arguments) {
    const Viewers::Answer answer = ask(name, arguments);
    EXPECT_FALSE(answer.is_done) << name << ' ' << arguments << ' ' << answer.text;
    EXPECT_EQ(answer.text.find('\n'), std::string::npos);
    return answer.text;
  }

  SentMeshes meshes_;
  SessionRequests requests_;
  Viewers viewers_;
  std::optional<MeshSession> session_;
  std::uint64_t request_ = 0;
};

TEST_F(MeshSessionTest, AMeshThatCameInPartsIsReadAndDescribed) {
  const std::uint64_t mesh = send({{"my body.off", sim::box_off}}, 7);
  const json facts = must("mesh.look", {{"mesh", mesh}});
  EXPECT_EQ(facts["name"], "my body.off");
  EXPECT_EQ(facts["triangles"], 12);
  EXPECT_NEAR(facts["lowest"][0].get<double>(), -0.1, 1e-7);
  EXPECT_NEAR(facts["highest"][2].get<double>(), 0.3, 1e-7);
  EXPECT_NEAR(facts["hull_volume"].get<double>(), 0.2 * 0.4 * 0.6, 1e-7);
  EXPECT_EQ(facts["gap"], json());
  EXPECT_EQ(facts["flaw"], json());
  EXPECT_EQ(facts["has_colours"], false);
  EXPECT_EQ(meshes_.at(mesh)->files.front().bytes, sim::box_off);
}

TEST_F(MeshSessionTest, ItsShapeIsVerticesAndTriangles) {
  const std::uint64_t mesh = send({{"box.off", sim::box_off}});
  const json bytes = must("mesh.shape", {{"mesh", mesh}})["bytes"];
  ASSERT_EQ(bytes.size(), 4U * (2U + 3U * 8U + 3U * 12U));
  EXPECT_EQ(bytes[0], 8);
  EXPECT_EQ(bytes[4], 12);
}

TEST_F(MeshSessionTest, OfTheFilesBesideAMeshThoseStayThatItNames) {
  const std::string obj =
      "mtllib red.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const std::uint64_t mesh =
      send({{"other.mtl", "newmtl blue\nKd 0 0 1\n"}, {"a.obj", obj}, {"red.mtl", "newmtl red\nKd 1 0 0\n"}});
  const json facts = must("mesh.look", {{"mesh", mesh}});
  EXPECT_EQ(facts["files"], json({"a.obj", "red.mtl"}));
  EXPECT_EQ(facts["has_colours"], true);
}

TEST_F(MeshSessionTest, WhatCannotBeAMeshIsRefusedBeforeItIsSent) {
  const auto begin = [this](const std::string& name, const json& bytes) {
    return refusal("mesh.begin", {{"files", json::array({{{"name", name}, {"bytes", bytes}}})}});
  };
  EXPECT_EQ(
      begin("big.stl", 100'000'084),
      "file: found 'big.stl' of 96 MiB, expected at most 16 MiB and 100000 triangles; a modeller can reduce them");
  EXPECT_EQ(begin("empty.stl", 0), "file: found 'empty.stl', which is empty, expected a mesh");
  for (const char* const name : {"", "../a.stl", "a/b.stl", ".stl", "a\\b.stl", " a.stl", "a\nb.stl",
                                 "a\xEF\xBF\xBD.stl", "a.step", "a", "a.mtl"}) {
    EXPECT_NE(begin(name, 100), "") << name;
  }
  for (const json& bytes : std::vector<json>{-1, 1e99, "5", json(), 1.5}) {
    EXPECT_NE(begin("a.stl", bytes), "");
  }
  const json mesh{{"name", "a.stl"}, {"bytes", 100}};
  EXPECT_EQ(refusal("mesh.begin", {{"files", {mesh, {{"name", "b.stl"}, {"bytes", 5}}}}}),
            "file: found 'a.stl' and 'b.stl', expected one mesh at a time");
  for (const json& files :
       std::vector<json>{json(), 5, json::array(), json::array({5}), json(9, mesh), {mesh, mesh}, "a.stl"}) {
    EXPECT_NE(refusal("mesh.begin", {{"files", files}}), "");
  }
}

TEST_F(MeshSessionTest, APartThatDoesNotFitIsRefusedAndTheTransferGoesOn) {
  const json mesh = must("mesh.begin", declared({{"box.off", sim::box_off}}))["mesh"];
  const std::string all = base64(sim::box_off);
  for (const json& words : std::vector<json>{{{"file", 1}, {"at", 0}, {"data", all}},
                                             {{"file", 0}, {"at", 1}, {"data", all}},
                                             {{"file", 0}, {"at", 0}, {"data", "!!!!"}},
                                             {{"file", 0}, {"at", 0}, {"data", "AAA"}},
                                             {{"file", 0}, {"at", 0}, {"data", ""}},
                                             {{"file", 0}, {"at", 0}, {"data", 5}},
                                             {{"file", 0}, {"at", 0}, {"data", base64(std::string(500, 'x'))}},
                                             {{"file", -1}, {"at", 0}, {"data", all}},
                                             json::object()}) {
    json arguments = words;
    arguments["mesh"] = mesh;
    EXPECT_NE(refusal("mesh.part", arguments), "") << words;
  }
  EXPECT_NE(refusal("mesh.part", {{"mesh", 77}, {"file", 0}, {"at", 0}, {"data", all}}), "");
  EXPECT_NE(refusal("mesh.look", {{"mesh", mesh}}), "") << "it has not come yet";
  must("mesh.part", {{"mesh", mesh}, {"file", 0}, {"at", 0}, {"data", all}});
  EXPECT_NE(refusal("mesh.part", {{"mesh", mesh}, {"file", 0}, {"at", all.size()}, {"data", all}}), "");
  must("mesh.look", {{"mesh", mesh}});
}

TEST_F(MeshSessionTest, ADamagedFileIsOneLineAndIsForgotten) {
  const std::string good = stl_of(20);
  for (const std::string& bytes :
       {good.substr(0, good.size() - 10), std::string("solid nothing"), std::string(5000, '\xFF'), stl_of(100'001)}) {
    const std::uint64_t mesh = send({{"bad.stl", bytes}});
    const std::string line = refusal("mesh.look", {{"mesh", mesh}});
    EXPECT_TRUE(line.starts_with("bad.stl")) << line;
    EXPECT_NE(refusal("mesh.look", {{"mesh", mesh}}), line) << "it is not there any more";
    EXPECT_THROW(static_cast<void>(meshes_.at(mesh)), InputError);
  }
}

TEST_F(MeshSessionTest, OfManyMeshesTheNewestStay) {
  std::vector<std::uint64_t> sent;
  for (int i = 0; i < 5; ++i) {
    sent.push_back(send({{"box.off", sim::box_off}}));
    must("mesh.look", {{"mesh", sent.back()}});
  }
  EXPECT_NE(refusal("mesh.look", {{"mesh", sent[2]}}), "");
  EXPECT_THROW(static_cast<void>(meshes_.at(sent[2])), InputError);
  must("mesh.look", {{"mesh", sent[3]}});
  must("mesh.drop", {{"mesh", sent[3]}});
  EXPECT_NE(refusal("mesh.drop", {{"mesh", sent[3]}}), "");
  EXPECT_EQ(meshes_.at(sent[4])->mesh.triangles.size(), 12U);
}

// Whatever a message has in its arguments, the answer is one line, and the session goes on.
TEST_F(MeshSessionTest, ArgumentsOfAnyKindAreTakenOrRefused) {
  constexpr unsigned seed = 7;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  const json file{{"name", "box.off"}, {"bytes", std::string_view(sim::box_off).size()}};
  const std::vector<json> values{json(),
                                 true,
                                 -1,
                                 0,
                                 1,
                                 2,
                                 3,
                                 40,
                                 1e99,
                                 9007199254740991U,
                                 "",
                                 "AAAA",
                                 base64(sim::box_off),
                                 base64(std::string_view(sim::box_off).substr(0, 40)),
                                 "../../etc/passwd",
                                 json::array(),
                                 json::array({file}),
                                 json::array({file, {{"name", "a.mtl"}, {"bytes", 40}}}),
                                 json::array({{{"name", "../box.off"}, {"bytes", 1}}}),
                                 json::array({{{"name", 5}, {"bytes", json::object()}}}),
                                 json::object()};
  const std::vector<const char*> names{"mesh.begin", "mesh.part", "mesh.part", "mesh.look",
                                       "mesh.shape", "mesh.drop", "mesh.walk"};
  const std::vector<const char*> words{"files", "mesh", "file", "at", "data"};
  std::size_t taken = 0;
  for (int i = 0; i < 3000; ++i) {
    json arguments = json::object();
    for (const char* const word : words) {
      if (below(8) != 0) {
        arguments[word] = values[below(values.size())];
      }
    }
    if (below(2) == 0) {
      arguments["files"] = json::array({file});
      arguments["file"] = 0;
      arguments["at"] = 0;
    }
    const Viewers::Answer answer = ask(names[below(names.size())], arguments);
    EXPECT_EQ(answer.text.find('\n'), std::string::npos) << answer.text;
    taken += answer.is_done ? 1 : 0;
  }
  EXPECT_GT(taken, 100U);
  must("mesh.look", {{"mesh", send({{"box.off", sim::box_off}})}});
}

// The files of all meshes together have a bound, whatever is declared.
TEST_F(MeshSessionTest, ADeclaredSizeIsNoMemoryBeforeItsBytesCome) {
  std::vector<json> sent;
  for (int i = 0; i < 20; ++i) {
    sent.push_back(must("mesh.begin", {{"files", {{{"name", "a.stl"}, {"bytes", 16U << 20U}}}}})["mesh"]);
  }
  const json last{{"mesh", sent.back()}, {"file", 0}, {"at", 0}, {"data", "AAAA"}};
  EXPECT_EQ(must("mesh.part", last)["received"], 3);
  json first = last;
  first["mesh"] = sent.front();
  EXPECT_NE(refusal("mesh.part", first), "");
  EXPECT_NE(
      refusal("mesh.begin",
              {{"files", {{{"name", "a.obj"}, {"bytes", 16U << 20U}}, {{"name", "a.mtl"}, {"bytes", 16U << 20U}}}}}),
      "");
}

class ImpatientMeshSession : public MeshSessionTest {
 protected:
  ImpatientMeshSession() : MeshSessionTest({std::chrono::milliseconds(0), std::chrono::milliseconds(0)}) {}
};

TEST_F(ImpatientMeshSession, ATransferThatStopsIsForgotten) {
  const json mesh = must("mesh.begin", declared({{"box.off", sim::box_off}}))["mesh"];
  EXPECT_NE(refusal("mesh.part", {{"mesh", mesh}, {"file", 0}, {"at", 0}, {"data", base64(sim::box_off)}}), "");
}

}  // namespace
}  // namespace proleg::tools
