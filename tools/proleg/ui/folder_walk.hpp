#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <vector>

namespace proleg::tools {

/// Folders below the first one that are entered, one in the other.
inline constexpr int max_folder_depth = 4;
/// Of a folder with more in it, some is not found: a home folder must not keep the program busy.
inline constexpr std::size_t max_visited_paths = 20'000;

/// Calls use(entry) for what is in a folder and in the folders in it; std::filesystem::directory_entry knows what kind
/// of file it is, and converts to a path. Links to folders are not followed. enters(path): whether to look into this
/// folder. Returns false if it has not seen all: there is too much, or a folder was removed meanwhile.
template <typename Use, typename Enters>
bool for_each_path(const std::filesystem::path& folder, const Use& use, const Enters& enters) {
  std::error_code error;
  std::size_t visited = 0;
  std::filesystem::recursive_directory_iterator entry(
      folder, std::filesystem::directory_options::skip_permission_denied, error);
  for (; !error && entry != std::filesystem::recursive_directory_iterator() && visited < max_visited_paths;
       entry.increment(error)) {
    ++visited;
    if (entry.depth() >= max_folder_depth || !enters(entry->path())) {
      entry.disable_recursion_pending();
    }
    use(*entry);
  }
  return !error && entry == std::filesystem::recursive_directory_iterator();
}

/// Whether a path is below a folder. Both without symbolic links.
[[nodiscard]] bool is_inside(const std::filesystem::path& folder, const std::filesystem::path& path);

/// The folders below this one, down to max_folder_depth, that have a regular file with one of these names: their paths
/// below it, in order. Hidden folders are left out. before: of an earlier call; those stay that were not visited and
/// still have such a file. folder: without symbolic links.
[[nodiscard]] std::vector<std::string> folders_with(const std::filesystem::path& folder,
                                                    std::span<const char* const> files,
                                                    std::span<const std::string> before);

/// What a name means that a viewer has sent: a path below the folder, which has no symbolic links in it. Nothing
/// outside can be reached, also not by symbolic links. Throws InputError for `argument` if there is no such thing.
/// expected: for the message.
[[nodiscard]] std::filesystem::path find_inside(const std::filesystem::path& folder, const std::string& name,
                                                const char* argument, const std::string& expected);

}  // namespace proleg::tools
