#include "shared/fixed/arithmetic.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/smooth_wave.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { amplitude, frequency, phase_step, phase_shift, offset, harmonic, rate, noise };
constexpr Parameter parameters[] = {
    generator_parameters::amplitude,
    generator_parameters::frequency,
    generator_parameters::phase_difference,
    generator_parameters::phase,
    generator_parameters::offset,
    Parameter{"harmonic", Unit::count, 1, 1, 8,
              "How many times the joint swings while the others swing once. Multiple of the frequency."},
    generator_parameters::rate,
    generator_parameters::noise(0),
};

class SinusoidalExtended final : public SmoothWave {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

 private:
  static constexpr Declaration about{3,
                                     "PatternGenerator_sinusoidal_extended",
                                     "sine with smooth changes and harmonics",
                                     parameters,
                                     wave_values,
                                     wave_frame};

  enum OwnDerived : std::uint8_t { joint_phase = first_wave_derived };
  static_assert(joint_phase < max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    derived[joint_phase] = add_wrapping(travelled_phase(context.joint, values[phase_step]), values[phase_shift]);
    derive_wave(context, values[rate], values[harmonic], derived);
  }

  [[nodiscard]] Target target(const Tuning& tuning) const override {
    return {tuning.parameters[amplitude], tuning.derived[joint_phase], tuning.parameters[offset]};
  }

  [[nodiscard]] std::int32_t multiple(const Tuning& tuning) const override { return tuning.parameters[harmonic]; }

  [[nodiscard]] std::optional<std::int32_t> lead_over(const JointContext& context, const Tuning& tuning,
                                                      unsigned joint) const override {
    return travelled_phase(context.joint - joint, tuning.parameters[phase_step]);
  }
};

constexpr SinusoidalExtended instance;

}  // namespace

const ActuationModule& pattern_generator_sinusoidal_extended() { return instance; }

}  // namespace proleg
