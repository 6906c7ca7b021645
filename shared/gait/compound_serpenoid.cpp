#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/smooth_wave.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t {
  pitch_amplitude,
  pitch_frequency,
  pitch_phase_difference,
  pitch_offset,
  yaw_amplitude,
  yaw_frequency,
  yaw_phase_difference,
  yaw_offset,
  yaw_phase,
  amplitude_slope,
  yaw_parity,
  rate,
  noise,
};

constexpr Parameter amplitude_of(ParameterName name, HostText help) {
  return {name, Unit::degree, raw(Unit::degree, 23), 0, quarter_turn, help};
}
constexpr Parameter frequency_of(ParameterName name, HostText help) {
  return {name, Unit::hertz, raw(Unit::hertz, 8, 10), 0, raw(Unit::hertz, 20), help};
}
constexpr Parameter phase_difference_of(ParameterName name, HostText help) {
  return {name, Unit::phase_degree, raw(Unit::phase_degree, 29), phase_minimum, phase_maximum, help};
}

// The defaults are the sidewinding gait of the modular snake robots of Carnegie Mellon University.
constexpr Parameter parameters[] = {
    amplitude_of("pitch_amplitude", "How far the joints swing up and down."),
    frequency_of("pitch_frequency", "How many times the joints swing up and down in a second."),
    phase_difference_of(
        "pitch_phase_difference",
        "How far the up and down wave runs ahead from joint to joint. Phase from joint to joint of the whole chain."),
    Parameter{"pitch_offset", Unit::degree, 0, -quarter_turn, quarter_turn,
              "How far the body bends upwards all the time. Angle added to the joints that pitch."},
    amplitude_of("yaw_amplitude", "How far the joints swing to the sides."),
    frequency_of("yaw_frequency", "How many times the joints swing to the sides in a second."),
    phase_difference_of(
        "yaw_phase_difference",
        "How far the sideways wave runs ahead from joint to joint. Phase from joint to joint of the whole chain."),
    Parameter{"yaw_offset", Unit::degree, 0, -quarter_turn, quarter_turn,
              "How strongly the robot turns. Angle added to the joints that yaw."},
    Parameter{"yaw_phase", Unit::phase_degree, raw(Unit::phase_degree, 45), phase_minimum, phase_maximum,
              "How far the sideways wave is ahead of the up and down wave. Phase between the two."},
    Parameter{"amplitude_slope", Unit::degree, 0, raw(Unit::degree, -10), raw(Unit::degree, 10),
              "How much wider each joint swings than the one in front of it. Added to both amplitudes from joint to "
              "joint towards the tail."},
    Parameter{"yaw_parity", Unit::count, 1, 0, 1,
              "Which joints swing to the sides. 0: joints 0, 2, ... from the head; 1: joints 1, 3, ..."},
    generator_parameters::rate,
    generator_parameters::noise(0),
};

class CompoundSerpenoid final : public SmoothWave {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

 private:
  static constexpr Declaration about{7,
                                     "PatternGenerator_compound_serpenoid",
                                     "two waves, one of the pitch and one of the yaw joints",
                                     parameters,
                                     wave_values,
                                     wave_frame};

  enum OwnDerived : std::uint8_t { joint_amplitude = first_wave_derived, joint_phase, joint_offset };
  static_assert(joint_offset < max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[pitch_frequency];
  }

  static bool yaws(unsigned joint, const std::int32_t* values) {
    return joint % 2 == static_cast<unsigned>(values[yaw_parity]);
  }

  static std::int32_t phase_of(unsigned joint, const std::int32_t* values) {
    return yaws(joint, values) ? add_wrapping(travelled_phase(joint, values[yaw_phase_difference]), values[yaw_phase])
                               : travelled_phase(joint, values[pitch_phase_difference]);
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    const bool yaw = yaws(context.joint, values);
    if (yaw) {
      derived[phase_increment] = phase_increment_of(values[yaw_frequency], context.tick_period_us);
    }
    const std::int64_t grown =
        (yaw ? values[yaw_amplitude] : values[pitch_amplitude]) + std::int64_t{context.joint} * values[amplitude_slope];
    derived[joint_amplitude] = std::clamp(saturate(grown), std::int32_t{0}, quarter_turn);
    derived[joint_phase] = phase_of(context.joint, values);
    derived[joint_offset] = yaw ? values[yaw_offset] : values[pitch_offset];
    derive_wave(context, values[rate], 1, derived);
  }

  [[nodiscard]] Target target(const Tuning& tuning) const override {
    return {tuning.derived[joint_amplitude], tuning.derived[joint_phase], tuning.derived[joint_offset]};
  }

  [[nodiscard]] std::optional<std::int32_t> lead_over(const JointContext& context, const Tuning& tuning,
                                                      unsigned joint) const override {
    const std::int32_t* values = tuning.parameters;
    if (yaws(joint, values) != yaws(context.joint, values) && values[pitch_frequency] != values[yaw_frequency]) {
      return std::nullopt;
    }
    return subtract_wrapping(phase_of(context.joint, values), phase_of(joint, values));
  }
};

constexpr CompoundSerpenoid instance;

}  // namespace

const ActuationModule& pattern_generator_compound_serpenoid() { return instance; }

}  // namespace proleg
