#include "sim/optimize/report/thesis_tables.hpp"

#include <algorithm>
#include <optional>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::optimize {
namespace {

constexpr std::string_view header = "experiment\tmethod\ttable\truns\tvalue\t1\t2\t3\t4\t5\t6\t7\t8\t9\t10";
constexpr std::size_t name_cells = 5;  ///< cells for experiment, method, table, runs and value

/// The part of the text before the next separator, which is removed with it.
std::string_view next_part(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
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
    require(!in_table_, "the end of the file", "a row '" + std::string(thesis_distance_row) + "'");
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
    const std::optional<unsigned> runs = parse_whole<unsigned>(cells[3]);
    require(runs.has_value(), in_quotes(cells[3]) + " as the number of runs", "a whole number");
    if (!in_table_) {
      results_.push_back({std::string(cells[0]), std::string(cells[1]), std::string(cells[2]), *runs, {}, {}});
      in_table_ = true;
    }
    ThesisResult& result = results_.back();
    require(
        cells[0] == result.experiment && cells[1] == result.method && cells[2] == result.table && *runs == result.runs,
        "a row of another table", "the row '" + std::string(thesis_distance_row) + "' of " + result.table);
    std::array<double, thesis_columns> numbers{};
    for (std::size_t column = 0; column < thesis_columns; ++column) {
      const std::string_view cell = cells[name_cells + column];
      const std::optional<double> number = parse_number(cell);
      require(number.has_value(), in_quotes(cell) + " in column " + std::to_string(column + 1), "a number");
      numbers[column] = *number;
    }
    if (cells[4] == thesis_distance_row) {
      result.displacements_m = numbers;
      in_table_ = false;
    } else {
      result.rows.push_back({std::string(cells[4]), numbers});
    }
  }

  std::string file_;
  int line_ = 0;
  bool has_header_ = false;
  bool in_table_ = false;  ///< the last row of the table is still to come
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

const ThesisResult* find_thesis_result(std::string_view experiment, std::string_view method) {
  const std::span<const ThesisResult> results = thesis_results();
  const auto result = std::ranges::find_if(
      results, [&](const ThesisResult& its) { return its.experiment == experiment && its.method == method; });
  return result == results.end() ? nullptr : &*result;
}

}  // namespace proleg::optimize
