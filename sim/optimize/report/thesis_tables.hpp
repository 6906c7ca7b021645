#pragma once

// What the thesis published on its experiment 6.1. The numbers are in thesis_tables.tsv, which the build embeds, so an
// installed program needs no file.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::optimize {

inline constexpr std::size_t thesis_joints = 5;
inline constexpr std::size_t thesis_columns = 10;

/// What the thesis published for a method: its ten best runs, best first.
struct ThesisResult {
  std::string method;                                                              ///< as method_name() says
  std::string table;                                                               ///< "table 6.2"
  unsigned runs = 0;                                                               ///< that the thesis made
  std::array<std::array<double, thesis_columns>, thesis_joints> amplitudes_deg{};  ///< joint 0 (head) to 4 (tail)
  std::array<double, thesis_columns> displacements_m{};
};

/// Tables 6.2 (great deluge) and 6.4 (genetic algorithm).
[[nodiscard]] std::span<const ThesisResult> thesis_results();
/// Null if the thesis has no table for the method.
[[nodiscard]] const ThesisResult* find_thesis_result(std::string_view method);

/// Distance of 40 degrees on all joints (section 6.1, mean of 50 runs).
inline constexpr double thesis_uniform_distance_m = 1.65;

/// Reads a text in the format of thesis_tables.tsv. Throws InputError, which names `file` and the line.
[[nodiscard]] std::vector<ThesisResult> read_thesis_tables(std::string_view text, const std::string& file);

/// The text of thesis_tables.tsv when this program was built.
[[nodiscard]] std::string_view thesis_tables_text();

}  // namespace proleg::optimize
