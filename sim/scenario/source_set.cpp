#include "sim/scenario/source_set.hpp"

#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t most_file_bytes = std::size_t{16} << 20U;
constexpr std::size_t most_bytes = std::size_t{64} << 20U;
constexpr std::size_t most_includes = 1000;
constexpr int deepest_include = 32;
constexpr std::size_t longest_path = 4096;

constexpr const char* readable_file = "a readable file of at most 16 MiB";

}  // namespace

std::optional<std::string> DiskFiles::read(const std::filesystem::path& path) {
  // Only regular files: a device or a pipe might never end.
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return std::nullopt;
  }
  if (const auto size = std::filesystem::file_size(path, error); error || size > most_file_bytes) {
    return std::nullopt;
  }
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  if (stream.peek() != std::ifstream::traits_type::eof()) {
    text << stream.rdbuf();
  }
  if (stream.bad() || !stream.is_open()) {
    return std::nullopt;
  }
  return std::move(text).str();
}

const std::string* SourceSet::text_of(const std::filesystem::path& path) {
  const std::string name = name_of(path);
  if (const auto known = recorded_.find(name); known != recorded_.end()) {
    return &(*record_)[known->second].text;
  }
  std::optional<std::string> text = files_->read(path);
  if (!text || text->size() > most_file_bytes) {
    return nullptr;
  }
  recorded_.emplace(name, record_->size());
  record_->push_back({name, std::move(*text)});
  return &record_->back().text;
}

std::unique_ptr<XmlDocument> SourceSet::open_top() {
  const std::string* const text = text_of(top_);
  if (text == nullptr) {
    throw InputError(name_of(top_), 0, "no such file, or not a readable one", readable_file);
  }
  parsed_bytes_ += text->size();
  return std::make_unique<XmlDocument>(top_, *text, nullptr);
}

std::unique_ptr<XmlDocument> SourceSet::open(const XmlElement& mention, const std::string& reference) {
  if (reference.empty() || reference.size() > longest_path) {
    mention.refuse(
        reference.empty() ? "an empty path" : "a path of " + std::to_string(reference.size()) + " characters",
        "a path of 1 to " + std::to_string(longest_path) + " characters");
  }
  const XmlDocument& including = mention.document();
  std::filesystem::path path = including.path().parent_path() / reference;
  const std::string* text = text_of(path);
  if (text == nullptr) {
    path = top_.parent_path() / reference;
    text = text_of(path);
  }
  if (text == nullptr) {
    mention.refuse("no such file " + in_quotes(reference),
                   std::string(readable_file) + ", named from the folder of this file or of the top-level file");
  }

  int depth = 0;
  const std::string name = name_of(path);
  for (const XmlDocument* file = &including; file != nullptr; file = file->includer(), ++depth) {
    if (file->name() == name) {
      mention.refuse("a cycle: " + in_quotes(reference) + " includes itself", "files that do not include themselves");
    }
  }
  if (depth > deepest_include) {
    mention.refuse("files nested deeper than " + std::to_string(deepest_include), "at most that");
  }
  parsed_bytes_ += text->size();
  if (++includes_ > most_includes || parsed_bytes_ > most_bytes) {
    mention.refuse("more than " + std::to_string(most_includes) + " included files or 64 MiB", "at most that in all");
  }
  return std::make_unique<XmlDocument>(std::move(path), *text, &including);
}

}  // namespace proleg::sim
