#pragma once

#include <string>
#include <string_view>

#include "host/flash/bare_commands.hpp"

namespace proleg::host {

/// What a person can do about a step (bare_steps()) whose program is not installed: one line.
[[nodiscard]] std::string missing_program(const std::string& program);

/// The same for a program that has failed. output: all that it has printed.
[[nodiscard]] std::string bare_failure(const BarePlan& plan, const BareStep& step, std::string_view output);

/// The same for a result that is not what was written.
[[nodiscard]] std::string bare_difference(const BareStep& step);

}  // namespace proleg::host
