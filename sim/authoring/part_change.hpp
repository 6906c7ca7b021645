#pragma once

// Takes the robot, the actuation or the environment of another scenario into a draft.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "sim/authoring/draft.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What a top-level file names.
enum class ScenarioPart : std::uint8_t { robot, actuation, environment };

/// The tag in the top-level file.
[[nodiscard]] std::string_view tag_of(ScenarioPart part);
[[nodiscard]] std::optional<ScenarioPart> part_named(std::string_view tag);

/// Adds copies of the files of a part to the draft, beside its top-level file, with the folders that they have below
/// their common one; if other files have these names, in a folder of their own. The draft then uses the part. Files
/// that a file names relative to the folder of the other scenario's top-level file are not found; the reader says so.
/// scenario: of the draft, before the change.
void take_part(DraftChange& change, const Scenario& scenario, const Scenario& other, ScenarioPart part);

/// In normal form.
[[nodiscard]] std::filesystem::path absolute_path(const std::filesystem::path& path);

/// The deepest folder that has all files, of which there is at least one.
[[nodiscard]] std::filesystem::path common_folder(std::span<const SourceFile> files);

}  // namespace proleg::sim
