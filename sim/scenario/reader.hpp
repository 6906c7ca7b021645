#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Where the reader gets its files from; the tests and the fuzzer give it files in memory.
class FileSource {
 public:
  virtual ~FileSource() = default;
  /// The text of a file, or nothing if it cannot be read.
  [[nodiscard]] virtual std::optional<std::string> read(const std::filesystem::path& path) = 0;
};

/// Files on disk, at most 16 MiB each.
class DiskFiles final : public FileSource {
 public:
  [[nodiscard]] std::optional<std::string> read(const std::filesystem::path& path) override;
};

/// Reads a top-level simulation file and all that it names. Throws InputError.
[[nodiscard]] Scenario read_scenario(const std::filesystem::path& path, FileSource& files);

/// Applies a `--set NAME=VALUE[@TICK]` word to a scenario. Throws InputError with the word as its file.
void apply_setting(Scenario& scenario, const std::string& word);

}  // namespace proleg::sim
