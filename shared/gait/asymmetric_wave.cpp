#include "shared/fixed/arithmetic.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/phase_warp.hpp"
#include "shared/gait/smooth_wave.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { amplitude, frequency, phase_step, phase_shift, offset, rising_fraction, rate, noise };
constexpr Parameter parameters[] = {
    generator_parameters::amplitude,
    generator_parameters::frequency,
    generator_parameters::phase_difference,
    generator_parameters::phase,
    generator_parameters::offset,
    Parameter{"rising_fraction", Unit::ratio, raw(Unit::ratio, 1, 2), raw(Unit::ratio, 2, 10), raw(Unit::ratio, 8, 10),
              "Which part of a swing the joint takes to go up. Part of the period in which the angle grows; 0.5 is the "
              "sine."},
    generator_parameters::rate,
    generator_parameters::noise(0),
};

class AsymmetricWave final : public SmoothWave {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

 private:
  static constexpr Declaration about{13,
                                     "PatternGenerator_asymmetric_wave",
                                     "wave that rises faster or more slowly than it falls",
                                     parameters,
                                     wave_values,
                                     wave_frame};

  enum OwnDerived : std::uint8_t { joint_phase = first_wave_derived, warp };
  static_assert(warp + PhaseWarp::derived_size <= max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    derived[joint_phase] = add_wrapping(travelled_phase(context.joint, values[phase_step]), values[phase_shift]);
    PhaseWarp::derive(values[rising_fraction], derived + warp);
    derive_wave(context, values[rate], 1, derived);
  }

  [[nodiscard]] Target target(const Tuning& tuning) const override {
    return {tuning.parameters[amplitude], tuning.derived[joint_phase], tuning.parameters[offset]};
  }

  [[nodiscard]] std::optional<std::int32_t> lead_over(const JointContext& context, const Tuning& tuning,
                                                      unsigned joint) const override {
    return travelled_phase(context.joint - joint, tuning.parameters[phase_step]);
  }

  /// Half a turn of the sine, from trough to crest, lasts rising_fraction of the period; the other half lasts the rest.
  [[nodiscard]] std::uint32_t warped(const Tuning& tuning, std::uint32_t phase) const override {
    constexpr std::uint32_t quarter = 0x40000000U;
    return PhaseWarp(tuning.parameters[rising_fraction], tuning.derived + warp).angle_of(phase + quarter) - quarter;
  }
};

constexpr AsymmetricWave instance;

}  // namespace

const ActuationModule& pattern_generator_asymmetric_wave() { return instance; }

}  // namespace proleg
