#include "tools/proleg/common/scratch_folder.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <system_error>

namespace proleg::tools {

ScratchFolder::ScratchFolder() {
  const std::filesystem::path parent = std::filesystem::temp_directory_path();
  std::string folder = (parent / "proleg_XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw std::runtime_error("cannot make a folder in " + parent.string());
  }
  path_ = folder;
}

ScratchFolder::~ScratchFolder() {
  std::error_code error;  // what is left does no harm
  std::filesystem::remove_all(path_, error);
}

}  // namespace proleg::tools
