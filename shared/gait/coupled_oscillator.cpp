#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/critical_filter.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { amplitude, frequency, phase_step, offset, coupling, rate, noise };
constexpr Parameter parameters[] = {
    generator_parameters::amplitude,
    generator_parameters::frequency,
    generator_parameters::phase_difference,
    generator_parameters::offset,
    Parameter{"coupling", Unit::per_second, raw(Unit::per_second, 10), 0, raw(Unit::per_second, 50),
              "How strongly neighbours pull each other into step. Weight w of the coupling to each neighbour; acts as "
              "at most 0.5 / tick, where a chain is still stable."},
    generator_parameters::rate,
    generator_parameters::noise(raw(Unit::ratio, 1)),
};

enum Values : std::uint8_t {
  current_amplitude = PatternGenerator::first_own_value,
  amplitude_rate,
  current_offset,
  offset_rate,
};
constexpr InternalValue internal_values[] = {
    InternalValue{PatternGenerator::phase_value.name, Unit::phase_degree, raw(Unit::degree, 30),
                  "phase of the oscillator"},
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
    generator_values::current_amplitude(raw(Unit::degree, 1)),
    generator_values::amplitude_rate,
    generator_values::current_offset(raw(Unit::degree, 1)),
    generator_values::offset_rate,
};
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}, FrameField{current_amplitude, 2}};

constexpr Declaration about{4,
                            "PatternGenerator_coupled_oscillator",
                            "amplitude-controlled phase oscillators coupled to their neighbours",
                            parameters,
                            internal_values,
                            frame};

class CoupledOscillator final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    state[current_amplitude] = tuning.parameters[amplitude];
    state[current_offset] = tuning.parameters[offset];
    if (const auto phase = phase_beside_neighbour(surroundings, tuning.parameters[phase_step])) {
      state[current_phase] = *phase;
    }
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    const std::int32_t swing =
        multiply(state[current_amplitude], cosine(static_cast<std::uint32_t>(state[current_phase])), 30);
    return add_saturating(swing, state[current_offset]);
  }

 private:
  enum OwnDerived : std::uint8_t { gain = first_own_derived, filter_constants };
  static_assert(filter_constants + CriticalFilter::derived_size <= max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    // The step of phase for a coupling sine of 1 is w dt / (2 pi) turns.
    constexpr std::int64_t inverse_of_two_pi = 170891319;  // Q30
    const std::int64_t weight =
        divide_nearest((std::int64_t{values[coupling]} * context.tick_period_us) << 6U, 1'000'000);
    const std::int64_t stable = weight > (1 << 29) ? 1 << 29 : weight;
    derived[gain] = static_cast<std::int32_t>(shift_right_rounding(stable * inverse_of_two_pi, 28));
    make_critical_filter(values[rate], context.tick_period_us).store(derived + filter_constants);
  }

  void reset_pattern(const JointContext& /*context*/, const Tuning& /*tuning*/,
                     std::int32_t* /*state*/) const override {}

  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const override {
    std::int32_t step = tuning.derived[phase_increment];
    step = add_wrapping(step, pull(surroundings.ahead, surroundings.context, tuning, state));
    step = add_wrapping(step, pull(surroundings.behind, surroundings.context, tuning, state));
    next[current_phase] = add_wrapping(state[current_phase], step);

    const CriticalFilter filter = CriticalFilter::load(tuning.derived + filter_constants);
    follow(filter, tuning.parameters[amplitude], state + current_amplitude, next + current_amplitude);
    follow(filter, tuning.parameters[offset], state + current_offset, next + current_offset);
  }

  /// What a neighbour adds to the phase in a tick.
  static std::int32_t pull(const Neighbour& neighbour, const JointContext& context, const Tuning& tuning,
                           const std::int32_t* state) {
    if (!neighbour.present()) {
      return 0;
    }
    const std::uint32_t lead = lead_of(neighbour, context, tuning.parameters[phase_step], state[current_phase]);
    return multiply(tuning.derived[gain], sine(lead), 30);
  }
};

constexpr CoupledOscillator instance;

}  // namespace

const ActuationModule& pattern_generator_coupled_oscillator() { return instance; }

}  // namespace proleg
