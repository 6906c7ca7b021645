#pragma once

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// An algorithm that reacts to touch (thesis, section 5.2.1 and listing A.3). In each tick it receives the contacts of
/// all links, its own included, all of the same age.
class SensingModule : public ActuationModule {
 public:
  [[nodiscard]] bool senses_contacts() const final { return true; }
  void advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
               std::int32_t* next) const final;

 protected:
  ~SensingModule() = default;

 private:
  virtual void advance_sensing(const Contacts& contacts, const Surroundings& surroundings, const Tuning& tuning,
                               const std::int32_t* state, std::int32_t* next) const = 0;
};

}  // namespace proleg
