#include "shared/gait/registry.hpp"

#include <atomic>
#include <iterator>

#include "shared/gait/algorithms.hpp"

namespace proleg {
namespace {

// The table has functions and not objects, so that it is a constant in flash and no code has to run before main().
constexpr const ActuationModule& (*algorithms[])() = {direct_joint_access,
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
                                                      sensing_module_global_adaptive_touch,
                                                      pattern_generator_head_stimulus,
                                                      sensing_module_gait_selector,
#ifdef PROLEG_USER_ALGORITHMS  // functions of users' algorithms, each with a comma
                                                      PROLEG_USER_ALGORITHMS
#endif
};

/// The list of set_loaded_algorithms(). It is empty in a module, where nothing calls that function.
constinit std::atomic<const LoadedAlgorithms*> loaded_list = nullptr;

LoadedAlgorithms loaded_algorithms() {
  const LoadedAlgorithms* const list = loaded_list.load(std::memory_order_acquire);
  return list == nullptr ? LoadedAlgorithms() : *list;
}

}  // namespace

std::size_t algorithm_count() { return std::size(algorithms) + loaded_algorithms().size(); }

const ActuationModule& algorithm_at(std::size_t index) {
  return index < std::size(algorithms) ? algorithms[index]() : *loaded_algorithms()[index - std::size(algorithms)];
}

const ActuationModule* find_algorithm(std::string_view name) {
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    if (algorithm_at(i).declaration().name == name) {
      return &algorithm_at(i);
    }
  }
  return nullptr;
}

const ActuationModule* find_algorithm(std::uint8_t id) {
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    if (algorithm_at(i).declaration().id == id) {
      return &algorithm_at(i);
    }
  }
  return nullptr;
}

void set_loaded_algorithms(const LoadedAlgorithms* algorithms_of_users) {
  loaded_list.store(algorithms_of_users, std::memory_order_release);
}

}  // namespace proleg
