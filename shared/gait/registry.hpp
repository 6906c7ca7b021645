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

/// Users' algorithms that a program on a computer has loaded.
using LoadedAlgorithms = std::span<const ActuationModule* const>;

/// Adds algorithms to those that the program was built with. Their names and ids differ from all others. Null: none. A
/// later call replaces the list, which must outlive all use of the registry, as must the algorithms of earlier lists.
/// Other threads may use the registry meanwhile if the new list is not shorter: an index stays valid.
void set_loaded_algorithms(const LoadedAlgorithms* algorithms);

}  // namespace proleg
