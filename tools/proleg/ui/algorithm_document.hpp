#pragma once

// The documents about algorithms, and the form of a new one (docs/page-interface.md).

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "tools/proleg/new/algorithm_form.hpp"
#include "tools/proleg/ui/algorithm_folders.hpp"
#include "tools/proleg/ui/compiler_messages.hpp"

namespace proleg::tools {

/// The document `algorithms`: all that a scenario can name now. Parameters are as in the document `parameters`.
[[nodiscard]] nlohmann::json algorithms_json();

/// The form of a new algorithm: that of the example, with a free id and no name. Part of `algorithm_folders`.
[[nodiscard]] nlohmann::json example_form_json();

/// Reads a form. Throws InputError for a member of the wrong kind; check_form() judges the rest.
[[nodiscard]] AlgorithmForm read_form(const nlohmann::json& arguments);

/// The messages of a build, with the files of the algorithms by their names in their folders.
[[nodiscard]] nlohmann::json messages_json(std::span<const CompilerMessage> messages,
                                           std::span<const AlgorithmFolder> algorithms);

}  // namespace proleg::tools
