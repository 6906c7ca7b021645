#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/polar.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/critical_filter.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/matsuoka_pair.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t {
  amplitude,
  frequency,
  phase_step,
  offset,
  coupling,
  time_ratio,
  fatigue,
  inhibition,
  rate,
  noise
};
constexpr Parameter parameters[] = {
    Parameter{"amplitude", Unit::degree, raw(Unit::degree, 40), 0, quarter_turn,
              "How far the joint swings to each side. Exact if y1 - y2 has the amplitude 1/2."},
    matsuoka_parameters::frequency,
    generator_parameters::phase_difference,
    generator_parameters::offset,
    Parameter{
        "coupling", Unit::ratio, raw(Unit::ratio, 2, 10), 0, raw(Unit::ratio, 1, 2),
        "How strongly neighbours pull each other into step. a: how strongly a neighbour inhibits the opposite neuron."},
    matsuoka_parameters::time_ratio,
    matsuoka_parameters::fatigue,
    matsuoka_parameters::inhibition,
    generator_parameters::rate,
    generator_parameters::noise(raw(Unit::ratio, 1)),
};

enum Values : std::uint8_t {
  u1 = PatternGenerator::first_own_value,
  u2,
  v1,
  v2,
  strength,
  current_amplitude,
  amplitude_rate,
  current_offset,
  offset_rate,
};
constexpr InternalValue internal_values[] = {
    InternalValue{PatternGenerator::phase_value.name, Unit::phase_degree, 0,
                  "phase of y1 - y2, estimated from it and from the fatigue"},
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
    matsuoka_values::u1,
    matsuoka_values::u2,
    matsuoka_values::v1,
    matsuoka_values::v2,
    InternalValue{"strength", Unit::ratio, 0, "amplitude that belongs to current_phase"},
    generator_values::current_amplitude(),
    generator_values::amplitude_rate,
    generator_values::current_offset(),
    generator_values::offset_rate,
};
enum Fields : std::uint8_t { phase_sent, strength_sent };
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}, FrameField{strength, 2}};

constexpr Declaration about{
    9,    "PatternGenerator_matsuoka", "Matsuoka oscillators coupled to their neighbours", parameters, internal_values,
    frame};

constexpr std::int32_t one = raw(Unit::ratio, 1);

class Matsuoka final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    state[current_amplitude] = tuning.parameters[amplitude];
    state[current_offset] = tuning.parameters[offset];
    if (const auto phase = phase_beside_neighbour(surroundings, tuning.parameters[phase_step])) {
      const bool extends = *phase >= 0;
      state[u1] = extends ? one / 10 : 0;
      state[u2] = extends ? 0 : one / 10;
      state[current_phase] = *phase;
    }
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    const std::int64_t swing = shift_right_rounding(multiply_wide(state[current_amplitude], difference(state)), 27);
    return saturate(swing + state[current_offset]);
  }

 private:
  enum OwnDerived : std::uint8_t {
    steps = first_own_derived,
    own_lag = steps + MatsuokaConstants::derived_size,  ///< angle by which y1 - y2 follows its input
    inverse_x,                                          ///< 1 / x in Q27
    quadrature,                                         ///< (1 + x^2) / x in Q27
    filter_constants,
  };
  static_assert(filter_constants + CriticalFilter::derived_size <= max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    const MatsuokaConstants constants = make_matsuoka_constants(
        values[Parameters::frequency], values[time_ratio], values[fatigue], values[inhibition], context.tick_period_us);
    constants.store(derived + steps);
    // At the natural frequency an input changes the phase of the pair only where it is ahead by arctan(omega tau).
    derived[own_lag] = polar(values[time_ratio] / 8, constants.x * 2).angle;
    derived[inverse_x] = saturate(divide_nearest(std::int64_t{1} << 51U, std::int64_t{constants.x}));
    derived[quadrature] = saturate(derived[inverse_x] + (std::int64_t{constants.x} << 3U));
    make_critical_filter(values[rate], context.tick_period_us).store(derived + filter_constants);
  }

  void reset_pattern(const JointContext& /*context*/, const Tuning& /*tuning*/, std::int32_t* state) const override {
    state[u1] = one / 10;  // a symmetrical start would stay symmetrical
  }

  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const override {
    const std::int32_t* values = tuning.parameters;
    const std::int64_t drive = std::int64_t{input_from(surroundings.ahead, surroundings.context, tuning)} +
                               input_from(surroundings.behind, surroundings.context, tuning);
    const std::int64_t weighted = shift_right_rounding(multiply_wide(saturate(drive), values[coupling]), 28);
    const std::int32_t input1 = saturate(one + std::min(weighted, std::int64_t{0}));
    const std::int32_t input2 = saturate(one - std::max(weighted, std::int64_t{0}));

    MatsuokaPair pair{state[u1], state[u2], state[v1], state[v2]};
    proleg::advance(pair, tuning.derived + steps, values[fatigue], values[inhibition], input1, input2);
    next[u1] = pair.u1;
    next[u2] = pair.u2;
    next[v1] = pair.v1;
    next[v2] = pair.v2;
    // T v' = -v + y: if both are sines, v1 - v2 is the quadrature component of y1 - y2.
    const std::int32_t along = difference(next);
    const std::int32_t behind = saturate(std::int64_t{pair.v1} - pair.v2);
    const std::int64_t across =
        multiply_wide(along, tuning.derived[inverse_x]) / 2 - multiply_wide(behind, tuning.derived[quadrature]) / 2;
    const Polar place = polar(saturate(shift_right_rounding(across, 27)), along / 2);
    next[current_phase] = place.angle;
    next[strength] = saturate(std::int64_t{place.length} * 2);

    const CriticalFilter filter = CriticalFilter::load(tuning.derived + filter_constants);
    follow(filter, values[amplitude], state + current_amplitude, next + current_amplitude);
    follow(filter, values[offset], state + current_offset, next + current_offset);
  }

  /// The difference y1 - y2.
  static std::int32_t difference(const std::int32_t* state) {
    return std::max(state[u1], std::int32_t{0}) - std::max(state[u2], std::int32_t{0});
  }

  /// The neighbour's y1 - y2, turned by the phase that lies between the two joints and by the pair's own lag.
  static std::int32_t input_from(const Neighbour& neighbour, const JointContext& context, const Tuning& tuning) {
    if (!neighbour.present()) {
      return 0;
    }
    const std::uint32_t distance = neighbour.joint() - context.joint;
    const std::uint32_t wanted = distance * static_cast<std::uint32_t>(tuning.parameters[phase_step]);
    const std::uint32_t turned = static_cast<std::uint32_t>(neighbour.value(phase_sent)) - wanted +
                                 static_cast<std::uint32_t>(tuning.derived[own_lag]);
    return multiply(neighbour.value(strength_sent), sine(turned), 30);
  }
};

constexpr Matsuoka instance;

}  // namespace

const ActuationModule& pattern_generator_matsuoka() { return instance; }

}  // namespace proleg
