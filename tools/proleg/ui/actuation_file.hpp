#pragma once

// The values of the page and the files on disk: the operations file.diff, file.apply and file.save_as
// (docs/page-interface.md).

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "sim/authoring/actuation_edit.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The value of file.diff.
[[nodiscard]] nlohmann::json file_diff_json(const sim::Scenario& file, std::span<const sim::ActuationEdit> edits);

/// The edits that the arguments of file.apply choose. Throws InputError if they are for another list of edits.
[[nodiscard]] std::vector<sim::ActuationEdit> chosen_edits(const sim::Scenario& file,
                                                           std::span<const sim::ActuationEdit> edits,
                                                           const nlohmann::json& arguments);

/// Writes the edits into the scenario's actuation file, and returns the scenario as it is read from then on. Throws
/// InputError if the file ships with Proleg, is not as it was read or may not be written, FileError if it cannot be
/// written. Then it is as before.
[[nodiscard]] sim::Scenario write_actuation(const sim::Scenario& file, std::span<const sim::ActuationEdit> edits);

/// Copies all files of the scenario, with the edits, into a new folder, and returns the copy as it is read from there.
/// Throws InputError if the folder exists, FileError if it cannot be written; then there is no new folder.
[[nodiscard]] sim::Scenario write_copy(const sim::Scenario& file, std::span<const sim::ActuationEdit> edits,
                                       const std::filesystem::path& folder);

}  // namespace proleg::tools
