#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// Number of algorithms: those of the core, in the order of their ids, then those of users. An index is below it.
[[nodiscard]] std::size_t algorithm_count();
[[nodiscard]] const ActuationModule& algorithm_at(std::size_t index);

/// The algorithm with this name or id; null if it is absent.
[[nodiscard]] const ActuationModule* find_algorithm(std::string_view name);
[[nodiscard]] const ActuationModule* find_algorithm(std::uint8_t id);

/// Adds algorithms to those that the program was built with: users' algorithms that a program on a computer has loaded.
/// Their names and ids differ from all others. A later call replaces the list, which must outlive all use of the
/// registry. The call must come before other threads use the registry.
void set_loaded_algorithms(std::span<const ActuationModule* const> algorithms);

}  // namespace proleg
