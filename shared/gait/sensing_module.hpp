#pragma once

#include <cstdint>

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// The value a tick later, if it moves towards the target by at most `step`, which is not negative.
[[nodiscard]] inline std::int32_t step_towards(std::int32_t target, std::int32_t value, std::int32_t step) {
  const std::int64_t distance = std::int64_t{target} - value;
  // This form takes fewer instructions than a clamp of the distance in 64 bits.
  if (distance > step) {
    return value + step;
  }
  return distance < -std::int64_t{step} ? value - step : target;
}

/// An algorithm that reacts to touch (thesis, section 5.2.1 and listing A.3). In each tick it receives the contacts of
/// all links, its own included, all of the same age.
class SensingModule : public ActuationModule {
 public:
  [[nodiscard]] bool senses_contacts() const final { return true; }
  void advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
               std::int32_t* next) const final {
    advance_sensing(surroundings.contacts, surroundings, tuning, state, next);
  }

 protected:
  ~SensingModule() = default;

 private:
  virtual void advance_sensing(const Contacts& contacts, const Surroundings& surroundings, const Tuning& tuning,
                               const std::int32_t* state, std::int32_t* next) const = 0;
};

}  // namespace proleg
