#include "tools/proleg/ui/scenario_copy.hpp"

#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/authoring/part_change.hpp"
#include "sim/scenario/sources.hpp"

namespace proleg::tools {
namespace fs = std::filesystem;
using sim::absolute_path;

std::map<std::string, std::string> copy_sources(std::span<const sim::SourceFile> sources, const fs::path& folder) {
  const fs::path root = sim::common_folder(sources);
  std::error_code error;
  if (!fs::create_directory(folder, error)) {
    if (error) {
      throw FileError(folder, "cannot be created: " + error.message());
    }
    throw InputError(folder.string(), 0, "a folder that exists", "a new name");
  }
  std::map<std::string, std::string> names;
  try {
    for (const sim::SourceFile& source : sources) {
      const fs::path place = folder / absolute_path(source.path).lexically_relative(root);
      fs::create_directories(place.parent_path());
      write_file(place, sim::bytes_of_source(source.text));
      names.emplace(source.path, sim::name_of(place));
    }
  } catch (...) {
    fs::remove_all(folder, error);
    throw;
  }
  return names;
}

fs::path new_folder_in(const fs::path& parent, const std::string& name, const char* argument) {
  const fs::path folder(name);
  const bool is_plain = is_visible_line(name) && shortened(name) == name;
  if (name.empty() || folder.filename() != folder || name.front() == '.' || !is_plain) {
    throw InputError(argument, 0, in_quotes(name),
                     "a name of 1 to 60 characters, without '/', that does not begin with a dot");
  }
  return parent / folder;
}

}  // namespace proleg::tools
