#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/sensing_module.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { raise, reach, confirm, hold, rise_rate, fall_rate };
constexpr Parameter parameters[] = {
    Parameter{"raise", Unit::degree, raw(Unit::degree, 10), -quarter_turn, quarter_turn,
              "How far the joint lifts while the ground is uneven. Angle added to the joint; 0: no reflex."},
    Parameter{"reach", Unit::count, 2, 0, max_joints - 1,
              "How close together two links must touch the ground to mean uneven ground. Links from one to the other; "
              "0: no reflex."},
    Parameter{"confirm", Unit::count, 2, 1, 100,
              "How long that must last before the joint lifts. Consecutive ticks; the support passes from link to link "
              "in fewer."},
    Parameter{"hold", Unit::count, 100, 0, 60'000,
              "How long the joint stays lifted afterwards. Ticks after the last sign."},
    Parameter{"rise_rate", Unit::degree, raw(Unit::degree, 60), raw(Unit::degree, 1), quarter_turn,
              "How fast the joint lifts. Degrees in a second."},
    Parameter{"fall_rate", Unit::degree, raw(Unit::degree, 20), raw(Unit::degree, 1), quarter_turn,
              "How fast the joint comes down again. Degrees in a second."},
};

enum Values : std::uint8_t { offset, sign_ticks, hold_ticks };
constexpr InternalValue internal_values[] = {
    InternalValue{"offset", Unit::degree, 0, "angle of the reflex"},
    InternalValue{"sign_ticks", Unit::count, 0, "consecutive ticks with two such links; counts to `confirm`"},
    InternalValue{"hold_ticks", Unit::count, 0, "ticks that the reflex continues without a new sign"},
};

constexpr Declaration about{5,
                            "SensingModule_uneven_ground_reflex",
                            "bends the body upwards while the links find uneven ground",
                            parameters,
                            internal_values,
                            {}};

/// Whether two links touch that are at most `reach` links apart.
bool ground_is_uneven(const Contacts& contacts, std::int32_t reach) {
  std::int32_t distance = reach;  // distance from the last link that touches; at the start there is none
  for (unsigned link = 0; link < contacts.link_count(); ++link) {
    ++distance;
    if (contacts.pressed(link)) {
      if (distance <= reach) {
        return true;
      }
      distance = 0;
    }
  }
  return false;
}

class UnevenGroundReflex final : public SensingModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void derive(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    derived[rise_step] = step_of(values[rise_rate], context);
    derived[fall_step] = step_of(values[fall_rate], context);
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    return state[offset];
  }

 private:
  enum Derived : std::uint8_t { rise_step, fall_step };  // angle of a tick, for both

  /// Angle of a tick at this rate, 90 degrees = 2^30: at least 11930, at 1 degree in a second and ticks of 1 ms.
  static std::int32_t step_of(std::int32_t rate, const JointContext& context) {
    return static_cast<std::int32_t>(divide_nearest(std::int64_t{rate} * context.tick_period_us, 1'000'000));
  }

  void advance_sensing(const Contacts& contacts, const Surroundings& /*surroundings*/, const Tuning& tuning,
                       const std::int32_t* state, std::int32_t* next) const override {
    // The value is limited, because a parameter may have been lowered or a counter overwritten.
    const std::int32_t before = std::clamp<std::int32_t>(state[sign_ticks], 0, tuning.parameters[confirm] - 1);
    next[sign_ticks] = ground_is_uneven(contacts, tuning.parameters[reach]) ? before + 1 : 0;
    const bool sign = next[sign_ticks] == tuning.parameters[confirm];
    const std::int32_t left = std::clamp<std::int32_t>(state[hold_ticks], 0, tuning.parameters[hold]);
    if (sign || left > 0) {
      next[hold_ticks] = sign ? tuning.parameters[hold] : left - 1;
      next[offset] = step_towards(tuning.parameters[raise], state[offset], tuning.derived[rise_step]);
    } else {
      next[hold_ticks] = 0;
      next[offset] = step_towards(0, state[offset], tuning.derived[fall_step]);
    }
  }
};

constexpr UnevenGroundReflex instance;

}  // namespace

const ActuationModule& sensing_module_uneven_ground_reflex() { return instance; }

}  // namespace proleg
