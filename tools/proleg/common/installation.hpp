#pragma once

// Where the programs find what ships with them. A program is in build/PRESET/bin of the checkout in which it was built,
// or in lib/proleg/bin below the prefix of an installation (docs/installing.md). The prefix may be moved as a whole.

#include <filesystem>
#include <optional>
#include <string>

namespace proleg::tools {

/// The folder of this program; empty if the kernel does not name it.
[[nodiscard]] std::filesystem::path program_folder();

/// Whether the file of this program was replaced or removed since it has started, as by an update.
[[nodiscard]] bool is_program_replaced();

/// The sources from which users' algorithms and images are built: `given`, or if that is empty, src/proleg of the
/// installation or the checkout in which this program was built. Throws BadInput, which says how to get them, if they
/// are not there, or if the installed ones are not those of this program.
[[nodiscard]] std::filesystem::path source_tree(const std::string& given);

/// Whether a folder has these sources: a checkout, or src/proleg of an installation.
[[nodiscard]] bool is_source_tree(const std::filesystem::path& folder);

/// The scenarios that ship with Proleg: sim/scenarios of the checkout, or share/proleg/scenarios. Nothing if there is
/// no such folder.
[[nodiscard]] std::optional<std::filesystem::path> shipped_folder();

/// Whether a file is one of the scenarios that ship with Proleg, those of any checkout among them. The programs do not
/// write them: the figures of the tests and of the documents hold for them as they are.
[[nodiscard]] bool is_shipped(const std::filesystem::path& file);

/// The folder with a page: `folder` in build of the checkout, or in share/proleg. Throws BadInput if it lacks the file.
[[nodiscard]] std::filesystem::path folder_of_page(const std::string& folder, const std::string& file);

/// The folder with the documentation as a site: build/docs/site of the checkout, or share/doc/proleg/html. Nothing if
/// it was not made.
[[nodiscard]] std::optional<std::filesystem::path> documentation_folder();

/// The folder with the images of the reference board, and a folder in it for each other board: that of the preset
/// stm32f405 beside the build of this program, or share/proleg/images. It may not exist.
[[nodiscard]] std::filesystem::path image_folder();

}  // namespace proleg::tools
