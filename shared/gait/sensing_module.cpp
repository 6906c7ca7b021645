#include "shared/gait/sensing_module.hpp"

namespace proleg {

void SensingModule::advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                            std::int32_t* next) const {
  advance_sensing(surroundings.contacts, surroundings, tuning, state, next);
}

}  // namespace proleg
