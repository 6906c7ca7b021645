#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/critical_filter.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { amplitude, frequency, phase_step, phase_shift, offset, harmonic, rate, noise };
constexpr Parameter parameters[] = {
    generator_parameters::amplitude,
    generator_parameters::frequency,
    generator_parameters::phase_difference,
    generator_parameters::phase,
    generator_parameters::offset,
    Parameter{"harmonic", Unit::count, 1, 1, 8, "the joint oscillates at this multiple of the frequency"},
    generator_parameters::rate,
    generator_parameters::noise(0),
};

enum Values : std::uint8_t {
  clock = PatternGenerator::first_own_value,
  current_amplitude,
  amplitude_rate,
  current_shift,
  shift_rate,
  current_offset,
  offset_rate,
};
constexpr InternalValue internal_values[] = {
    PatternGenerator::phase_value,
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
    InternalValue{"clock", Unit::phase_degree, 0, "phase accumulated over the ticks"},
    InternalValue{"current_amplitude", Unit::degree, raw(Unit::degree, 5), "filtered amplitude"},
    InternalValue{"amplitude_rate", Unit::degree, 0, "its change in a second, times 2 / rate"},
    InternalValue{"current_shift", Unit::phase_degree, raw(Unit::degree, 30), "filtered phase of the joint"},
    InternalValue{"shift_rate", Unit::degree, 0, "its change in a second, times 2 / rate"},
    InternalValue{"current_offset", Unit::degree, raw(Unit::degree, 5), "filtered offset"},
    InternalValue{"offset_rate", Unit::degree, 0, "its change in a second, times 2 / rate"},
};
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}};

constexpr Declaration about{
    3,    "PatternGenerator_sinusoidal_extended", "sine with smooth changes and harmonics", parameters, internal_values,
    frame};

class SinusoidalExtended final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    state[current_amplitude] = tuning.parameters[amplitude];
    state[current_offset] = tuning.parameters[offset];
    state[current_shift] = tuning.derived[joint_phase];
    const std::uint32_t since_start = surroundings.tick * static_cast<std::uint32_t>(tuning.derived[phase_increment]);
    const std::int32_t undisturbed = add_wrapping(static_cast<std::int32_t>(since_start), state[current_shift]);
    state[current_phase] = phase_beside_neighbour(surroundings, tuning.parameters[phase_step]).value_or(undisturbed);
    // Which of the turns of the harmonic it is makes no difference to the joint.
    const std::int32_t multiple = subtract_wrapping(state[current_phase], state[current_shift]);
    state[clock] = multiple / tuning.parameters[harmonic];
    state[current_phase] = add_wrapping(state[clock] * tuning.parameters[harmonic], state[current_shift]);
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    const std::int32_t swing =
        multiply(state[current_amplitude], sine(static_cast<std::uint32_t>(state[current_phase])), 30);
    return add_saturating(swing, state[current_offset]);
  }

 private:
  enum OwnDerived : std::uint8_t { clock_increment = first_own_derived, joint_phase, filter_constants };
  static_assert(filter_constants + CriticalFilter::derived_size <= max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    derived[clock_increment] = derived[phase_increment];
    derived[phase_increment] = static_cast<std::int32_t>(static_cast<std::uint32_t>(derived[clock_increment]) *
                                                         static_cast<std::uint32_t>(values[harmonic]));
    const std::uint32_t travelled = std::uint32_t{context.joint} * static_cast<std::uint32_t>(values[phase_step]);
    derived[joint_phase] = add_wrapping(static_cast<std::int32_t>(travelled), values[phase_shift]);
    make_critical_filter(values[rate], context.tick_period_us).store(derived + filter_constants);
  }

  void reset_pattern(const JointContext& /*context*/, const Tuning& tuning, std::int32_t* state) const override {
    state[current_shift] = tuning.derived[joint_phase];
    state[current_phase] = state[current_shift];
  }

  void advance_pattern(const Surroundings& /*surroundings*/, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const override {
    const CriticalFilter filter = CriticalFilter::load(tuning.derived + filter_constants);

    next[amplitude_rate] = state[amplitude_rate];
    next[current_amplitude] =
        approach(filter, tuning.parameters[amplitude], state[current_amplitude], next[amplitude_rate]);
    next[offset_rate] = state[offset_rate];
    next[current_offset] = approach(filter, tuning.parameters[offset], state[current_offset], next[offset_rate]);

    const std::int32_t target = tuning.derived[joint_phase];
    next[shift_rate] = state[shift_rate];
    next[current_shift] = add_wrapping(
        target, proleg::advance(filter, subtract_wrapping(state[current_shift], target), next[shift_rate]));

    next[clock] = add_wrapping(state[clock], tuning.derived[clock_increment]);
    const std::uint32_t multiple =
        static_cast<std::uint32_t>(next[clock]) * static_cast<std::uint32_t>(tuning.parameters[harmonic]);
    next[current_phase] = add_wrapping(static_cast<std::int32_t>(multiple), next[current_shift]);
  }
};

constexpr SinusoidalExtended instance;

}  // namespace

const ActuationModule& pattern_generator_sinusoidal_extended() { return instance; }

}  // namespace proleg
