#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/polar.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/critical_filter.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"
#include "shared/gait/phase_warp.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t {
  amplitude,
  frequency,
  phase_step,
  offset,
  falling_fraction,
  attraction,
  coupling,
  rate,
  noise
};
constexpr Parameter parameters[] = {
    generator_parameters::amplitude,
    generator_parameters::frequency,
    generator_parameters::phase_difference,
    generator_parameters::offset,
    Parameter{
        "falling_fraction", Unit::ratio, raw(Unit::ratio, 1, 2), raw(Unit::ratio, 2, 10), raw(Unit::ratio, 8, 10),
        "Which part of a swing the joint takes to go down. Part of the period in which the angle falls (duty factor)."},
    Parameter{"attraction", Unit::per_second, raw(Unit::per_second, 10), raw(Unit::per_second, 1),
              raw(Unit::per_second, 50),
              "How fast the joint is back in its swing after a disturbance. alpha: how fast the state returns to its "
              "circle; acts as at most 0.5 / tick."},
    Parameter{"coupling", Unit::per_second, raw(Unit::per_second, 4), 0, raw(Unit::per_second, 25),
              "How strongly neighbours pull each other into step. Weight k of the coupling to each neighbour; acts as "
              "at most 0.25 / tick."},
    generator_parameters::rate,
    generator_parameters::noise(raw(Unit::ratio, 1)),
};

enum Values : std::uint8_t {
  x = PatternGenerator::first_own_value,
  y,
  radius,
  current_amplitude,
  amplitude_rate,
  current_offset,
  offset_rate,
};
constexpr InternalValue internal_values[] = {
    InternalValue{PatternGenerator::phase_value.name, Unit::phase_degree, 0, "angle of (x, y)"},
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
    InternalValue{"x", Unit::ratio, raw(Unit::ratio, 1, 4), "first coordinate; 1 at the largest joint angle"},
    InternalValue{"y", Unit::ratio, raw(Unit::ratio, 1, 4), "second coordinate, a quarter of a period behind"},
    InternalValue{"radius", Unit::ratio, 0, "distance of (x, y) from the origin"},
    generator_values::current_amplitude(),
    generator_values::amplitude_rate,
    generator_values::current_offset(),
    generator_values::offset_rate,
};
enum Fields : std::uint8_t { phase_sent, radius_sent };
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}, FrameField{radius, 2}};

constexpr Declaration about{8,          "PatternGenerator_hopf", "Hopf oscillators coupled to their neighbours",
                            parameters, internal_values,         frame};

constexpr std::int32_t one = raw(Unit::ratio, 1);

class Hopf final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    state[current_amplitude] = tuning.parameters[amplitude];
    state[current_offset] = tuning.parameters[offset];
    const Neighbour& neighbour = surroundings.ahead.present() ? surroundings.ahead : surroundings.behind;
    if (neighbour.present()) {
      const std::uint32_t angle = angle_beside(neighbour, surroundings.context, tuning);
      state[x] = cosine(angle) / 4;
      state[y] = sine(angle) / 4;
      state[current_phase] = static_cast<std::int32_t>(angle);
      state[radius] = one;
    }
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    const std::int64_t swing = shift_right_rounding(multiply_wide(state[current_amplitude], state[x]), 28);
    return saturate(swing + state[current_offset]);
  }

 private:
  enum OwnDerived : std::uint8_t {
    falling_step = first_own_derived,  ///< phase in a tick where y is positive, so that x falls
    rising_step,
    attraction_step,  ///< alpha dt in Q30
    coupling_step,    ///< k dt in Q30
    warp,
    filter_constants = warp + PhaseWarp::derived_size,
  };
  static_assert(filter_constants + CriticalFilter::derived_size <= max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    // Half a turn lasts the fraction d of the period.
    const std::int64_t half_increment = std::int64_t{derived[phase_increment]} << 27U;
    derived[falling_step] = saturate(divide_nearest(half_increment, values[falling_fraction]));
    derived[rising_step] = saturate(divide_nearest(half_increment, one - values[falling_fraction]));
    derived[attraction_step] = per_tick(values[attraction], context.tick_period_us, 1 << 29);
    derived[coupling_step] = per_tick(values[coupling], context.tick_period_us, 1 << 28);
    PhaseWarp::derive(values[falling_fraction], derived + warp);
    make_critical_filter(values[rate], context.tick_period_us).store(derived + filter_constants);
  }

  /// A rate constant times the tick, in Q30, at most `largest`.
  static std::int32_t per_tick(std::int32_t rate_constant, std::uint32_t tick_period_us, std::int64_t largest) {
    return static_cast<std::int32_t>(
        std::min(divide_nearest((std::int64_t{rate_constant} * tick_period_us) << 6U, 1'000'000), largest));
  }

  void reset_pattern(const JointContext& /*context*/, const Tuning& /*tuning*/, std::int32_t* state) const override {
    state[x] = one;
    state[radius] = one;
  }

  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const override {
    // The largest state, a circle four times as large as the limit cycle: there the squares below fit into 64 bits.
    constexpr std::int32_t largest = 4 * one;
    const std::int32_t old_x = std::clamp(state[x], -largest, largest);
    const std::int32_t old_y = std::clamp(state[y], -largest, largest);

    // The rotation is exact, so that the frequency has no error of integration.
    const std::uint32_t step = step_at(tuning, old_y);
    const std::int32_t sin = sine(step);
    const std::int32_t cos = cosine(step);
    std::int32_t new_x = saturate(shift_right_rounding(multiply_wide(cos, old_x) - multiply_wide(sin, old_y), 30));
    std::int32_t new_y = saturate(shift_right_rounding(multiply_wide(sin, old_x) + multiply_wide(cos, old_y), 30));

    // alpha (1 - |z|^2) is limited, so that a state far outside the circle comes back and does not pass to the other
    // side.
    const std::int64_t squares = shift_right_rounding(multiply_wide(new_x, new_x) + multiply_wide(new_y, new_y), 28);
    constexpr std::int32_t half = 1 << 29;
    const std::int32_t pull = std::clamp(
        saturate(shift_right_rounding(multiply_wide(saturate(one - squares), tuning.derived[attraction_step]), 28)),
        -half, half);
    new_x = add_saturating(new_x, multiply(new_x, pull, 30));
    new_y = add_saturating(new_y, multiply(new_y, pull, 30));
    for (const Neighbour* neighbour : {&surroundings.ahead, &surroundings.behind}) {
      couple(*neighbour, surroundings.context, tuning, old_x, old_y, new_x, new_y);
    }
    next[x] = new_x;
    next[y] = new_y;
    const Polar place = polar(new_x, new_y);
    next[current_phase] = place.angle;
    next[radius] = place.length;

    const CriticalFilter filter = CriticalFilter::load(tuning.derived + filter_constants);
    follow(filter, tuning.parameters[amplitude], state + current_amplitude, next + current_amplitude);
    follow(filter, tuning.parameters[offset], state + current_offset, next + current_offset);
  }

  /// Change of the phase in a tick. Between the half planes the speed changes over a band, like the logistic function
  /// with b = 50.
  static std::uint32_t step_at(const Tuning& tuning, std::int32_t old_y) {
    const std::int32_t falling = tuning.derived[falling_step];
    const std::int32_t rising = tuning.derived[rising_step];
    constexpr std::int32_t band = one / 25;
    const std::int32_t share = std::clamp(old_y, -band, band) * 25 / 2 + one / 2;
    const std::int32_t difference = subtract_saturating(falling, rising);
    return static_cast<std::uint32_t>(rising) + static_cast<std::uint32_t>(multiply(difference, share, 28));
  }

  /// The angle that the joint has beside a neighbour. The phase difference is one of time; with two speeds it is not a
  /// constant difference of angles.
  static std::uint32_t angle_beside(const Neighbour& neighbour, const JointContext& context, const Tuning& tuning) {
    const PhaseWarp two_speeds(tuning.parameters[falling_fraction], tuning.derived + warp);
    const std::uint32_t distance = neighbour.joint() - context.joint;
    const std::uint32_t wanted = distance * static_cast<std::uint32_t>(tuning.parameters[phase_step]);
    return two_speeds.angle_of(two_speeds.phase_of(static_cast<std::uint32_t>(neighbour.value(phase_sent))) - wanted);
  }

  /// Adds k (R z_j - z_i), where R turns the neighbour's state by the phase that lies between the two joints. Not
  /// inline, to need less stack.
  [[gnu::noinline]] static void couple(const Neighbour& neighbour, const JointContext& context, const Tuning& tuning,
                                       std::int32_t old_x, std::int32_t old_y, std::int32_t& new_x,
                                       std::int32_t& new_y) {
    if (!neighbour.present()) {
      return;
    }
    const std::uint32_t turned = angle_beside(neighbour, context, tuning);
    const std::int32_t its_radius = neighbour.value(radius_sent);
    const std::int64_t distance_x = std::int64_t{multiply(its_radius, cosine(turned), 30)} - old_x;
    const std::int64_t distance_y = std::int64_t{multiply(its_radius, sine(turned), 30)} - old_y;
    new_x = add_saturating(new_x, multiply(tuning.derived[coupling_step], saturate(distance_x), 30));
    new_y = add_saturating(new_y, multiply(tuning.derived[coupling_step], saturate(distance_y), 30));
  }
};

constexpr Hopf instance;

}  // namespace

const ActuationModule& pattern_generator_hopf() { return instance; }

}  // namespace proleg
