#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

namespace proleg::tools {

/// Smallest and largest values of blocks of rows, so that a picture of a long recording needs as much reading as it has
/// pixels. The blocks are in a temporary file that ends with the object: the memory does not grow with the rows, and
/// nothing is written beside a recording.
class RowPyramid {
 public:
  /// Rows in a block of each level.
  static constexpr std::array<std::uint32_t, 4> block_rows{8, 64, 512, 4096};

  /// width: values in a row, at least 1. Throws std::system_error if there is no temporary file.
  explicit RowPyramid(std::size_t width);

  /// The next row. host::no_value counts for neither minimum nor maximum. Throws std::system_error if the file cannot
  /// grow.
  void add(std::span<const std::int32_t> row);
  [[nodiscard]] std::uint64_t rows() const { return rows_; }

  /// Blocks of `stride` rows, from number `first` on, one behind the other: each its first row, then the minima, then
  /// the maxima; a value that no row of the block has is host::no_value. The last block may have fewer rows than the
  /// others. Throws std::invalid_argument if there are no such blocks, and std::system_error.
  [[nodiscard]] std::vector<std::int32_t> blocks(std::uint32_t stride, std::uint64_t first, std::uint64_t count) const;

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  [[nodiscard]] std::size_t block_size() const { return 3 * width_; }
  void merge(std::vector<std::int32_t>& block, std::span<const std::int32_t> row) const;

  std::size_t width_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::array<std::vector<std::int32_t>, block_rows.size()> last_;  ///< the block of each level that still grows
  std::uint64_t rows_ = 0;
};

}  // namespace proleg::tools
