#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/sensing_module.hpp"

namespace proleg {
namespace {

/// Number of constants of the thesis: first four that raise, then four that lower. In each four, the touch of the links
/// at the joint selects one.
constexpr unsigned constant_count = 8;
constexpr unsigned touch_states = 4;

enum Parameters : std::uint8_t {
  stuck_threshold,
  recovering,
  first_constant,
  max_offset = first_constant + constant_count,
  give_up
};

constexpr std::int32_t greatest_constant = raw(Unit::degree, 45);

constexpr Parameter constant(ParameterName name, HostText help) {
  return {name, Unit::degree, raw(Unit::degree, 1), 0, greatest_constant, help};
}

constexpr Parameter parameters[] = {
    Parameter{"stuck_threshold", Unit::count, 150, 1, 10'000,
              "How long nothing may change before the joint counts as stuck. ms without a change of touch at the four "
              "links around it."},
    Parameter{"recovering", Unit::degree, raw(Unit::degree, 3, 10), 0, greatest_constant,
              "How fast the joint goes back when it is free. Degrees in 10 ms by which the offset returns to 0."},
    constant("constant_1", "How fast a stuck joint bends up if neither link at it touches. Degrees in 10 ms."),
    constant("constant_2", "How fast a stuck joint bends up if only the link behind it touches. Degrees in 10 ms."),
    constant("constant_3",
             "How fast a stuck joint bends up if only the link in front of it touches. Degrees in 10 ms."),
    constant("constant_4", "How fast a stuck joint bends up if both links at it touch. Degrees in 10 ms."),
    constant("constant_5", "How fast a stuck joint bends down if neither link at it touches. Degrees in 10 ms."),
    constant("constant_6", "How fast a stuck joint bends down if only the link behind it touches. Degrees in 10 ms."),
    constant("constant_7",
             "How fast a stuck joint bends down if only the link in front of it touches. Degrees in 10 ms."),
    constant("constant_8", "How fast a stuck joint bends down if both links at it touch. Degrees in 10 ms."),
    Parameter{"max_offset", Unit::degree, raw(Unit::degree, 45), 0, quarter_turn,
              "How far the joint may bend to get free. Largest offset, upwards or downwards; 0: no reflex."},
    Parameter{
        "give_up", Unit::count, 10'000, 1, 600'000,
        "How long the joint tries before it gives up. ms without a change of touch; its sensors may have failed."},
};
static_assert(std::size(parameters) == give_up + 1U);

enum Values : std::uint8_t { offset, links_touched, still_ticks };
constexpr InternalValue internal_values[] = {
    InternalValue{"offset", Unit::degree, 0, "angle of the reflex"},
    InternalValue{"links_touched", Unit::count, 0,
                  "touch of the four links around the joint; 1: the foremost, 2, 4, 8: the rearmost"},
    InternalValue{"still_ticks", Unit::count, 0, "ticks since this touch changed"},
};

constexpr Declaration about{14,
                            "SensingModule_global_adaptive_touch",
                            "bends stuck joints until the links around them touch differently",
                            parameters,
                            internal_values,
                            {}};

/// A number of ticks greater than any parameter asks for.
constexpr std::int32_t most_still_ticks = 1 << 20;

/// The links around a joint.
enum Around : std::uint8_t { second_in_front, in_front, behind, second_behind, link_count };

/// The set of links around a joint that touch, one bit for each.
unsigned touch_around(const Contacts& contacts, unsigned joint) {
  unsigned touched = 0;
  for (unsigned place = joint == 0 ? 1 : 0; place < link_count; ++place) {
    touched |= static_cast<unsigned>(contacts.pressed(joint + place - in_front)) << place;
  }
  return touched;
}

bool any_link_touches(const Contacts& contacts) {
  for (unsigned link = 0; link < contacts.link_count(); ++link) {
    if (contacts.pressed(link)) {
      return true;
    }
  }
  return false;
}

class GlobalAdaptiveTouch final : public SensingModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void derive(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    derived[threshold_ticks] = ticks_of(values[stuck_threshold], context);
    derived[give_up_ticks] = ticks_of(values[give_up], context);
    constexpr std::int64_t period_of_constants_us = 10'000;
    derived[tick_scale] = static_cast<std::int32_t>(
        divide_nearest(std::int64_t{context.tick_period_us} << scale_bits, period_of_constants_us));
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    return state[offset];
  }

 private:
  enum Derived : std::uint8_t { threshold_ticks, give_up_ticks, tick_scale };
  static constexpr unsigned scale_bits = 24;

  /// Number of ticks in this time: at least 1, at most 600,000.
  static std::int32_t ticks_of(std::int32_t milliseconds, const JointContext& context) {
    const std::int64_t ticks = divide_nearest(std::int64_t{milliseconds} * 1'000, std::int64_t{context.tick_period_us});
    return static_cast<std::int32_t>(std::max<std::int64_t>(ticks, 1));
  }

  /// The constant, an angle per 10 ms, as an angle per tick.
  static std::int32_t step_of(const Tuning& tuning, unsigned parameter) {
    return saturate(
        shift_right_rounding(multiply_wide(tuning.parameters[parameter], tuning.derived[tick_scale]), scale_bits));
  }

  /// Whether a stuck joint bends up. The links at the joint search the ground where the others have it: up if the outer
  /// links touch more than those at the joint, down if they touch less. Without a difference the joint bends further to
  /// the side to which the gait bends it, which lifts a wave that is blocked.
  static bool bends_up(unsigned touched, const Surroundings& surroundings, std::int32_t gait) {
    const unsigned joint = surroundings.context.joint;
    const auto touches = [&](Around place) { return static_cast<int>((touched >> place) & 1U); };
    const int inner = touches(in_front) + touches(behind);
    const bool has_first = joint > 0;
    const bool has_last = joint + 1U < surroundings.context.joint_count;
    int outer = touches(second_in_front) + touches(second_behind);
    if (has_first != has_last) {
      outer *= 2;  // the only outer link counts for both
    }
    const int difference = has_first || has_last ? outer - inner : 0;
    return difference == 0 ? gait >= 0 : difference > 0;
  }

  void advance_sensing(const Contacts& contacts, const Surroundings& surroundings, const Tuning& tuning,
                       const std::int32_t* state, std::int32_t* next) const override {
    const unsigned touched = touch_around(contacts, surroundings.context.joint);
    next[links_touched] = static_cast<std::int32_t>(touched);
    // The value is limited, because a counter may have been overwritten.
    const std::int32_t before = std::clamp<std::int32_t>(state[still_ticks], 0, most_still_ticks - 1);
    next[still_ticks] = next[links_touched] == state[links_touched] ? before + 1 : 0;

    const bool stuck = next[still_ticks] >= tuning.derived[threshold_ticks] &&
                       next[still_ticks] < tuning.derived[give_up_ticks] && any_link_touches(contacts);
    std::int32_t target = 0;
    std::int32_t step = 0;
    if (stuck) {
      const std::int32_t gait = subtract_saturating(surroundings.setpoint, state[offset]);
      const bool up = bends_up(touched, surroundings, gait);
      const unsigned touch_state = 2 * ((touched >> in_front) & 1U) + ((touched >> behind) & 1U);
      target = up ? tuning.parameters[max_offset] : -tuning.parameters[max_offset];
      step = step_of(tuning, first_constant + touch_state + (up ? 0 : touch_states));
    } else {
      step = step_of(tuning, recovering);
    }
    next[offset] = step_towards(target, state[offset], step);
  }
};

constexpr GlobalAdaptiveTouch instance;

}  // namespace

const ActuationModule& sensing_module_global_adaptive_touch() { return instance; }

}  // namespace proleg
