#pragma once

// The files of a scenario: where they come from (a disk, texts that were read before or, in tests and fuzzers, memory);
// and the set of them that a reader finds through their names, whose texts it keeps and whose number and size it
// limits.

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/robot/triangle_mesh.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

/// Meshes of earlier reads of a scenario, for one that is read again and again while a person changes it: an import
/// takes up to a second.
class KnownMeshes {
 public:
  /// A file that an import has asked for, beside the mesh.
  struct Companion {
    std::filesystem::path path;
    std::optional<SharedText> text;  ///< nothing: it was not there
  };
  /// What was made of a file for a use and a scale.
  struct Made {
    std::shared_ptr<const TriangleMesh> mesh;
    std::vector<std::string> remarks;
    bool is_used = true;  ///< since forget_unused()
  };
  struct Import {
    SharedText source;  ///< text of the file
    std::vector<Companion> companions;
    std::shared_ptr<const TriangleMesh> mesh;  ///< in the unit of the file
    std::map<std::string, Made> made;          ///< by use and scale
    bool is_used = true;
  };

  /// By the name of the file.
  [[nodiscard]] std::map<std::string, Import>& imports() { return imports_; }
  /// Forgets what was not used since the last call.
  void forget_unused();

 private:
  std::map<std::string, Import> imports_;
};

/// Where readers get their files from.
class FileSource {
 public:
  virtual ~FileSource() = default;
  /// The text of a file, or nothing if it cannot be read.
  [[nodiscard]] virtual std::optional<SharedText> read(const std::filesystem::path& path) = 0;
  /// What is at a path that cannot be read, for "found ...": "a folder". Nothing if nothing is there.
  [[nodiscard]] virtual std::optional<std::string> found_instead(const std::filesystem::path& /*path*/) { return {}; }
  /// Where the reader keeps meshes for the next read; null: nowhere.
  [[nodiscard]] virtual KnownMeshes* known_meshes() { return nullptr; }
};

inline constexpr std::size_t max_file_bytes = std::size_t{16} << 20U;

/// Files on disk, at most `most_bytes` each. Reads regular files only: a device or a pipe might never end.
class DiskFiles final : public FileSource {
 public:
  explicit DiskFiles(std::size_t most_bytes = max_file_bytes) : most_bytes_(most_bytes) {}

  [[nodiscard]] std::optional<SharedText> read(const std::filesystem::path& path) override;
  [[nodiscard]] std::optional<std::string> found_instead(const std::filesystem::path& path) override;

 private:
  std::size_t most_bytes_;
};

/// Files as they were read before: the sources of a scenario or of a recording.
class SourceTexts final : public FileSource {
 public:
  void add(const std::filesystem::path& path, SharedText text) {
    texts_.insert_or_assign(path.lexically_normal().string(), std::move(text));
  }
  [[nodiscard]] std::optional<SharedText> read(const std::filesystem::path& path) override {
    const auto found = texts_.find(path.lexically_normal().string());
    return found == texts_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::map<std::string, SharedText> texts_;
};

/// Bytes as text, for sources that are no text, such as a binary STL file: "data:application/octet-stream;base64,..."
/// (RFC 2397).
[[nodiscard]] std::string data_url(std::string_view bytes);

/// A file of any bytes as recordings and documents keep it: its text; for what is no text, that of data_url().
[[nodiscard]] SharedText source_text(SharedText bytes);

/// The bytes of a text in base64 (RFC 4648) with "=" at its end; nothing for another text.
[[nodiscard]] std::optional<std::string> decode_base64(std::string_view text);

/// The bytes of a source: those of a text that data_url() made, otherwise the text itself.
[[nodiscard]] std::string bytes_of_source(const std::string& text);
/// Number of the bytes that bytes_of_source() would give.
[[nodiscard]] std::size_t size_of_source(std::string_view text);

/// The files of one scenario.
class SourceSet {
 public:
  /// Adds every file to `record` once, in the order of reading.
  SourceSet(FileSource& files, std::filesystem::path top, std::vector<SourceFile>& record)
      : files_(&files),
        top_(std::move(top)),
        record_(&record),
        meshes_(files.known_meshes() != nullptr ? files.known_meshes() : &own_meshes_) {}
  SourceSet(const SourceSet&) = delete;
  SourceSet& operator=(const SourceSet&) = delete;

  [[nodiscard]] std::unique_ptr<XmlDocument> open_top();

  /// The file that the element `mention` names. `reference` is relative to the folder of the file with the mention; if
  /// there is no such file, to the folder of the top-level file. Throws InputError for a file that includes itself,
  /// more than 32 levels, more than 1000 includes, and more than 64 MiB in all.
  [[nodiscard]] std::unique_ptr<XmlDocument> open(const XmlElement& mention, const std::string& reference);

  /// A file of any bytes, such as a mesh, that the element `mention` names as in open(). However often it is named, it
  /// counts once towards the limits.
  struct Bytes {
    std::filesystem::path path;
    SharedText source;  ///< bytes_of_source() gives its bytes
  };
  [[nodiscard]] Bytes find_bytes(const XmlElement& mention, const std::string& reference);
  /// Whether find_bytes() would find a file.
  [[nodiscard]] bool has(const XmlElement& mention, const std::string& reference);
  /// A file of any bytes beside another, for the element `mention`; nothing if it is not there. Counts as in
  /// find_bytes().
  [[nodiscard]] std::optional<std::string> companion(const XmlElement& mention, const std::filesystem::path& path);

  /// Meshes that were read, by file, scale and use: links that name the same file share one.
  [[nodiscard]] KnownMeshes& meshes() { return *meshes_; }

  /// Meshes in one colour, by the mesh and its red, green and blue: links share them, too.
  using PaintedMeshes = std::map<std::pair<std::shared_ptr<const TriangleMesh>, std::array<float, 3>>,
                                 std::shared_ptr<const TriangleMesh>>;
  [[nodiscard]] PaintedMeshes& painted_meshes() { return painted_meshes_; }

 private:
  struct Found {
    std::filesystem::path path;
    const SharedText* text;
  };

  enum class Contents { xml, any };

  /// Where a file may be that an element names.
  [[nodiscard]] std::array<std::filesystem::path, 2> paths_of(const XmlElement& mention,
                                                              const std::string& reference) const;
  [[nodiscard]] const SharedText* text_of(const std::filesystem::path& path, Contents contents);
  [[nodiscard]] Found find(const XmlElement& mention, const std::string& reference, Contents contents);
  void count_bytes(const XmlElement& mention, std::size_t bytes);
  /// Counts a file that is mentioned more than once only the first time.
  void count_once(const XmlElement& mention, const std::filesystem::path& path, std::size_t bytes);

  FileSource* files_;
  std::filesystem::path top_;
  std::vector<SourceFile>* record_;
  std::map<std::string, std::size_t> recorded_;  ///< name of a file: its position in the record
  std::set<std::string> counted_;                ///< names of files that count once
  KnownMeshes own_meshes_;
  KnownMeshes* meshes_;
  PaintedMeshes painted_meshes_;
  std::size_t includes_ = 0;
  std::size_t parsed_bytes_ = 0;
};

}  // namespace proleg::sim
