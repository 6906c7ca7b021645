#pragma once

#include <cstddef>
#include <string_view>

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// The algorithms of the core, in the order of their ids. index is below algorithm_count().
[[nodiscard]] std::size_t algorithm_count();
[[nodiscard]] const ActuationModule& algorithm_at(std::size_t index);

/// The algorithm of that name or id; null if there is none.
[[nodiscard]] const ActuationModule* find_algorithm(std::string_view name);
[[nodiscard]] const ActuationModule* find_algorithm(std::uint8_t id);

}  // namespace proleg
