#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg {

/// A line of a tab-separated table. Its first cell is not empty.
class TableLine {
 public:
  void add(std::string_view cell) {
    if (!text_.empty()) {
      text_ += '\t';
    }
    text_ += cell;
  }
  void add(const char* cell) { add(std::string_view(cell)); }
  /// Appends a cell with a number; the cell is empty if the number is not finite.
  template <std::floating_point Number>
  void add(Number value) {
    add(std::string_view(exact_text(value)));
  }
  template <std::unsigned_integral Number>
  void add(Number value) {
    add(std::string_view(std::to_string(value)));
  }

  /// Returns the cells and a line end; then starts an empty line.
  [[nodiscard]] std::string finish() { return std::exchange(text_, {}) + '\n'; }

 private:
  std::string text_;
};

}  // namespace proleg
