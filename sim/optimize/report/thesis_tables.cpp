#include "sim/optimize/report/thesis_tables.hpp"

#include <algorithm>
#include <optional>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::optimize {
namespace {

constexpr std::string_view header = "method\ttable\truns\tvalue\t1\t2\t3\t4\t5\t6\t7\t8\t9\t10";
constexpr std::size_t name_cells = 4;  ///< method, table, runs, value
constexpr std::size_t rows_of_table = thesis_joints + 1;

/// The part of the text before the next separator, which is removed with it.
std::string_view next_part(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

std::string row_name(std::size_t row) {
  return row < thesis_joints ? "Joint " + std::to_string(row) : "Displacement [m]";
}

/// Reads the rows of one table after the other.
class TablesReader {
 public:
  explicit TablesReader(const std::string& file) : file_(file) {}

  void read_line(std::string_view line) {
    ++line_;
    if (line.empty() || line.starts_with('#')) {
      return;
    }
    if (!has_header_) {
      require(line == header, in_quotes(line), "the names of the columns: " + std::string(header));
      has_header_ = true;
      return;
    }
    read_row(line);
  }

  [[nodiscard]] std::vector<ThesisResult> finish() {
    require(row_ == 0, "the end of the file", "a row '" + row_name(row_) + "'");
    require(!results_.empty(), "no table", "at least one");
    return std::move(results_);
  }

 private:
  void require(bool holds, const std::string& found, const std::string& expected) const {
    if (!holds) {
      throw InputError(file_, line_, found, expected);
    }
  }

  void read_row(std::string_view line) {
    std::vector<std::string_view> cells;
    while (!line.empty()) {
      cells.push_back(next_part(line, '\t'));
    }
    require(cells.size() == name_cells + thesis_columns, std::to_string(cells.size()) + " cells",
            std::to_string(name_cells + thesis_columns) + ", separated by tabs");
    const std::optional<unsigned> runs = parse_whole<unsigned>(cells[2]);
    require(runs.has_value(), in_quotes(cells[2]) + " as the number of runs", "a whole number");
    if (row_ == 0) {
      results_.push_back({std::string(cells[0]), std::string(cells[1]), *runs, {}, {}});
    }
    ThesisResult& result = results_.back();
    require(cells[0] == result.method && cells[1] == result.table && *runs == result.runs,
            "a row of another table after " + std::to_string(row_) + " rows", std::to_string(rows_of_table) + " rows");
    require(cells[3] == row_name(row_), "row " + in_quotes(cells[3]), "row '" + row_name(row_) + "'");
    auto& numbers = row_ < thesis_joints ? result.amplitudes_deg[row_] : result.displacements_m;
    for (std::size_t column = 0; column < thesis_columns; ++column) {
      const std::string_view cell = cells[name_cells + column];
      const std::optional<double> number = parse_number(cell);
      require(number.has_value(), in_quotes(cell) + " in column " + std::to_string(column + 1), "a number");
      numbers[column] = *number;
    }
    row_ = (row_ + 1) % rows_of_table;
  }

  std::string file_;
  int line_ = 0;
  bool has_header_ = false;
  std::size_t row_ = 0;  ///< of the table that is read; 0: a table starts
  std::vector<ThesisResult> results_;
};

}  // namespace

std::vector<ThesisResult> read_thesis_tables(std::string_view text, const std::string& file) {
  TablesReader reader(file);
  while (!text.empty()) {
    reader.read_line(next_part(text, '\n'));
  }
  return reader.finish();
}

std::span<const ThesisResult> thesis_results() {
  static const std::vector<ThesisResult> results = read_thesis_tables(thesis_tables_text(), "thesis_tables.tsv");
  return results;
}

const ThesisResult* find_thesis_result(std::string_view method) {
  const std::span<const ThesisResult> results = thesis_results();
  const auto result = std::ranges::find(results, method, &ThesisResult::method);
  return result == results.end() ? nullptr : &*result;
}

}  // namespace proleg::optimize
