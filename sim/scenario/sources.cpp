#include "sim/scenario/sources.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr std::string_view head = "data:application/octet-stream;base64,";
constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr unsigned digit_bits = 6;
constexpr std::uint8_t no_digit = 0xFF;
constexpr std::size_t group_digits = 4;
constexpr std::size_t group_bytes = 3;

constexpr std::size_t max_bytes = std::size_t{64} << 20U;
constexpr std::size_t max_includes = 1000;
constexpr int max_include_depth = 32;
constexpr std::size_t max_path_size = 4096;

constexpr const char* readable_file = "a readable file of at most 16 MiB";

}  // namespace

void KnownMeshes::forget_unused() {
  const auto forget = [](auto& known) {
    std::erase_if(known, [](const auto& entry) { return !entry.second.is_used; });
    for (auto& [key, entry] : known) {
      entry.is_used = false;
    }
  };
  forget(imports_);
  for (auto& [name, import] : imports_) {
    forget(import.made);
  }
}

std::optional<SharedText> DiskFiles::read(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return std::nullopt;
  }
  if (const auto size = std::filesystem::file_size(path, error); error || size > most_bytes_) {
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

std::optional<std::string> DiskFiles::found_instead(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return std::nullopt;
  }
  if (const std::optional<std::string> found = found_instead_of_file(path)) {
    return found;
  }
  constexpr std::uintmax_t mebibyte = 1U << 20U;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return !error && size > most_bytes_ ? "a file of " + std::to_string((size + mebibyte - 1) / mebibyte) + " MiB"
                                      : "a file that cannot be read";
}

std::string data_url(std::string_view bytes) {
  std::string text(head);
  text.reserve(head.size() + (bytes.size() / group_bytes + 1) * group_digits);
  for (std::size_t at = 0; at < bytes.size(); at += group_bytes) {
    const std::string_view group = bytes.substr(at, group_bytes);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < group_bytes; ++i) {
      bits = bits << 8U | (i < group.size() ? static_cast<std::uint8_t>(group[i]) : 0U);
    }
    for (std::size_t i = 0; i < group_digits; ++i) {
      const auto shift = static_cast<unsigned>(group_digits - 1 - i) * digit_bits;
      text += i <= group.size() ? digits[bits >> shift & 63U] : '=';
    }
  }
  return text;
}

SharedText source_text(SharedText bytes) {
  const std::string& text = bytes;
  if (text.starts_with(head)) {
    return bytes;  // it is one already
  }
  return find_invalid_utf8(text) || text.find('\0') != std::string::npos ? SharedText(data_url(text)) : bytes;
}

std::optional<std::string> decode_base64(std::string_view text) {
  static const std::array<std::uint8_t, 256> values = [] {
    std::array<std::uint8_t, 256> table{};
    table.fill(no_digit);
    for (std::size_t i = 0; i < digits.size(); ++i) {
      table.at(static_cast<std::uint8_t>(digits[i])) = static_cast<std::uint8_t>(i);
    }
    return table;
  }();
  if (text.size() % group_digits != 0) {
    return std::nullopt;
  }
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
  std::string bytes;
  bytes.reserve(text.size() / group_digits * group_bytes);
  std::uint32_t bits = 0;
  unsigned count = 0;
  for (const char character : text.substr(0, text.size() - padding)) {
    const std::uint8_t digit = values.at(static_cast<std::uint8_t>(character));
    if (digit == no_digit) {
      return std::nullopt;
    }
    bits = bits << digit_bits | digit;
    count += digit_bits;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 0xFFU);
    }
  }
  return bytes;
}

std::string bytes_of_source(const std::string& text) {
  return text.starts_with(head) ? decode_base64(std::string_view(text).substr(head.size())).value_or("") : text;
}

std::size_t size_of_source(std::string_view text) {
  if (!text.starts_with(head)) {
    return text.size();
  }
  const std::string_view encoded = text.substr(head.size());
  return std::min(encoded.size(), encoded.find('=')) * group_bytes / group_digits;
}

const SharedText* SourceSet::text_of(const std::filesystem::path& path, Contents contents) {
  const std::string name = name_of(path);
  if (const auto known = recorded_.find(name); known != recorded_.end()) {
    return &(*record_)[known->second].text;
  }
  std::optional<SharedText> text = files_->read(path);
  if (!text || size_of_source(*text) > max_file_bytes) {
    return nullptr;
  }
  recorded_.emplace(name, record_->size());
  if (contents == Contents::any) {
    text = source_text(std::move(*text));
  }
  record_->push_back({name, std::move(*text)});
  return &record_->back().text;
}

std::unique_ptr<XmlDocument> SourceSet::open_top() {
  const SharedText* const text = text_of(top_, Contents::xml);
  if (text == nullptr) {
    throw InputError(name_of(top_), 0, files_->found_instead(top_).value_or("no file that can be read"), readable_file);
  }
  parsed_bytes_ += text->size();
  return std::make_unique<XmlDocument>(top_, *text, nullptr);
}

std::array<std::filesystem::path, 2> SourceSet::paths_of(const XmlElement& mention,
                                                         const std::string& reference) const {
  return {mention.document().path().parent_path() / reference, top_.parent_path() / reference};
}

bool SourceSet::has(const XmlElement& mention, const std::string& reference) {
  const auto is_file = [&](const std::filesystem::path& path) {
    return recorded_.contains(name_of(path)) || files_->read(path).has_value();
  };
  return !reference.empty() && reference.size() <= max_path_size &&
         std::ranges::any_of(paths_of(mention, reference), is_file);
}

SourceSet::Found SourceSet::find(const XmlElement& mention, const std::string& reference, Contents contents) {
  if (reference.empty() || reference.size() > max_path_size) {
    mention.refuse(
        reference.empty() ? "an empty path" : "a path of " + std::to_string(reference.size()) + " characters",
        "a path of 1 to " + std::to_string(max_path_size) + " characters");
  }
  std::optional<std::string> instead;
  for (std::filesystem::path& path : paths_of(mention, reference)) {
    if (const SharedText* const text = text_of(path, contents)) {
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
  return {std::move(found.path), *found.text};
}

std::optional<std::string> SourceSet::companion(const XmlElement& mention, const std::filesystem::path& path) {
  const SharedText* const text = text_of(path, Contents::any);
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
