#pragma once

// Where readers get their files from: a disk, texts that were read before or, in tests and fuzzers, memory.

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace proleg::sim {

class FileSource {
 public:
  virtual ~FileSource() = default;
  /// The text of a file, or nothing if it cannot be read.
  [[nodiscard]] virtual std::optional<std::string> read(const std::filesystem::path& path) = 0;
  /// What is at a path that cannot be read, for "found ...": "a folder". Nothing if nothing is there.
  [[nodiscard]] virtual std::optional<std::string> found_instead(const std::filesystem::path& /*path*/) { return {}; }
};

inline constexpr std::size_t max_file_bytes = std::size_t{16} << 20U;

/// Files on disk, at most max_file_bytes each. Reads regular files only: a device or a pipe might never end.
class DiskFiles final : public FileSource {
 public:
  [[nodiscard]] std::optional<std::string> read(const std::filesystem::path& path) override;
  [[nodiscard]] std::optional<std::string> found_instead(const std::filesystem::path& path) override;
};

/// Files as they were read before: the sources of a scenario or of a recording.
class SourceTexts final : public FileSource {
 public:
  void add(const std::filesystem::path& path, std::string text) {
    texts_.insert_or_assign(path.lexically_normal().string(), std::move(text));
  }
  [[nodiscard]] std::optional<std::string> read(const std::filesystem::path& path) override {
    const auto found = texts_.find(path.lexically_normal().string());
    return found == texts_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::map<std::string, std::string> texts_;
};

/// Bytes as text, for sources that are no text, such as a binary STL file: "data:application/octet-stream;base64,..."
/// (RFC 2397).
[[nodiscard]] std::string data_url(std::string_view bytes);

/// The bytes of a source: those of a text that data_url() made, otherwise the text itself.
[[nodiscard]] std::string bytes_of_source(const std::string& text);
/// Their number.
[[nodiscard]] std::size_t size_of_source(std::string_view text);

}  // namespace proleg::sim
