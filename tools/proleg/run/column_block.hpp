#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace proleg::tools {

/// Some ticks of a recording in the form of the player (docs/page-interface.md, The file of a recording): columns of
/// differences, which compress well.
class ColumnBlock {
 public:
  static constexpr std::size_t max_rows = 4096;

  explicit ColumnBlock(std::size_t columns) : columns_(columns) {}

  /// Only if the block is not full.
  void add(std::span<const std::int32_t> row);
  [[nodiscard]] bool is_empty() const { return rows_ == 0; }
  [[nodiscard]] bool is_full() const { return rows_ == max_rows; }
  /// The rows as text, in base64. The block is empty then.
  [[nodiscard]] std::string take();

 private:
  std::size_t columns_;
  std::size_t rows_ = 0;
  std::vector<std::int32_t> values_;  ///< row by row
};

}  // namespace proleg::tools
