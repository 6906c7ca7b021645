#include "sim/scenario/source_set.hpp"

#include <optional>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/file_source.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t max_bytes = std::size_t{64} << 20U;
constexpr std::size_t max_includes = 1000;
constexpr int max_include_depth = 32;
constexpr std::size_t max_path_size = 4096;

constexpr const char* readable_file = "a readable file of at most 16 MiB";

}  // namespace

const std::string* SourceSet::text_of(const std::filesystem::path& path, Contents contents) {
  const std::string name = name_of(path);
  if (const auto known = recorded_.find(name); known != recorded_.end()) {
    return &(*record_)[known->second].text;
  }
  std::optional<std::string> text = files_->read(path);
  if (!text || size_of_source(*text) > max_file_bytes) {
    return nullptr;
  }
  recorded_.emplace(name, record_->size());
  // Recordings and documents keep sources as text.
  if (contents == Contents::any && (find_invalid_utf8(*text) || text->find('\0') != std::string::npos)) {
    text = data_url(*text);
  }
  record_->push_back({name, std::move(*text)});
  return &record_->back().text;
}

std::unique_ptr<XmlDocument> SourceSet::open_top() {
  const std::string* const text = text_of(top_, Contents::xml);
  if (text == nullptr) {
    throw InputError(name_of(top_), 0, files_->found_instead(top_).value_or("no file that can be read"), readable_file);
  }
  parsed_bytes_ += text->size();
  return std::make_unique<XmlDocument>(top_, *text, nullptr);
}

SourceSet::Found SourceSet::find(const XmlElement& mention, const std::string& reference, Contents contents) {
  if (reference.empty() || reference.size() > max_path_size) {
    mention.refuse(
        reference.empty() ? "an empty path" : "a path of " + std::to_string(reference.size()) + " characters",
        "a path of 1 to " + std::to_string(max_path_size) + " characters");
  }
  std::optional<std::string> instead;
  for (const std::filesystem::path& base : {mention.document().path(), top_}) {
    std::filesystem::path path = base.parent_path() / reference;
    if (const std::string* const text = text_of(path, contents)) {
      return {std::move(path), text};
    }
    instead = instead ? instead : files_->found_instead(path);
  }
  mention.refuse((instead ? *instead + " at the path " : std::string("no such file ")) + in_quotes(reference),
                 readable_file + std::string(", relative to the folder of this file or of the top-level file"));
}

void SourceSet::count_bytes(const XmlElement& mention, std::size_t bytes) {
  parsed_bytes_ += bytes;
  if (++includes_ > max_includes || parsed_bytes_ > max_bytes) {
    mention.refuse("more than " + std::to_string(max_includes) + " included files or 64 MiB",
                   "at most that for all files of a scenario");
  }
}

void SourceSet::count_once(const XmlElement& mention, const std::filesystem::path& path, std::size_t bytes) {
  if (counted_.insert(name_of(path)).second) {
    count_bytes(mention, bytes);
  }
}

SourceSet::Bytes SourceSet::find_bytes(const XmlElement& mention, const std::string& reference) {
  Found found = find(mention, reference, Contents::any);
  count_once(mention, found.path, found.text->size());
  return {std::move(found.path), found.text};
}

std::optional<std::string> SourceSet::companion(const XmlElement& mention, const std::filesystem::path& path) {
  const std::string* const text = text_of(path, Contents::any);
  if (text == nullptr) {
    return std::nullopt;
  }
  count_once(mention, path, text->size());
  return bytes_of_source(*text);
}

std::unique_ptr<XmlDocument> SourceSet::open(const XmlElement& mention, const std::string& reference) {
  auto [path, text] = find(mention, reference, Contents::xml);
  const XmlDocument& including = mention.document();
  int depth = 0;
  const std::string name = name_of(path);
  for (const XmlDocument* file = &including; file != nullptr; file = file->includer(), ++depth) {
    if (file->name() == name) {
      mention.refuse("a cycle: " + in_quotes(reference) + " includes itself", "files that do not include themselves");
    }
  }
  if (depth > max_include_depth) {
    mention.refuse("files nested deeper than " + std::to_string(max_include_depth),
                   "at most " + std::to_string(max_include_depth) + " levels");
  }
  count_bytes(mention, text->size());
  return std::make_unique<XmlDocument>(std::move(path), *text, &including);
}

}  // namespace proleg::sim
