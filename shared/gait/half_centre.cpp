#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/exponential.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/critical_filter.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { amplitude, frequency, phase_step, offset, fatigue, coupling, rate, noise };
constexpr Parameter parameters[] = {
    generator_parameters::amplitude,
    generator_parameters::frequency,
    generator_parameters::phase_difference,
    generator_parameters::offset,
    Parameter{"fatigue", Unit::ratio, raw(Unit::ratio, 1), raw(Unit::ratio, 2, 10), raw(Unit::ratio, 4),
              "Which shape the swing has. Small: a triangle; large: steep turns and flat ends. Half a period in time "
              "constants of the fatigue."},
    Parameter{"coupling", Unit::ratio, raw(Unit::ratio, 3, 10), 0, raw(Unit::ratio, 45, 100),
              "How strongly neighbours pull each other into step. Part of the speed by which each neighbour speeds up "
              "or slows down the fatigue."},
    generator_parameters::rate,
    generator_parameters::noise(raw(Unit::ratio, 1)),
};

enum Values : std::uint8_t {
  tiredness = PatternGenerator::first_own_value,
  active,
  current_amplitude,
  amplitude_rate,
  current_offset,
  offset_rate,
};
constexpr InternalValue internal_values[] = {
    PatternGenerator::phase_value,
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
    InternalValue{"tiredness", Unit::ratio, raw(Unit::ratio, 15, 100),
                  "fatigue of the half that raises the joint minus that of the other half"},
    InternalValue{"active", Unit::count, 0, "0: the half that raises the joint is active; 1: the other"},
    generator_values::current_amplitude(),
    generator_values::amplitude_rate,
    generator_values::current_offset(),
    generator_values::offset_rate,
};
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}};

constexpr Declaration about{10,
                            "PatternGenerator_half_centre",
                            "half-centres: two populations that inhibit each other and tire",
                            parameters,
                            internal_values,
                            frame};

constexpr std::int32_t one = raw(Unit::ratio, 1);

class HalfCentre final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    state[current_amplitude] = tuning.parameters[amplitude];
    state[current_offset] = tuning.parameters[offset];
    if (const auto phase = phase_beside_neighbour(surroundings, tuning.parameters[phase_step])) {
      state[current_phase] = *phase;
      // The state rises from a quarter of a turn before 0 to a quarter after it, in a straight line.
      const bool rises = *phase >= -quarter_turn && *phase < quarter_turn;
      const std::int32_t since_middle = rises ? *phase : subtract_wrapping(phase_minimum, *phase);
      state[tiredness] = multiply(since_middle, tuning.derived[threshold], 30);
      state[active] = rises ? 0 : 1;
    }
  }

  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* state) const override {
    const std::int32_t limit = tuning.derived[threshold];
    const std::int32_t share =
        multiply(std::clamp(state[tiredness], -limit, limit), tuning.derived[inverse_threshold], 26);
    const std::int64_t swing = shift_right_rounding(multiply_wide(state[current_amplitude], share), 28);
    return saturate(swing + state[current_offset]);
  }

 private:
  enum OwnDerived : std::uint8_t {
    threshold = first_own_derived,  ///< h, difference of the fatigues at which the other half takes over
    inverse_threshold,              ///< 1 / h in Q26
    approach_step,                  ///< part of the way to its end that the fatigue goes in a tick, Q30
    turn_back,                      ///< (1 + h) / (1 - h) in Q24
    turns_per_excess,               ///< phase that passes while the fatigue grows by 1 at the threshold, Q26 turns
    filter_constants,
  };
  static_assert(filter_constants + CriticalFilter::derived_size <= max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    derive_fatigue(context, values, derived);
    make_critical_filter(values[rate], context.tick_period_us).store(derived + filter_constants);
  }

  /// Not inline, because its variables would lie on the stack below those of the filter.
  [[gnu::noinline]] static void derive_fatigue(const JointContext& context, const std::int32_t* values,
                                               std::int32_t* derived) {
    // With L half a period in time constants: h = tanh(L / 2) = (1 - exp(-L)) / (1 + exp(-L)).
    const std::int32_t decay = exponential_decay(values[fatigue] >> 4);  // Q30, at least exp(-4)
    constexpr std::int64_t unit = 1 << 30;
    derived[threshold] = static_cast<std::int32_t>(divide_nearest((unit - decay) << 28U, unit + decay));
    derived[inverse_threshold] = static_cast<std::int32_t>(divide_nearest((unit + decay) << 26U, unit - decay));
    derived[turn_back] = static_cast<std::int32_t>(divide_nearest(unit << 24U, std::int64_t{decay}));
    // A tick lasts 2 f dt L time constants.
    const std::int64_t halves =
        divide_nearest((std::int64_t{values[Parameters::frequency]} * context.tick_period_us) << 1U,
                       1'000'000);  // Q24
    const std::int64_t constants = std::min(shift_right_rounding(halves * values[fatigue], 28), std::int64_t{1} << 24U);
    // exp(-x) takes Q24. In a slow gait that has too few steps, so 1 - x + x^2 / 2 is used there.
    const auto time = static_cast<std::int32_t>(constants);
    const std::int64_t fine = shift_right_rounding(
        divide_nearest((std::int64_t{values[Parameters::frequency]} * context.tick_period_us) << 7U, 1'000'000) *
            values[fatigue],
        28);  // Q30
    derived[approach_step] = static_cast<std::int32_t>(time < (1 << 16) ? fine - shift_right_rounding(fine * fine, 31)
                                                                        : unit - exponential_decay(time));
    // At the threshold the fatigue grows by g (1 - h) in a tick; 2^32 is a turn.
    const std::int64_t growth =
        shift_right_rounding(multiply_wide(derived[approach_step], one - derived[threshold]), 30);  // Q28
    derived[turns_per_excess] =
        saturate((std::int64_t{derived[phase_increment]} << 22U) / std::max(growth, std::int64_t{1}));
  }

  void reset_pattern(const JointContext& /*context*/, const Tuning& /*tuning*/,
                     std::int32_t* /*state*/) const override {}

  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const override {
    const std::int32_t* values = tuning.parameters;
    const std::int32_t* derived = tuning.derived;
    const std::int64_t pulls = std::int64_t{pull(surroundings.ahead, surroundings.context, tuning, state)} +
                               pull(surroundings.behind, surroundings.context, tuning, state);
    const std::int32_t speed = std::clamp(saturate(one + pulls), one / 10, 2 * one);

    // The fatigue approaches 1 or -1, by the active half. It reverses where it reaches the threshold.
    bool falls = state[active] != 0;
    const std::int32_t side = falls ? -one : one;
    const std::int32_t before = std::clamp(state[tiredness], -one, one);
    const std::int32_t step = std::min(multiply(derived[approach_step], speed, 28), std::int32_t{1 << 29});
    std::int32_t tired = before + multiply(side - before, step, 30);
    const std::int32_t excess = (falls ? -tired : tired) - derived[threshold];
    std::uint32_t phase = static_cast<std::uint32_t>(state[current_phase]) +
                          static_cast<std::uint32_t>(multiply(derived[phase_increment], speed, 28));
    if (excess >= 0) {
      // For the rest of the tick the fatigue goes back with the speed of the other half.
      const std::int32_t back = saturate(shift_right_rounding(multiply_wide(excess, derived[turn_back]), 24));
      const std::int32_t level = std::max(saturate(std::int64_t{derived[threshold]} - back), -derived[threshold]);
      tired = falls ? -level : level;
      const std::int64_t since = shift_right_rounding(multiply_wide(excess, derived[turns_per_excess]), 22);
      phase = (falls ? 0xC0000000U : 0x40000000U) + static_cast<std::uint32_t>(since);
      falls = !falls;
    }
    next[tiredness] = tired;
    next[active] = falls ? 1 : 0;
    next[current_phase] = static_cast<std::int32_t>(phase);

    const CriticalFilter filter = CriticalFilter::load(derived + filter_constants);
    follow(filter, values[amplitude], state + current_amplitude, next + current_amplitude);
    follow(filter, values[offset], state + current_offset, next + current_offset);
  }

  /// What a neighbour adds to the speed: more if the neighbour is further ahead than the wanted phase.
  static std::int32_t pull(const Neighbour& neighbour, const JointContext& context, const Tuning& tuning,
                           const std::int32_t* state) {
    if (!neighbour.present()) {
      return 0;
    }
    const std::uint32_t lead = lead_of(neighbour, context, tuning.parameters[phase_step], state[current_phase]);
    return multiply(tuning.parameters[coupling], sine(lead), 30);
  }
};

constexpr HalfCentre instance;

}  // namespace

const ActuationModule& pattern_generator_half_centre() { return instance; }

}  // namespace proleg
