#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// The algorithms of the core, in the order of their ids, then those of users. index is below algorithm_count().
[[nodiscard]] std::size_t algorithm_count();
[[nodiscard]] const ActuationModule& algorithm_at(std::size_t index);

/// The algorithm of that name or id; null if there is none.
[[nodiscard]] const ActuationModule* find_algorithm(std::string_view name);
[[nodiscard]] const ActuationModule* find_algorithm(std::uint8_t id);

/// Adds algorithms to those that the program was built with: users' algorithms that a program on a computer has loaded.
/// Names and ids differ from all others. A later call replaces the list, which must outlive all use of the registry.
/// Call this before other threads use it.
void set_loaded_algorithms(std::span<const ActuationModule* const> algorithms);

}  // namespace proleg
