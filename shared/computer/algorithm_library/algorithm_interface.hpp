#pragma once

// The object that a library with a user's algorithm exports (docs/user-algorithms.md). tools/cmake/user_algorithm.cmake
// writes the source with this object. The library contains its own copy of the core's code, so a program takes from it
// only the object below and the algorithm that it names. The whole object is constant: a program checks it before it
// calls anything.

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/gait/actuation_module.hpp"
#include "shared/kernel/fingerprint.hpp"

namespace proleg {

/// Version of the interface. It changes when AlgorithmInterface, or the meaning of the arguments of an algorithm,
/// changes.
inline constexpr std::uint32_t algorithm_interface_version = 1;
/// Name of the exported object.
inline constexpr const char* algorithm_interface_symbol = "proleg_algorithm_interface";

/// A fact on which the program and the library must agree, whatever compilers have made them.
struct LayoutFact {
  const char* name;
  std::uint32_t value;
};
inline constexpr std::array algorithm_layout{
    LayoutFact{"bytes of a pointer", sizeof(void*)},
    LayoutFact{"bytes of ActuationModule", sizeof(ActuationModule)},
    LayoutFact{"bytes of Declaration", sizeof(Declaration)},
    LayoutFact{"bytes of Parameter", sizeof(Parameter)},
    LayoutFact{"bytes of InternalValue", sizeof(InternalValue)},
    LayoutFact{"bytes of FrameField", sizeof(FrameField)},
    LayoutFact{"bytes of JointContext", sizeof(JointContext)},
    LayoutFact{"bytes of Tuning", sizeof(Tuning)},
    LayoutFact{"bytes of Neighbour", sizeof(Neighbour)},
    LayoutFact{"bytes of Contacts", sizeof(Contacts)},
    LayoutFact{"bytes of JointReadings", sizeof(JointReadings)},
    LayoutFact{"bytes of Surroundings", sizeof(Surroundings)},
    LayoutFact{"bytes of StateFrame", sizeof(StateFrame)},
    LayoutFact{"bytes of Pcg32", sizeof(Pcg32)},
    LayoutFact{"parameters at most", max_parameters},
    LayoutFact{"derived constants at most", max_derived},
    LayoutFact{"internal values at most", max_internal_values},
};

struct AlgorithmInterface {
  /// The first three members are the same in all versions.
  std::array<char, 8> mark{'p', 'r', 'o', 'l', 'e', 'g', 'a', 'l'};
  std::uint32_t version = algorithm_interface_version;
  std::uint32_t size = sizeof(AlgorithmInterface);
  std::uint32_t core = core_fingerprint;  ///< fingerprint of the core whose headers and sources are in the library
  std::uint32_t sources;                  ///< Declaration::sources of the algorithm
  std::array<std::uint32_t, algorithm_layout.size()> layout;
  const ActuationModule& (*algorithm)();
};

/// The interface of an algorithm, as this compiler lays it out.
[[nodiscard]] constexpr AlgorithmInterface interface_of(std::uint32_t sources, const ActuationModule& (*algorithm)()) {
  AlgorithmInterface made{.sources = sources, .layout = {}, .algorithm = algorithm};
  for (std::size_t i = 0; i < algorithm_layout.size(); ++i) {
    made.layout[i] = algorithm_layout[i].value;
  }
  return made;
}

}  // namespace proleg
