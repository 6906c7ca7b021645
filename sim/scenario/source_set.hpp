#pragma once

// The files of a scenario: finds the files that a file names, keeps their text, and limits their number and size.

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/scenario/reader.hpp"
#include "sim/scenario/xml_document.hpp"

namespace proleg::sim {

class SourceSet {
 public:
  /// Adds every file to `record` once, in the order of reading.
  SourceSet(FileSource& files, std::filesystem::path top, std::vector<SourceFile>& record)
      : files_(&files), top_(std::move(top)), record_(&record) {}

  [[nodiscard]] std::unique_ptr<XmlDocument> open_top();

  /// The file that the element `mention` names. `reference` is relative to the folder of the file with the mention; if
  /// there is no such file, to the folder of the top-level file. Throws InputError for a file that includes itself,
  /// more than 32 levels, more than 1000 includes, and more than 64 MiB in all.
  [[nodiscard]] std::unique_ptr<XmlDocument> open(const XmlElement& mention, const std::string& reference);

 private:
  [[nodiscard]] const std::string* text_of(const std::filesystem::path& path);

  FileSource* files_;
  std::filesystem::path top_;
  std::vector<SourceFile>* record_;
  std::map<std::string, std::size_t> recorded_;  ///< name of a file: its position in the record
  std::size_t includes_ = 0;
  std::size_t parsed_bytes_ = 0;
};

}  // namespace proleg::sim
