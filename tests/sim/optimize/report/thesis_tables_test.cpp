#include "sim/optimize/report/thesis_data.hpp"

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
  const ThesisResult* const result = find_thesis_result("travelling_wave", "great-deluge");
  ASSERT_NE(result, nullptr);
  EXPECT_EQ(result->table, "table 6.2");
  EXPECT_EQ(result->runs, 30U);
  const std::array<double, 5> sums{400.0, 399.25, 399.25, 399.75, 2.25};
  for (std::size_t joint = 0; joint < 5; ++joint) {
    EXPECT_DOUBLE_EQ(mean_of(result->rows.at(joint).values) * 10.0, sums[joint]) << "joint " << joint;
  }
  EXPECT_NEAR(mean_of(result->displacements_m), 1.9507, 1e-12);
  EXPECT_EQ(result->displacements_m.front(), 1.958);
  EXPECT_EQ(result->displacements_m.back(), 1.945);
  EXPECT_EQ(result->rows.at(1).values[1], 39.5);
  EXPECT_EQ(result->rows.at(3).values[1], 39.75);
  EXPECT_EQ(result->rows.at(4).values[3], 0.75);
  EXPECT_EQ(result->rows.at(4).values[8], 1.5);
}

TEST(ThesisResults, AreThoseOfTable6_4) {
  const ThesisResult* const result = find_thesis_result("travelling_wave", "genetic");
  ASSERT_NE(result, nullptr);
  EXPECT_EQ(result->table, "table 6.4");
  EXPECT_EQ(result->runs, 29U);
  const std::array<double, 5> sums{386.25, 393.0, 395.25, 378.5, 12.0};
  for (std::size_t joint = 0; joint < 5; ++joint) {
    EXPECT_DOUBLE_EQ(mean_of(result->rows.at(joint).values) * 10.0, sums[joint]) << "joint " << joint;
  }
  EXPECT_NEAR(mean_of(result->displacements_m), 1.8394, 1e-12);
  EXPECT_EQ(result->displacements_m.front(), 1.878);
  EXPECT_EQ(result->displacements_m.back(), 1.806);
  EXPECT_EQ(result->rows.at(3).values[9], 30.25);
  EXPECT_EQ(result->rows.at(0).values[5], 37.0);
}

// Sums of the rows as the thesis prints them.
TEST(ThesisResults, AreThoseOfTables6_7And6_9) {
  struct Table {
    const char* method;
    const char* table;
    std::array<double, 10> sums;
    double displacements;
  };
  for (const Table& table :
       {Table{"great-deluge", "table 6.7", {1600, 4.9, 34.7, 37.4, 46.9, 31.44, 28.6, 19.89, 42.52, 24.2}, 37.61},
        Table{"genetic", "table 6.9", {1525, 1.04, 8.5, 8.5, 7.3, 5.5, 4.5, 4.8, 9.5, 7.1}, 30.59}}) {
    const ThesisResult* const result = find_thesis_result("adaptive_touch", table.method);
    ASSERT_NE(result, nullptr);
    EXPECT_EQ(result->table, table.table);
    EXPECT_EQ(result->runs, 20U);
    ASSERT_EQ(result->rows.size(), 10U);
    for (std::size_t row = 0; row < 10; ++row) {
      EXPECT_NEAR(mean_of(result->rows[row].values) * 10.0, table.sums[row], 1e-9) << result->rows[row].name;
    }
    EXPECT_NEAR(mean_of(result->displacements_m) * 10.0, table.displacements, 1e-9);
  }
}

TEST(ThesisResults, AreSorted) {
  EXPECT_EQ(thesis_results().size(), 4U);
  for (const ThesisResult& result : thesis_results()) {
    EXPECT_TRUE(std::ranges::is_sorted(result.displacements_m, std::ranges::greater{}));
  }
}

TEST(ThesisResults, AreWithinTheSearchSpaceOfTheTravellingWave) {
  for (const char* method : {"great-deluge", "genetic"}) {
    for (const ThesisResult::Row& row : find_thesis_result("travelling_wave", method)->rows) {
      for (const double amplitude : row.values) {
        EXPECT_TRUE(amplitude >= 0.0 && amplitude <= 40.0 && amplitude * 4.0 == std::floor(amplitude * 4.0));
      }
    }
  }
  EXPECT_EQ(find_thesis_result("travelling_wave", "cmaes"), nullptr);
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
  const std::string first = "tables.tsv:" + line_of("travelling_wave") + ": found ";
  EXPECT_EQ(message_of(embedded_with("Joint 0\t40\t40", "Joint 0\t40\tforty")),
            first + "'forty' in column 2, expected a number");
  EXPECT_EQ(message_of(embedded_with("Joint 0\t40\t40", "Joint 0\t40")),
            first + "14 cells, expected 15, separated by tabs");
  EXPECT_EQ(message_of(embedded_with("\t30\tJoint 0", "\tmany\tJoint 0")),
            first + "'many' as the number of runs, expected a whole number");
  const std::string header = message_of(embedded_with("method\ttable\truns", "method\tchair\truns"));
  EXPECT_TRUE(header.starts_with("tables.tsv:" + line_of("experiment") + ": found 'experiment method chair")) << header;
}

TEST(ThesisTables, ThatAreIncompleteAreRejected) {
  const std::string text(thesis_tables_text());
  EXPECT_EQ(message_of(""), "tables.tsv: found no table, expected at least one");
  EXPECT_NE(message_of(text.substr(0, text.rfind("adaptive_touch")))
                .find("found the end of the file, expected a row "
                      "'Displacement [m]'"),
            std::string::npos);
  std::string without_row = text;
  const std::size_t row = without_row.find("travelling_wave\tgreat-deluge\ttable 6.2\t30\tDisplacement");
  without_row.erase(row, without_row.find('\n', row) + 1 - row);
  EXPECT_EQ(message_of(without_row),
            "tables.tsv:" + line_of("travelling_wave\tgenetic", -1) +
                ": found a row of another table, expected the row 'Displacement [m]' of table 6.2");
}

}  // namespace
}  // namespace proleg::optimize
