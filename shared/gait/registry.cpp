#include "shared/gait/registry.hpp"

#include <iterator>

#include "shared/gait/algorithms.hpp"

namespace proleg {
namespace {

// Functions and not objects, so that the table is a constant in flash and nothing has to run before main.
constexpr const ActuationModule& (*algorithms[])() = {
    direct_joint_access,
    pattern_generator_sinusoidal,
    pattern_generator_sinusoidal_extended,
    pattern_generator_coupled_oscillator,
    sensing_module_uneven_ground_reflex,
    pattern_generator_serpenoid,
    pattern_generator_compound_serpenoid,
    pattern_generator_hopf,
    pattern_generator_matsuoka,
    pattern_generator_half_centre,
    pattern_generator_push_pull,
    pattern_generator_mtran,
    pattern_generator_asymmetric_wave,
};

}  // namespace

std::size_t algorithm_count() { return std::size(algorithms); }

const ActuationModule& algorithm_at(std::size_t index) { return algorithms[index](); }

const ActuationModule* find_algorithm(std::string_view name) {
  for (const auto algorithm : algorithms) {
    if (algorithm().declaration().name == name) {
      return &algorithm();
    }
  }
  return nullptr;
}

const ActuationModule* find_algorithm(std::uint8_t id) {
  for (const auto algorithm : algorithms) {
    if (algorithm().declaration().id == id) {
      return &algorithm();
    }
  }
  return nullptr;
}

}  // namespace proleg
