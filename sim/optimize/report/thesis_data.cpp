#include "sim/optimize/report/thesis_data.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::optimize {
namespace {

/// Rows from head to tail, by the first joint that each dimension sets.
std::vector<ThesisRow> joint_rows(const SearchSpace& space) {
  std::vector<std::size_t> order(space.dimensions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return space.dimensions[i].targets.front().joint; });
  std::vector<ThesisRow> rows;
  rows.reserve(order.size());
  for (const std::size_t dimension : order) {
    rows.push_back({"Joint " + std::to_string(rows.size()), dimension});
  }
  return rows;
}

/// Rows with the thesis's names of the constants.
std::vector<ThesisRow> constant_rows(const SearchSpace& space) {
  std::vector<ThesisRow> rows;
  for (const Dimension& dimension : space.dimensions) {
    std::string name = dimension.name;
    if (name == "stuck_threshold") {
      name = "Get-stuck";
    } else if (name == "recovering") {
      name = "Recovering";
    } else if (name.starts_with("constant_")) {
      name = "Constant " + name.substr(name.find('_') + 1);
    }
    rows.push_back({name, rows.size()});
  }
  return rows;
}

constexpr std::array<ThesisMethod, 3> wave_methods{{
    {"great-deluge", "great_deluge.optimise.xml", "table_6_2.tsv", "figure_6_3.svg", "figure_6_4.svg"},
    {"genetic", "genetic.optimise.xml", "table_6_4.tsv", "figure_6_5.svg", "figure_6_6.svg"},
    {"cma-es", "cma_es.optimise.xml", "table_cma_es.tsv", "figure_cma_es_runs.svg", "figure_cma_es_spread.svg"},
}};
constexpr std::array<ReferenceScenario, 1> wave_references{{{"uniform amplitudes of 40 deg", "uniform", "", 1.65}}};

constexpr std::array<ThesisMethod, 4> touch_methods{{
    {"great-deluge", "great_deluge.optimise.xml", "table_6_7.tsv", "figure_6_10.svg", "figure_6_11.svg"},
    {"great-deluge-bounded", "great_deluge_bounded.optimise.xml", "table_6_7_bounded.tsv", "figure_6_10_bounded.svg",
     "figure_6_11_bounded.svg"},
    {"genetic", "genetic.optimise.xml", "table_6_9.tsv", "figure_6_12.svg", "figure_6_13.svg"},
    {"cma-es", "cma_es.optimise.xml", "table_cma_es.tsv", "figure_cma_es_runs.svg", "figure_cma_es_spread.svg"},
}};
constexpr std::string_view touch_level_ground = "plain_level.simulation.xml";
constexpr std::array<ReferenceScenario, 3> touch_references{{
    {"the sine without the reflex", "no reflex", "plain.simulation.xml", 0.0},
    {"the reflex as set by hand", "set by hand", "reflex.simulation.xml", 0.0},
    {"the sine on level ground", "level ground", touch_level_ground, 0.0},
}};

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

const ThesisExperiment& travelling_wave_experiment() {
  static constexpr ThesisExperiment experiment{.name = "travelling_wave",
                                               .title = "Travelling wave",
                                               .about = "the amplitudes of section 6.1",
                                               .repetitions = "3",
                                               .engine = "",
                                               .methods = wave_methods,
                                               .references = wave_references,
                                               .level_ground = "",
                                               .comparison_figure = "figure_7_1.svg",
                                               .overtaking = "5000",
                                               .shown_value = "tail joint",
                                               .shown_row = 4,
                                               .shown_unit = "deg",
                                               .rows = joint_rows};
  return experiment;
}

const ThesisExperiment& adaptive_touch_experiment() {
  static constexpr ThesisExperiment experiment{.name = "adaptive_touch",
                                               .title = "Irregular obstacle",
                                               .about = "the adaptive algorithm of section 6.2",
                                               .repetitions = "20",
                                               .engine = "reduced",
                                               .methods = touch_methods,
                                               .references = touch_references,
                                               .level_ground = touch_level_ground,
                                               .comparison_figure = "figure_7_2.svg",
                                               .overtaking = "3000",
                                               .shown_value = "get-stuck",
                                               .shown_row = 0,
                                               .shown_unit = "ms",
                                               .rows = constant_rows};
  return experiment;
}

std::span<const ThesisExperiment* const> thesis_experiments() {
  static const std::array<const ThesisExperiment*, 2> all{&travelling_wave_experiment(), &adaptive_touch_experiment()};
  return all;
}

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
