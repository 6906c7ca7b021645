#include "tools/proleg/new/new_files.hpp"

#include <iostream>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "sim/scenario/sources.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

void create_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw BadInput("cannot create the folder " + folder.string() + ": " + error.message());
  }
}

}  // namespace

void write_new_files(const std::filesystem::path& folder, std::span<const sim::SourceFile> files) {
  if (folder.empty()) {
    throw InputError("--out", 0, "an empty name", "the name of a folder");
  }
  for (const sim::SourceFile& file : files) {
    if (std::filesystem::exists(folder / file.path)) {
      throw BadInput((folder / file.path).string() +
                     ": found an existing file, expected none; --out FOLDER names another folder");
    }
  }
  for (const sim::SourceFile& file : files) {
    const std::filesystem::path path = folder / file.path;
    create_folder(path.parent_path());
    write_file(path, sim::bytes_of_source(file.text));
    std::cout << "written  " << path.string() << '\n';
  }
}

}  // namespace proleg::tools
