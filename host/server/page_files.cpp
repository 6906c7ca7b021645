#include "host/server/page_files.hpp"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"

namespace proleg::host {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t max_total_bytes = 64U << 20U;

constexpr std::array<std::pair<std::string_view, std::string_view>, 12> content_types{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".txt", "text/plain; charset=utf-8"},
    {".json", "application/json"},
    {".map", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".webp", "image/webp"},
    {".xml", "application/xml"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
}};

std::optional<std::string_view> known_content_type(const fs::path& path) {
  const std::string ending = path.extension().string();
  const auto* const found = std::find_if(content_types.begin(), content_types.end(),
                                         [&ending](const auto& entry) { return entry.first == ending; });
  return found == content_types.end() ? std::nullopt : std::optional(found->second);
}

std::string_view content_type_of(const fs::path& path) {
  const std::optional<std::string_view> type = known_content_type(path);
  if (!type) {
    throw InputError(path.string(), 0, "a file of another type",
                     "one of html, js, css, txt, json, map, svg, png, webp, xml, ico, woff2");
  }
  return *type;
}

}  // namespace

PageFiles::PageFiles(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder / "index.html", ignored)) {
    throw InputError(folder.string(), 0, "no file index.html", "the folder of the page");
  }
  std::uintmax_t total = 0;
  try {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      // A link could lead out of the folder.
      if (entry.is_symlink() || (!entry.is_regular_file() && !entry.is_directory())) {
        throw InputError(entry.path().string(), 0, "neither a file nor a folder", "one of these");
      }
      if (entry.is_directory()) {
        continue;
      }
      total += entry.file_size();
      if (total > max_total_bytes) {
        throw InputError(folder.string(), 0, "more than 64 MiB", "the folder of the page");
      }
      files_.emplace("/" + entry.path().lexically_relative(folder).generic_string(),
                     PageFile{content_type_of(entry.path()), read_whole_file(entry.path())});
    }
  } catch (const fs::filesystem_error& error) {
    throw FileError(error.path1(), error.code().message());
  }
}

DocumentFiles::DocumentFiles(const fs::path& folder, const std::string& below) {
  try {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && !entry.is_symlink()) {  // a link could lead out of the folder
        paths_.emplace(below + entry.path().lexically_relative(folder).generic_string(), entry.path());
      }
    }
  } catch (const fs::filesystem_error& error) {
    throw FileError(error.path1(), error.code().message());
  }
  if (const auto index = paths_.find(below + "index.html"); index != paths_.end()) {
    paths_.emplace(below, index->second);
  }
}

std::optional<PageFile> DocumentFiles::read(std::string_view path) const {
  const auto found = paths_.find(path);
  if (found == paths_.end()) {
    return std::nullopt;
  }
  try {
    return PageFile{known_content_type(found->second).value_or("application/octet-stream"),
                    read_whole_file(found->second)};
  } catch (const FileError&) {
    return std::nullopt;
  }
}

const PageFile* PageFiles::find(std::string_view path) const {
  const auto found = files_.find(path == "/" ? std::string_view("/index.html") : path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace proleg::host
