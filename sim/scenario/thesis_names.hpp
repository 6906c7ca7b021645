#pragma once

// The names that files of the 2013 thesis have for algorithms and parameters, beside those that Proleg declares. As in
// tags, capital letters make no difference in them.

#include <string_view>

#include "shared/gait/actuation_module.hpp"

namespace proleg::sim {

/// The algorithm that Proleg or the thesis calls so ("Global Adaptive Touch", listing B.7); null if there is none.
[[nodiscard]] const ActuationModule* find_named_algorithm(std::string_view name);

/// Position of the parameter that Proleg or the thesis calls so ("Get-stuck-threshold", "back to zero constant",
/// "Constant 1"), or -1.
[[nodiscard]] int find_named_parameter(const Declaration& declaration, std::string_view name);

}  // namespace proleg::sim
