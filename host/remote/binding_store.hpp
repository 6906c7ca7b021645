#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/remote/binding.hpp"

namespace proleg::host {

/// The file of bindings beside a scenario.
class BindingStore {
 public:
  /// Makes the store of a robot without a scenario file, in which nothing can be saved.
  BindingStore() = default;
  /// Reads the file, which need not exist. Throws InputError if it is not a file of bindings, FileError if it cannot
  /// be read.
  explicit BindingStore(const std::filesystem::path& path);

  /// The path of the file; empty for a robot without a scenario file.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The bindings that the file had when it was read.
  [[nodiscard]] const std::vector<Binding>& read_bindings() const { return bindings_; }
  /// Whether the file has these bindings.
  [[nodiscard]] bool has(const std::vector<Binding>& bindings) const;
  /// Writes the whole file at once. Throws std::runtime_error with one line if there is no scenario, if another
  /// program has changed the file meanwhile, and after a disk error. The file is as before then.
  void save(const std::vector<Binding>& bindings);

 private:
  std::filesystem::path path_;
  std::vector<Binding> bindings_;
  std::optional<std::string>
      text_;  ///< text of the file when it was last read or written; nothing: the file does not exist
};

}  // namespace proleg::host
