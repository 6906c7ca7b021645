#pragma once

// The published results of the thesis's experiments 6.1 and 6.2. The numbers are in thesis_tables.tsv, which the build
// embeds, so an installed program needs no file.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::optimize {

inline constexpr std::size_t thesis_columns = 10;
inline constexpr std::string_view thesis_distance_row = "Displacement [m]";

/// The published results of a method: its ten best runs, best first.
struct ThesisResult {
  struct Row {
    std::string name;
    std::array<double, thesis_columns> values;
  };

  std::string experiment;  ///< name of the experiment in `proleg experiment`
  std::string method;      ///< name of the method
  std::string table;       ///< "table 6.2"
  unsigned runs = 0;       ///< number of runs in the thesis
  std::vector<Row> rows;   ///< the values of the parameters, as the thesis lists them
  std::array<double, thesis_columns> displacements_m{};
};

/// The results in tables 6.2 and 6.7 (great deluge), 6.4 and 6.9 (genetic algorithm).
[[nodiscard]] std::span<const ThesisResult> thesis_results();
/// Finds the result of a method; null if the thesis has no table for it.
[[nodiscard]] const ThesisResult* find_thesis_result(std::string_view experiment, std::string_view method);

/// Reads a text in the format of thesis_tables.tsv. Throws InputError, which names `file` and the line.
[[nodiscard]] std::vector<ThesisResult> read_thesis_tables(std::string_view text, const std::string& file);

/// The text of thesis_tables.tsv when this program was built.
[[nodiscard]] std::string_view thesis_tables_text();

}  // namespace proleg::optimize
