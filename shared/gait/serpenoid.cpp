#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/smooth_wave.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { winding_angle, frequency, waves, turn, rate, noise };
constexpr Parameter parameters[] = {
    Parameter{"winding_angle", Unit::degree, raw(Unit::degree, 40), 0, quarter_turn,
              "How strongly the body winds. Largest angle between a link and the direction of travel."},
    generator_parameters::frequency,
    Parameter{"waves", Unit::ratio, raw(Unit::ratio, 1), raw(Unit::ratio, -4), raw(Unit::ratio, 4),
              "How many waves the body has. They run from head to tail, negative ones from tail to head."},
    Parameter{"turn", Unit::degree, 0, -quarter_turn, quarter_turn,
              "How strongly the robot turns. Angle added to each joint."},
    generator_parameters::rate,
    generator_parameters::noise(0),
};

class Serpenoid final : public SmoothWave {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

 private:
  static constexpr Declaration about{
      6,         "PatternGenerator_serpenoid", "serpenoid curve: the body winds like a snake", parameters, wave_values,
      wave_frame};

  enum OwnDerived : std::uint8_t { joint_amplitude = first_wave_derived, joint_phase, half_step };
  static_assert(half_step < max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  /// Position of a joint in the group.
  static unsigned rank(const JointContext& context, unsigned joint) {
    return (context.group & JointMask::first(joint)).size();
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    // b / 2 = pi waves / joints; half a turn is 2^31, a ratio of 1 is 2^28.
    const std::int64_t half = divide_nearest(std::int64_t{values[waves]} * 8, std::max(context.group.size(), 1U));
    derived[half_step] = static_cast<std::int32_t>(static_cast<std::uint32_t>(half));
    const std::int64_t twice_the_angle = multiply_wide(values[winding_angle], sine(static_cast<std::uint32_t>(half)));
    derived[joint_amplitude] =
        std::clamp(saturate(shift_right_rounding(twice_the_angle, 29)), -quarter_turn, quarter_turn);
    const std::uint32_t halves = 2 * rank(context, context.joint) + 1;
    derived[joint_phase] = travelled_phase(0U - halves, derived[half_step]);
    derive_wave(context, values[rate], 1, derived);
  }

  [[nodiscard]] Target target(const Tuning& tuning) const override {
    return {tuning.derived[joint_amplitude], tuning.derived[joint_phase], tuning.parameters[turn]};
  }

  [[nodiscard]] std::optional<std::int32_t> lead_over(const JointContext& context, const Tuning& tuning,
                                                      unsigned joint) const override {
    const std::uint32_t halves = 2 * (rank(context, joint) - rank(context, context.joint));
    return travelled_phase(halves, tuning.derived[half_step]);
  }
};

constexpr Serpenoid instance;

}  // namespace

const ActuationModule& pattern_generator_serpenoid() { return instance; }

}  // namespace proleg
