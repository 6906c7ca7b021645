#include <algorithm>
#include <optional>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/critical_filter.hpp"
#include "shared/gait/decision_list.hpp"
#include "shared/gait/gait_features.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"
#include "shared/gait/sensing_module.hpp"

namespace proleg {
namespace {

constexpr std::int32_t set_count = 4;
constexpr unsigned parameters_of_set = 4;
constexpr std::int32_t feature_count = GaitFeatures::count;

enum Parameters : std::uint8_t {
  // Of set 1; those of the other sets follow in the same order.
  amplitude,
  frequency,
  phase_step,
  offset,
  // Of the rule for set 2; those for sets 3 and 4 follow in the same order.
  first_rule = set_count * parameters_of_set,
  // Common to all.
  window = first_rule + (set_count - 1) * DecisionList::parameters_of_rule,
  dwell,
  hysteresis,
  rate
};
constexpr Parameter set_amplitude(ParameterName name) {
  return {name, Unit::degree, raw(Unit::degree, 40),
          0,    quarter_turn, "How far the joint swings to each side in this set."};
}
constexpr Parameter set_frequency(ParameterName name) {
  return {name, Unit::hertz,          raw(Unit::hertz, 1),
          0,    raw(Unit::hertz, 20), "How many times a second the joint swings in this set."};
}
constexpr Parameter set_phase_difference(ParameterName name) {
  return {name,          Unit::phase_degree, raw(Unit::phase_degree, 55),
          phase_minimum, phase_maximum,      "How far the wave runs ahead from joint to joint in this set."};
}
constexpr Parameter set_offset(ParameterName name) {
  return {name, Unit::degree, 0, -quarter_turn, quarter_turn, "The angle around which the joint swings in this set."};
}
constexpr Parameter rule_feature(ParameterName name) {
  return {name,
          Unit::count,
          0,
          -feature_count,
          feature_count,
          "Which feature has to be above the threshold. A negative number: below it. 0: the set is never chosen. 1 "
          "pitch, 2 pitch_swing, 3 roll, 4 touch, 5 head_touch, 6 touch_changes, 7 current, 8 tracking_error."};
}
constexpr Parameter rule_second_feature(ParameterName name) {
  return {name,
          Unit::count,
          0,
          -feature_count,
          feature_count,
          "Which feature has to be above the second threshold. Numbers as for the first feature; 0: none has to."};
}
constexpr Parameter rule_threshold(ParameterName name) {
  return {name,
          Unit::ratio,
          0,
          raw(Unit::ratio, -7),
          raw(Unit::ratio, 7),
          "The value that the feature has to pass. In the units of docs/gait-selector.md."};
}

constexpr Parameter parameters[] = {
    set_amplitude("amplitude_1"),
    set_frequency("frequency_1"),
    set_phase_difference("phase_difference_1"),
    set_offset("offset_1"),
    set_amplitude("amplitude_2"),
    set_frequency("frequency_2"),
    set_phase_difference("phase_difference_2"),
    set_offset("offset_2"),
    set_amplitude("amplitude_3"),
    set_frequency("frequency_3"),
    set_phase_difference("phase_difference_3"),
    set_offset("offset_3"),
    set_amplitude("amplitude_4"),
    set_frequency("frequency_4"),
    set_phase_difference("phase_difference_4"),
    set_offset("offset_4"),
    rule_feature("feature_2"),
    rule_threshold("threshold_2"),
    rule_second_feature("second_feature_2"),
    rule_threshold("second_threshold_2"),
    rule_feature("feature_3"),
    rule_threshold("threshold_3"),
    rule_second_feature("second_feature_3"),
    rule_threshold("second_threshold_3"),
    rule_feature("feature_4"),
    rule_threshold("threshold_4"),
    rule_second_feature("second_feature_4"),
    rule_threshold("second_threshold_4"),
    Parameter{"window", Unit::count, 2'000, 1, 600'000,
              "Over which time the features are averaged. Time constant of their low-pass filters, in ms."},
    Parameter{"dwell", Unit::count, 3'000, 0, 600'000,
              "How long a set stays chosen at least. ms between two decisions."},
    Parameter{"hysteresis", Unit::ratio, raw(Unit::ratio, 2, 100), 0, raw(Unit::ratio, 1),
              "How far a feature has to go back to end a set. Part by which the thresholds of the present set are "
              "easier to pass."},
    generator_parameters::rate,
};
static_assert(std::size(parameters) == rate + 1U && std::size(parameters) <= max_parameters);

enum Values : std::uint8_t {
  current_phase,
  announced_set,
  countdown,
  set,
  since_decision,
  current_amplitude,
  amplitude_rate,
  current_shift,
  shift_rate,
  current_offset,
  offset_rate,
  features  // the first of GaitFeatures::state_size values
};
constexpr InternalValue internal_values[] = {
    InternalValue{"current_phase", Unit::phase_degree, 0, "phase of the wave at the first joint, without the filter"},
    InternalValue{"announced_set", Unit::count, 0, "the set that is played, or to which all joints change next"},
    InternalValue{"countdown", Unit::count, 0, "ticks until all joints change to announced_set"},
    InternalValue{"set", Unit::count, 0, "the set that is played, 1 to 4"},
    InternalValue{"since_decision", Unit::count, 0,
                  "ticks since the joint decided; after a start below 0 until its features follow what it senses"},
    generator_values::current_amplitude(),
    generator_values::amplitude_rate,
    InternalValue{"current_shift", Unit::phase_degree, 0, "filtered phase of the joint"},
    InternalValue{"shift_rate", Unit::degree, 0, "its change in a second, times 2 / rate"},
    generator_values::current_offset(),
    generator_values::offset_rate,
    InternalValue{"pitch", Unit::ratio, 0, "mean inclination of the link behind the joint; 1: 90 degrees, front above"},
    InternalValue{"pitch_swing", Unit::ratio, 0, "mean distance of the inclination from its mean; 1: 90 degrees"},
    InternalValue{"roll", Unit::ratio, 0, "mean roll of this link to either side; 1: 180 degrees, upside down"},
    InternalValue{"touch", Unit::ratio, 0, "mean part of the links that touch something"},
    InternalValue{"head_touch", Unit::ratio, 0, "mean part of the time in which the first link touches something"},
    InternalValue{"touch_changes", Unit::ratio, 0, "changes of touch of a link in a second, mean of the links"},
    InternalValue{"current", Unit::ratio, 0, "mean current of the servo in A"},
    InternalValue{"tracking_error", Unit::ratio, 0, "mean distance of the angle from its set-point; 1: 90 degrees"},
    InternalValue{"touched_links", Unit::count, 0, "the first 31 links that touch: a bit each"},
};
static_assert(std::size(internal_values) == features + GaitFeatures::state_size &&
              std::size(internal_values) <= max_internal_values);

constexpr FrameField frame[] = {FrameField{current_phase, 4}, FrameField{announced_set, 1}, FrameField{countdown, 1}};
enum Field : std::uint8_t { phase_field, announced_field, countdown_field };
constexpr std::int32_t longest_countdown = 255;
/// Ticks that the news of a decision may be late at each joint together, because frames are lost.
constexpr unsigned spare_ticks = 8;

std::uint8_t required_readings(const std::int32_t* values) {
  return GaitFeatures::required_readings(DecisionList(values + first_rule, set_count).features());
}

std::optional<Contradiction> contradiction(const std::int32_t* values) {
  return DecisionList(values + first_rule, set_count).contradiction(first_rule);
}
constexpr ParameterRules parameter_rules{contradiction, required_readings};

constexpr Declaration about{16,
                            "SensingModule_gait_selector",
                            "wave that chooses among four sets of parameters by what the robot senses",
                            parameters,
                            internal_values,
                            frame,
                            0,
                            &parameter_rules};

class GaitSelector final : public SensingModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }
  [[nodiscard]] std::uint8_t senses_readings() const override {
    return JointReadings::servo_current | JointReadings::inclination | JointReadings::angle_of_joint;
  }

  void derive(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    for (unsigned i = 0; i < set_count; ++i) {
      derived[increments + i] = phase_increment_of(values[i * parameters_of_set + frequency], context.tick_period_us);
    }
    make_critical_filter(values[rate], context.tick_period_us).store(derived + filter_constants);
    const bool decides = !context.group.empty() && context.group.front() == context.joint;
    derived[notice] =
        decides ? static_cast<std::int32_t>(std::min(context.group.size() + spare_ticks, unsigned{longest_countdown}))
                : 0;
    // All joints have changed before the next decision.
    derived[dwell_ticks] = std::max(ticks_of(values[dwell], context), derived[notice]);
    const unsigned used = decides ? DecisionList(values + first_rule, set_count).features() : 0U;
    GaitFeatures::make(context, values[window], used).store(derived + feature_constants);
  }

  void reset(const JointContext& context, const Tuning& tuning, Pcg32& /*noise*/, std::int32_t* state) const override {
    state[announced_set] = 1;
    state[set] = 1;
    state[since_decision] = before_first_decision(context, tuning);
    state[current_shift] = shift_in(1, context, tuning);
  }

  /// The robot's decision is taken from a neighbour. While the robot is about to change its set, the set before is not
  /// known, so the joint changes some ticks early.
  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    const Neighbour& neighbour = surroundings.ahead.present() ? surroundings.ahead : surroundings.behind;
    if (neighbour.present()) {
      take(neighbour, state);
      state[set] = state[announced_set];
    } else {
      state[current_phase] =
          static_cast<std::int32_t>(surroundings.tick * static_cast<std::uint32_t>(tuning.derived[increments]));
    }
    state[since_decision] = before_first_decision(surroundings.context, tuning);
    const std::int32_t* const chosen = set_of(state[set], tuning);
    state[current_amplitude] = chosen[amplitude];
    state[current_shift] = shift_in(state[set], surroundings.context, tuning);
    state[current_offset] = chosen[offset];
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    const std::int32_t phase = add_wrapping(state[current_phase], state[current_shift]);
    return add_saturating(multiply(state[current_amplitude], sine(static_cast<std::uint32_t>(phase)), 30),
                          state[current_offset]);
  }

  /// The neighbour's clock is taken to run as the joint's own.
  void extrapolate(const Tuning& tuning, const std::int32_t* state, StateFrame& missed) const override {
    const std::int32_t step = tuning.derived[increments + position_of(state[set])];
    repack(about, phase_field, add_wrapping(unpack(about, phase_field, missed), step), missed);
    repack(about, countdown_field, unpack(about, countdown_field, missed) - 1, missed);  // repack() cuts it at 0
  }

 private:
  enum Derived : std::uint8_t {
    increments,
    filter_constants = increments + set_count,
    feature_constants =
        filter_constants + CriticalFilter::derived_size,  ///< of no feature on joints that do not decide
    dwell_ticks = feature_constants + GaitFeatures::derived_size,
    notice,  ///< ticks from a decision to its effect; 0 on joints that do not decide
  };
  static_assert(notice < max_derived);

  /// A state may have been overwritten.
  static unsigned position_of(std::int32_t set_number) {
    return static_cast<unsigned>(std::clamp<std::int32_t>(set_number, 1, set_count) - 1);
  }
  static const std::int32_t* set_of(std::int32_t set_number, const Tuning& tuning) {
    return tuning.parameters + position_of(set_number) * parameters_of_set;
  }
  static std::int32_t shift_in(std::int32_t set_number, const JointContext& context, const Tuning& tuning) {
    return static_cast<std::int32_t>(std::uint32_t{context.joint} *
                                     static_cast<std::uint32_t>(set_of(set_number, tuning)[phase_step]));
  }
  static std::int32_t ticks_of(std::int32_t ms, const JointContext& context) {
    return static_cast<std::int32_t>(divide_nearest(std::int64_t{ms} * 1'000, std::int64_t{context.tick_period_us}));
  }
  /// since_decision of a joint that starts. Its features start at 0, so it does not decide until they follow.
  static std::int32_t before_first_decision(const JointContext& context, const Tuning& tuning) {
    const std::int32_t to_follow = ticks_of(GaitFeatures::windows_to_follow * tuning.parameters[window], context);
    return std::min<std::int32_t>(tuning.derived[dwell_ticks] - to_follow, 0);
  }
  static void take(const Neighbour& neighbour, std::int32_t* state) {
    state[current_phase] = neighbour.value(phase_field);
    state[announced_set] = static_cast<std::int32_t>(position_of(neighbour.value(announced_field))) + 1;
    state[countdown] = neighbour.value(countdown_field);
  }

  /// A joint takes clock and decision from the joint ahead of it. So a joint that missed a decision, or was disturbed,
  /// is right again a tick later, and until then keeps its set.
  void advance_sensing(const Contacts& /*contacts*/, const Surroundings& surroundings, const Tuning& tuning,
                       const std::int32_t* state, std::int32_t* next) const override {
    if (surroundings.ahead.present()) {
      take(surroundings.ahead, next);
    } else {
      next[current_phase] = state[current_phase];
      next[announced_set] = static_cast<std::int32_t>(position_of(state[announced_set])) + 1;
      next[countdown] = std::clamp<std::int32_t>(state[countdown], 0, longest_countdown);
    }
    next[countdown] = std::max<std::int32_t>(next[countdown] - 1, 0);
    GaitFeatures::load(tuning.derived + feature_constants).advance(surroundings, state + features, next + features);
    const std::int32_t before = std::clamp<std::int32_t>(state[since_decision], -most_ticks, most_ticks);
    next[since_decision] = std::min(before + 1, most_ticks);
    const unsigned present =
        next[countdown] == 0 ? static_cast<unsigned>(next[announced_set] - 1) : position_of(state[set]);
    if (tuning.derived[notice] != 0 && next[countdown] == 0 && before >= tuning.derived[dwell_ticks]) {
      decide(tuning, next);
    }
    next[set] = static_cast<std::int32_t>(present) + 1;
    next[current_phase] = add_wrapping(next[current_phase], tuning.derived[increments + present]);

    const CriticalFilter filter = CriticalFilter::load(tuning.derived + filter_constants);
    const std::int32_t* const chosen = tuning.parameters + present * parameters_of_set;
    follow(filter, chosen[amplitude], state + current_amplitude, next + current_amplitude);
    follow(filter, chosen[offset], state + current_offset, next + current_offset);
    const std::int32_t shift = shift_in(next[set], surroundings.context, tuning);
    next[shift_rate] = state[shift_rate];
    next[current_shift] =
        add_wrapping(shift, proleg::advance(filter, subtract_wrapping(state[current_shift], shift), next[shift_rate]));
  }

  static constexpr std::int32_t most_ticks = 1 << 21;  ///< more than any dwell time or three windows have

  [[gnu::noinline]] static void decide(const Tuning& tuning, std::int32_t* next) {
    const std::int32_t wanted = DecisionList(tuning.parameters + first_rule, set_count)
                                    .choose(next + features, next[announced_set], tuning.parameters[hysteresis]);
    if (wanted != next[announced_set]) {
      next[announced_set] = wanted;
      next[countdown] = tuning.derived[notice];
      next[since_decision] = 0;
    }
  }
};

constexpr GaitSelector instance;

}  // namespace

const ActuationModule& sensing_module_gait_selector() { return instance; }

}  // namespace proleg
