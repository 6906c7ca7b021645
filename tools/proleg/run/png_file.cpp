#include "tools/proleg/run/png_file.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "shared/computer/output/output.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"

namespace proleg::tools {
namespace {

/// A folder that is removed at the end.
class WorkFolder {
 public:
  WorkFolder() : path_((std::filesystem::temp_directory_path() / "proleg-png-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) {
      throw std::runtime_error("cannot create a folder in " + std::filesystem::temp_directory_path().string());
    }
  }
  ~WorkFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

std::string png_of(const std::string& svg) {
  const WorkFolder folder;
  write_file(folder.path() + "/picture.svg", svg);
  const ProgramResult result = run_program(
      {"rsvg-convert", "--format", "png", "--zoom", "2", "--output", "picture.png", "picture.svg"}, folder.path());
  if (!result.was_found) {
    throw BadInput(
        "--png: found no program rsvg-convert, expected it in PATH (on Debian: apt install librsvg2-bin); without "
        "--png "
        "the picture is SVG");
  }
  std::ifstream file(folder.path() + "/picture.png", std::ios::binary);
  std::ostringstream png;
  png << file.rdbuf();
  if (result.status != 0 || png.str().empty()) {
    throw std::runtime_error("rsvg-convert ended with status " + std::to_string(result.status) +
                             " and made no picture");
  }
  return png.str();
}

}  // namespace proleg::tools
