#pragma once

// Bindings as JSON, in files and in messages (docs/page-interface.md).

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/remote/binding.hpp"

namespace proleg::host {

inline constexpr std::size_t max_bindings = 64;
inline constexpr std::size_t max_binding_file_bytes = 1U << 20U;

/// Reads a binding. Throws InputError with the name `where` for a missing or unknown field, and for a value of another
/// type or outside its limits.
[[nodiscard]] Binding read_binding(const nlohmann::json& value, const std::string& where);
[[nodiscard]] nlohmann::json binding_json(const Binding& binding);

/// Reads the text of a file. Throws InputError with the name `file`, and with the line where the text is not JSON.
[[nodiscard]] std::vector<Binding> read_bindings(std::string_view text, const std::string& file);
[[nodiscard]] std::string bindings_text(const std::vector<Binding>& bindings);

/// The file of bindings beside a scenario: robot.remote.json for robot.simulation.xml.
[[nodiscard]] std::filesystem::path binding_file_of(const std::filesystem::path& scenario);

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
