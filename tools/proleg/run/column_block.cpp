#include "tools/proleg/run/column_block.hpp"

#include "shared/computer/deflate/deflate.hpp"

namespace proleg::tools {

void ColumnBlock::add(std::span<const std::int32_t> row) {
  values_.insert(values_.end(), row.begin(), row.end());
  ++rows_;
}

std::string ColumnBlock::take() {
  std::string bytes;
  bytes.reserve(values_.size() * sizeof(std::int32_t));
  for (std::size_t column = 0; column < columns_; ++column) {
    std::uint32_t before = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
      const auto value = static_cast<std::uint32_t>(values_[row * columns_ + column]);
      const std::uint32_t difference = value - before;
      before = value;
      for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes += static_cast<char>(difference >> shift & 0xFFU);
      }
    }
  }
  rows_ = 0;
  values_.clear();
  return base64(deflate(bytes));
}

}  // namespace proleg::tools
