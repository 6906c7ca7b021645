// Reads arbitrary input as a data file. For every input the reader must write a table whose lines have as many cells as
// its header, in the order of time, or throw an InputError of one line. What it makes of a file that is cut is a part
// of what it makes of the whole file.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "sim/data_file/data_file.hpp"

namespace {

using namespace proleg;

void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

/// The number of rows; nothing if the input was refused.
std::size_t read(const std::string& text) {
  std::size_t lines = 0;
  std::ptrdiff_t tabs = 0;
  double time = 0.0;
  try {
    sim::DataFile data("input.xml", [&text] { return std::make_unique<std::istringstream>(text); });
    data.write_table([&](std::string_view line) {
      require(!line.empty() && line.find('\n') == line.size() - 1, "a line at a time");
      const std::ptrdiff_t here = std::ranges::count(line, '\t');
      if (lines++ == 0) {
        tabs = here;
        return;
      }
      require(here == tabs, "a cell for each column");
      const std::string cell(line.substr(line.find('\t') + 1));
      const double now = std::strtod(cell.c_str(), nullptr);
      require(lines == 2 || now >= time, "the order of time");
      time = now;
    });
    require(data.rows() + 1 == lines, "rows are counted");
    require(data.remark_on_cut().find('\n') == std::string::npos, "a remark is one line");
  } catch (const InputError& error) {
    const std::string_view message = error.what();
    require(std::ranges::none_of(message, [](char c) { return static_cast<unsigned char>(c) < 0x20; }),
            "a message is one line");
    require(message.starts_with("input.xml"), "a message names the file");
    require(message.find(": found ") != std::string_view::npos, "a message says what was found");
    require(message.find(", expected ") != std::string_view::npos, "a message says what was expected");
    return 0;
  }
  return lines - 1;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  const std::size_t rows = read(text);
  const std::size_t cut = read(text.substr(0, size / 2));
  require(rows == 0 || cut <= rows, "a cut file has no more rows than the whole");
  return 0;
}
