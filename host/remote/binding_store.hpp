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
  /// A robot without a scenario file: nothing can be saved.
  BindingStore() = default;
  /// Throws InputError for a file that is no such file, FileError if it cannot be read. It need not exist.
  explicit BindingStore(const std::filesystem::path& path);

  /// Empty: there is none.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// As the file had them when it was read.
  [[nodiscard]] const std::vector<Binding>& read_bindings() const { return bindings_; }
  /// Whether the file has these bindings.
  [[nodiscard]] bool has(const std::vector<Binding>& bindings) const;
  /// Writes the whole file at once. Throws std::runtime_error with one line: no scenario, a file that somebody else has
  /// changed meanwhile, a disk error. Then the file is as before.
  void save(const std::vector<Binding>& bindings);

 private:
  std::filesystem::path path_;
  std::vector<Binding> bindings_;
  std::optional<std::string> text_;  ///< of the file, as known; nothing: it does not exist
};

}  // namespace proleg::host
