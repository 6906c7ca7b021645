#pragma once

// What elements of input devices are bound to, and bindings as JSON, in files and in messages (docs/page-interface.md).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace proleg::host {

/// What an element that is pressed can do, beside changing parameters.
enum class RemoteAction : std::uint8_t {
  run,
  pause,
  step,
  restart,
  stop,         ///< stops the robot, also without control
  hold_to_run,  ///< runs while it is pressed, and pauses when it is released
};

/// The name of an action in files, for example "hold_to_run".
[[nodiscard]] std::string_view name_of(RemoteAction action);
[[nodiscard]] std::optional<RemoteAction> action_of(std::string_view name);

/// Maps the position of an element linearly: from one end to the other it is a value from `lower` to `upper`.
struct ParameterBinding {
  std::vector<std::string> parameters;  ///< names as for --set, without a value: "amplitude", "1.amplitude:J2"
  double lower = 0;                     ///< value at position -1 (of a button: 0)
  double upper = 0;                     ///< value at position 1; below `lower`: the direction is reversed
  double step = 0;                      ///< values are whole steps from `lower`, and `upper`
  double dead_zone = 0;                 ///< positions of an axis this near the middle are the middle; 0 to 0.9
  double curve = 1;                     ///< exponent: above 1 it is finer in the middle; 0.2 to 5
  bool take_up = true;  ///< the element has no effect until it has passed the present value, so that nothing jumps
};

struct Binding {
  std::string device;  ///< name of the device; all devices of this name act alike
  std::string element;
  std::variant<ParameterBinding, RemoteAction> target;
};

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
