// Mesh files as other programs write them. The expected values are what the formats mean.

#include "sim/mesh/mesh_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "sim/mesh/mesh_checks.hpp"

namespace proleg::sim {
namespace {

template <typename Action>
std::string refusal(const Action& action) {
  try {
    static_cast<void>(action());
  } catch (const MeshError& error) {
    EXPECT_EQ((error.found + error.expected).find('\n'), std::string::npos);
    return error.found + ", expected " + error.expected;
  }
  return "nothing";
}

std::string stl_refusal(const std::string& bytes) {
  return refusal([&] { return plain_stl("a.stl", bytes); });
}

const std::string facet =
    "  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n      vertex 0 1.5e-1 0\n"
    "    endloop\n  endfacet\n";
const std::string plain_facet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1.5e-1 0\nendloop\nendfacet\n";
const std::string plain = "solid\n" + plain_facet + "endsolid\n";

std::string upper_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
  return text;
}

/// A binary file with `triangles` triangles that says it has `count`.
std::string binary(unsigned count, std::size_t triangles, const std::string& header = "made by a scanner") {
  std::string bytes = header;
  bytes.resize(80, ' ');
  bytes += {static_cast<char>(count), '\0', '\0', '\0'};
  for (std::size_t i = 0; i < triangles; ++i) {
    bytes += std::string(48, '\x3F') + std::string(2, '\0');
  }
  return bytes;
}

TEST(PlainStl, KeepsTheNumbersOfAText) { EXPECT_EQ(plain_stl("a.stl", "solid a\n" + facet + "endsolid a\n"), plain); }

TEST(PlainStl, ReadsKeywordsInCapitalsAndBlanksBeforeTheFirst) {
  EXPECT_EQ(plain_stl("a.stl", upper_case("solid a\n" + facet + "endsolid a\n")), plain);
  EXPECT_EQ(plain_stl("a.stl", "Solid a\n" + facet + "EndSolid a\n"), plain);
  EXPECT_EQ(plain_stl("a.stl", "\n \r\n\tsolid a\n" + facet + "endsolid a"), plain);
  EXPECT_EQ(plain_stl("a.stl", "\xEF\xBB\xBFsolid a\r" + facet + "endsolid a\r"), plain);
}

TEST(PlainStl, LeavesOutEmptySolids) {
  const std::string full = "solid a b\n" + facet + "endsolid a b\n";
  EXPECT_EQ(plain_stl("a.stl", "solid 4\nendsolid\n" + full), plain);
  EXPECT_EQ(plain_stl("a.stl", full + "solid 4\nendsolid 4"), plain);
  EXPECT_EQ(plain_stl("a.stl", "solid\nendsolid solid\nsolid x endsolid x\n" + full), plain);
  EXPECT_EQ(plain_stl("a.stl", full + "\n" + full), plain + plain);
  EXPECT_EQ(stl_refusal("solid 4\nendsolid\n"), "no triangle in 'a.stl', expected a mesh of triangles");
}

TEST(PlainStl, ReadsTwoSolidsInOneLine) {
  std::string line = "solid a\n" + facet + "endsolid a\nsolid b\n" + facet + "endsolid b\n";
  std::ranges::replace(line, '\n', ' ');
  EXPECT_EQ(plain_stl("a.stl", line), plain + plain);
}

TEST(PlainStl, ANameMayBeMadeOfKeywords) {
  EXPECT_EQ(plain_stl("a.stl", "solid facet normal vertex\n" + facet + "endsolid solid facet\n"), plain);
}

TEST(PlainStl, ReplacesANormalThatIsNotFinite) {
  std::string text = "solid a\n" + facet + "endsolid a\n";
  text.replace(text.find("0 0 1"), 5, "-nan(ind) NaN inf");
  std::string expected = plain;
  expected.replace(expected.find("0 0 1"), 5, "0 0 0");
  EXPECT_EQ(plain_stl("a.stl", text), expected);
}

TEST(PlainStl, LeavesOutWhatIsBehindTheLastSolidOrTriangle) {
  EXPECT_EQ(plain_stl("a.stl", "solid a\n" + facet + "endsolid a\n; made by a scanner\x1A"), plain);
  const std::string bytes = binary(2, 2);
  for (const std::string& rest :
       {std::string(), std::string("\n"), std::string("\r\n\r\n\r\n"), std::string(512, '\0'), std::string(49, '\x7'),
        "the serial number of the scanner, and when it was " + facet}) {
    EXPECT_EQ(plain_stl("a.stl", bytes + rest), bytes);
  }
  EXPECT_EQ(plain_stl("a.stl", binary(2, 2, "solid a") + "\n"), binary(2, 2, "solid a"));
}

TEST(PlainStl, ABinaryFileThatDoesNotFitItsNumberOfTrianglesIsRefused) {
  const std::string expected = ", expected at least one triangle, and 84 bytes and 50 for each";
  const auto message = [&](int size, int count) {
    return "a binary STL file of " + std::to_string(size) + " bytes that says it has " + std::to_string(count) +
           " triangles, 'a.stl'" + expected;
  };
  EXPECT_EQ(stl_refusal(binary(3, 2)), message(184, 3));
  EXPECT_EQ(stl_refusal(binary(1, 2)), message(184, 1)) << "the second could be lost";
  EXPECT_EQ(stl_refusal(binary(1, 2) + "\n"), message(185, 1));
  EXPECT_EQ(stl_refusal(binary(0, 2)), message(184, 0));
  EXPECT_EQ(stl_refusal(binary(2, 2, "solid a").substr(0, 183)), message(183, 2));
  EXPECT_EQ(stl_refusal(std::string(20, '\0')), message(20, 0));
}

TEST(PlainStl, ATextThatEndsTooEarlyOrHasSomethingElseIsRefusedWithItsLine) {
  const std::string text = "solid a\n" + facet + facet + "endsolid a\n";
  EXPECT_EQ(stl_refusal(text.substr(0, text.find("endsolid"))),
            "the end of the file in line 16 of 'a.stl', expected 'facet' or 'endsolid'");
  EXPECT_EQ(stl_refusal("solid a\n" + facet),
            "the end of the file in line 9 of 'a.stl', expected 'facet' or 'endsolid'");
  EXPECT_EQ(stl_refusal(text.substr(0, text.rfind("endfacet"))),
            "the end of the file in line 15 of 'a.stl', expected 'endfacet'");
  EXPECT_EQ(stl_refusal(text.substr(0, text.rfind("0 1.5e-1") + 1)),
            "the end of the file in line 13 of 'a.stl', expected a number");
  for (const auto& [from, to, message] : {
           std::tuple("vertex 0 0 0", "vertex 0 0 O", "'o' in line 4 of 'a.stl', expected a number"),
           std::tuple("vertex 0 0 0", "vertex 0 0 nan", "'nan' in line 4 of 'a.stl', expected a number"),
           std::tuple("vertex 0 0 0", "vertex 0 0", "'vertex' in line 5 of 'a.stl', expected a number"),
           std::tuple("      vertex 0 0 0\n", "", "'endloop' in line 6 of 'a.stl', expected 'vertex'"),
           std::tuple("    endloop", "vertex 0 0 0\n", "'vertex' in line 7 of 'a.stl', expected 'endloop'"),
           std::tuple("solid a", "; a comment\nsolid a", "';' in line 1 of 'a.stl', expected 'solid'"),
       }) {
    std::string broken = text;
    broken.replace(broken.find(from), std::string(from).size(), to);
    EXPECT_EQ(stl_refusal(broken), message);
  }
  EXPECT_EQ(stl_refusal(text + "vertex 1 2 3\n"), "'vertex' in line 17 of 'a.stl', expected 'solid'");
  EXPECT_EQ(stl_refusal(""), "the end of the file in line 1 of 'a.stl', expected 'solid'");
}

TEST(PlainText, HasNoByteOrderMarkAndUsualLineEnds) {
  EXPECT_EQ(plain_text("a.obj", "\xEF\xBB\xBFv 1 2 3\nv 4 5 6\n"), "v 1 2 3\nv 4 5 6\n");
  EXPECT_EQ(plain_text("a.obj", "v 1 2 3\rv 4 5 6\r"), "v 1 2 3\nv 4 5 6\n");
  EXPECT_EQ(plain_text("a.obj", "v 1 2 3\r\nv 4 5 6\r\n"), "v 1 2 3\r\nv 4 5 6\r\n");
}

TEST(PlainText, IsNotInUtf16) {
  using namespace std::string_literals;
  const std::string message = "text in UTF-16, 'a.obj', expected text in UTF-8 or ASCII; editors can save it so";
  for (const std::string& text : {"\xFF\xFEv\0 \0"s, "\xFE\xFF\0v\0 "s, "v\0 \0001\0"s, "\0v\0 \0001"s}) {
    EXPECT_EQ(refusal([&] { return plain_text("a.obj", text); }), message);
    EXPECT_EQ(refusal([&] { return plain_stl("a.obj", text); }), message);
  }
}

}  // namespace
}  // namespace proleg::sim
