#include "tools/proleg/ui/row_pyramid.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <system_error>

#include "host/server/signal_layout.hpp"

namespace proleg::tools {
namespace {

constexpr std::uint32_t group_rows = RowPyramid::block_rows.back();

// The file is a row of groups; a group has all blocks of 4096 rows, level by level. So it can grow, and blocks that
// follow one another mostly are together.
constexpr std::uint64_t blocks_before(std::size_t level) {
  std::uint64_t blocks = 0;
  for (std::size_t i = 0; i < level; ++i) {
    blocks += group_rows / RowPyramid::block_rows[i];
  }
  return blocks;
}

constexpr std::uint64_t blocks_of_group = blocks_before(RowPyramid::block_rows.size());

std::uint64_t place(std::size_t level, std::uint64_t block) {
  const std::uint64_t in_group = group_rows / RowPyramid::block_rows[level];
  return block / in_group * blocks_of_group + blocks_before(level) + block % in_group;
}

[[noreturn]] void throw_errno() { throw std::system_error(errno, std::generic_category(), "temporary file"); }

void write_at(int file, std::span<const std::int32_t> values, std::uint64_t position) {
  const std::span<const std::byte> bytes = std::as_bytes(values);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written =
        ::pwrite(file, &bytes[done], bytes.size() - done, static_cast<off_t>(position * sizeof(std::int32_t) + done));
    if (written < 0 && errno != EINTR) {
      throw_errno();
    }
    done += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }
}

void read_at(int file, std::span<std::int32_t> values, std::uint64_t position) {
  const std::span<std::byte> bytes = std::as_writable_bytes(values);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got =
        ::pread(file, &bytes[done], bytes.size() - done, static_cast<off_t>(position * sizeof(std::int32_t) + done));
    if (got == 0 || (got < 0 && errno != EINTR)) {
      throw_errno();
    }
    done += static_cast<std::size_t>(std::max<ssize_t>(got, 0));
  }
}

/// A file without a name. Not in /tmp, which is memory on many systems.
std::FILE* open_temporary_file() {
  const char* const folder = std::getenv("TMPDIR");
  std::string name = std::string(folder == nullptr ? "/var/tmp" : folder) + "/proleg-XXXXXX";
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) {
    throw_errno();
  }
  ::unlink(name.c_str());
  std::FILE* const file = ::fdopen(descriptor, "w+");
  if (file == nullptr) {
    ::close(descriptor);
    throw_errno();
  }
  return file;
}

}  // namespace

RowPyramid::RowPyramid(std::size_t width) : width_(width), file_(open_temporary_file()) {}

void RowPyramid::merge(std::vector<std::int32_t>& block, std::span<const std::int32_t> row) const {
  for (std::size_t i = 0; i < width_; ++i) {
    std::int32_t& minimum = block[width_ + i];
    std::int32_t& maximum = block[2 * width_ + i];
    if (row[i] != host::no_value) {
      minimum = minimum == host::no_value ? row[i] : std::min(minimum, row[i]);
      maximum = std::max(maximum, row[i]);  // no_value is below all values
    }
  }
}

void RowPyramid::add(std::span<const std::int32_t> row) {
  for (std::size_t level = 0; level < block_rows.size(); ++level) {
    std::vector<std::int32_t>& block = last_[level];
    if (rows_ % block_rows[level] == 0) {
      block.clear();
      for (int part = 0; part < 3; ++part) {
        block.insert(block.end(), row.begin(), row.end());
      }
    } else {
      merge(block, row);
    }
    if ((rows_ + 1) % block_rows[level] == 0) {
      write_at(::fileno(file_.get()), block, place(level, rows_ / block_rows[level]) * block_size());
    }
  }
  ++rows_;
}

std::vector<std::int32_t> RowPyramid::blocks(std::uint32_t stride, std::uint64_t first, std::uint64_t count) const {
  const auto found = std::ranges::find(block_rows, stride);
  const std::uint64_t known = (rows_ + stride - 1) / stride;
  if (found == block_rows.end() || first > known || count > known - first) {
    throw std::invalid_argument("found other blocks, expected blocks that the pyramid has");
  }
  const auto level = static_cast<std::size_t>(found - block_rows.begin());
  const std::uint64_t complete = rows_ / stride;
  std::vector<std::int32_t> values(count * block_size());
  for (std::uint64_t block = first; block < first + count;) {
    const std::span<std::int32_t> target = std::span(values).subspan((block - first) * block_size());
    if (block >= complete) {
      std::ranges::copy(last_[level], target.begin());
      break;
    }
    // Up to the end of the group they are together in the file.
    const std::uint64_t in_group = group_rows / stride;
    const std::uint64_t together = std::min({in_group - block % in_group, complete - block, first + count - block});
    read_at(::fileno(file_.get()), target.first(together * block_size()), place(level, block) * block_size());
    block += together;
  }
  return values;
}

}  // namespace proleg::tools
