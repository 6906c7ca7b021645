#pragma once

// Bindings as JSON, in files and in messages (docs/page-interface.md).

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
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

}  // namespace proleg::host
