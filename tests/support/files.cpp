#include "tests/support/files.hpp"

#include <fstream>
#include <iterator>

namespace proleg {

// The only file that is compiled with the folder's name, so that the compiler cache serves every checkout.
std::string source_path(std::string_view below) { return std::string(PROLEG_SOURCE_DIR).append(below); }

std::string file_contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace proleg
