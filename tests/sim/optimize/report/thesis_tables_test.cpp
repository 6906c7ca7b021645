#include "sim/optimize/report/thesis_tables.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::optimize {
namespace {

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Sums of the rows as the thesis prints them.
TEST(ThesisResults, AreThoseOfTable6_2) {
  const ThesisResult* const result = find_thesis_result("great-deluge");
  ASSERT_NE(result, nullptr);
  EXPECT_EQ(result->table, "table 6.2");
  EXPECT_EQ(result->runs, 30U);
  const std::array<double, 5> sums{400.0, 399.25, 399.25, 399.75, 2.25};
  for (std::size_t joint = 0; joint < 5; ++joint) {
    EXPECT_DOUBLE_EQ(mean_of(result->amplitudes_deg[joint]) * 10.0, sums[joint]) << "joint " << joint;
  }
  EXPECT_NEAR(mean_of(result->displacements_m), 1.9507, 1e-12);
  EXPECT_EQ(result->displacements_m.front(), 1.958);
  EXPECT_EQ(result->displacements_m.back(), 1.945);
  EXPECT_EQ(result->amplitudes_deg[1][1], 39.5);
  EXPECT_EQ(result->amplitudes_deg[3][1], 39.75);
  EXPECT_EQ(result->amplitudes_deg[4][3], 0.75);
  EXPECT_EQ(result->amplitudes_deg[4][8], 1.5);
}

TEST(ThesisResults, AreThoseOfTable6_4) {
  const ThesisResult* const result = find_thesis_result("genetic");
  ASSERT_NE(result, nullptr);
  EXPECT_EQ(result->table, "table 6.4");
  EXPECT_EQ(result->runs, 29U);
  const std::array<double, 5> sums{386.25, 393.0, 395.25, 378.5, 12.0};
  for (std::size_t joint = 0; joint < 5; ++joint) {
    EXPECT_DOUBLE_EQ(mean_of(result->amplitudes_deg[joint]) * 10.0, sums[joint]) << "joint " << joint;
  }
  EXPECT_NEAR(mean_of(result->displacements_m), 1.8394, 1e-12);
  EXPECT_EQ(result->displacements_m.front(), 1.878);
  EXPECT_EQ(result->displacements_m.back(), 1.806);
  EXPECT_EQ(result->amplitudes_deg[3][9], 30.25);
  EXPECT_EQ(result->amplitudes_deg[0][5], 37.0);
}

TEST(ThesisResults, AreSortedAndWithinTheSearchSpace) {
  for (const ThesisResult& result : thesis_results()) {
    EXPECT_TRUE(std::ranges::is_sorted(result.displacements_m, std::ranges::greater{}));
    for (const auto& row : result.amplitudes_deg) {
      for (const double amplitude : row) {
        EXPECT_TRUE(amplitude >= 0.0 && amplitude <= 40.0 && amplitude * 4.0 == std::floor(amplitude * 4.0));
      }
    }
  }
  EXPECT_EQ(find_thesis_result("cmaes"), nullptr);
}

std::string message_of(const std::string& text) {
  try {
    static_cast<void>(read_thesis_tables(text, "tables.tsv"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// The embedded file with one text, which must be there, replaced where it first occurs.
std::string embedded_with(const std::string& old_text, const std::string& new_text) {
  std::string text(thesis_tables_text());
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return at == std::string::npos ? text : text.replace(at, old_text.size(), new_text);
}

/// Number of the first line of the embedded file that starts with this text, plus `offset`.
std::string line_of(const std::string& start, int offset = 0) {
  const std::string text(thesis_tables_text());
  const std::size_t at = text.find("\n" + start);
  EXPECT_NE(at, std::string::npos) << start;
  return std::to_string(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 2 + offset);
}

TEST(ThesisTables, ThatAreMalformedAreRejectedWithFileAndLine) {
  EXPECT_EQ(message_of(std::string(thesis_tables_text())), "no error");
  const std::string first = "tables.tsv:" + line_of("great-deluge") + ": found ";
  EXPECT_EQ(message_of(embedded_with("Joint 0\t40\t40", "Joint 0\t40\tforty")),
            first + "'forty' in column 2, expected a number");
  EXPECT_EQ(message_of(embedded_with("Joint 0\t40\t40", "Joint 0\t40")),
            first + "13 cells, expected 14, separated by tabs");
  EXPECT_EQ(message_of(embedded_with("\t30\tJoint 0", "\tmany\tJoint 0")),
            first + "'many' as the number of runs, expected a whole number");
  EXPECT_EQ(message_of(embedded_with("Joint 0", "Joint 1")), first + "row 'Joint 1', expected row 'Joint 0'");
  const std::string header = message_of(embedded_with("method\ttable", "method\tchair"));
  EXPECT_TRUE(header.starts_with("tables.tsv:" + line_of("method") + ": found 'method chair")) << header;
}

TEST(ThesisTables, ThatAreIncompleteAreRejected) {
  const std::string text(thesis_tables_text());
  EXPECT_EQ(message_of(""), "tables.tsv: found no table, expected at least one");
  EXPECT_NE(message_of(text.substr(0, text.rfind("genetic")))
                .find("found the end of the file, expected a row "
                      "'Displacement [m]'"),
            std::string::npos);
  std::string without_row = text;
  const std::size_t row = without_row.find("great-deluge\ttable 6.2\t30\tDisplacement");
  without_row.erase(row, without_row.find('\n', row) + 1 - row);
  EXPECT_EQ(message_of(without_row),
            "tables.tsv:" + line_of("genetic", -1) + ": found a row of another table after 5 rows, expected 6 rows");
}

}  // namespace
}  // namespace proleg::optimize
