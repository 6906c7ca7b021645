#pragma once

#include <cstdlib>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "sim/data_file/data_file.hpp"

namespace proleg::sim {

/// A table with its cells by the names of the columns.
struct ReadTable {
  std::vector<std::string> columns;
  std::vector<std::map<std::string, std::string>> rows;
  std::string remark;

  [[nodiscard]] double number(std::size_t row, const std::string& column) const {
    return std::strtod(rows.at(row).at(column).c_str(), nullptr);
  }
};

inline std::vector<std::string> cells_in(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    c == '\t' ? cells.emplace_back() : cells.back() += c;
  }
  return cells;
}

inline ReadTable table_of(DataFile& data) {
  std::string written;
  data.write_table([&](std::string_view part) { written += part; });
  ReadTable table;
  std::istringstream lines(written);
  std::string line;
  std::getline(lines, line);
  table.columns = cells_in(line);
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = cells_in(line);
    auto& row = table.rows.emplace_back();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      row[i < table.columns.size() ? table.columns[i] : "beyond"] = cells[i];
    }
  }
  table.remark = data.remark_on_cut();
  return table;
}

inline ReadTable table_of_text(const std::string& text) {
  DataFile data("some.data.xml", [text] { return std::make_unique<std::istringstream>(text); });
  return table_of(data);
}

}  // namespace proleg::sim
