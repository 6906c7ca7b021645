#pragma once

// The files of a new algorithm: the one writer for `proleg new algorithm` and for the page.

#include <string>
#include <vector>

#include "tools/proleg/new/algorithm_form.hpp"
#include "tools/proleg/new/new_files.hpp"

namespace proleg::tools {

/// Throws InputError for a folder with characters that CMake treats specially. field: for the message.
void check_algorithm_folder(const std::string& folder, const std::string& field);

/// The files: one source with the declaration of the form, its test, CMakeLists.txt, README.md, and in robot/ the files
/// of a robot of five joints that it moves. The form must be one that check_form() accepts, but for the length of the
/// name. That of the example gives the shipped example. source_tree: the sources of Proleg, a checkout or those of an
/// installation.
[[nodiscard]] std::vector<sim::SourceFile> algorithm_files(const AlgorithmForm& form, const std::string& source_tree);

}  // namespace proleg::tools
