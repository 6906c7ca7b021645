#pragma once

#include <string>
#include <string_view>

#include "host/flash/bare_commands.hpp"

namespace proleg::host {

/// One line that says what a person can do about a step (bare_steps()) whose program is not installed.
[[nodiscard]] std::string missing_program(const std::string& program);

/// One line that says what a person can do about a step whose program has failed. output: all text that it has
/// printed.
[[nodiscard]] std::string bare_failure(const BarePlan& plan, const BareStep& step, std::string_view output);

/// One line that says what a person can do about a step whose result differs from the bytes that were written.
[[nodiscard]] std::string bare_difference(const BareStep& step);

}  // namespace proleg::host
