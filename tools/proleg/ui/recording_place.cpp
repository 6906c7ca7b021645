#include "tools/proleg/ui/recording_place.hpp"

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

std::filesystem::path new_recording(const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path file(name);
  if (file.empty() || file.filename() != file || file.extension() != ".proleg") {
    throw InputError("file", 0, in_quotes(shortened(name)), "a name without a folder that ends in .proleg");
  }
  std::filesystem::path path = folder / file;
  if (std::filesystem::exists(path)) {
    throw InputError(path.string(), 0, "a file that exists", "a new name");
  }
  return path;
}

}  // namespace proleg::tools
