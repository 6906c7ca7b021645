#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { amplitude, frequency, phase_step, phase_shift, offset };
constexpr Parameter parameters[] = {
    generator_parameters::amplitude, generator_parameters::frequency, generator_parameters::phase_difference,
    generator_parameters::phase,     generator_parameters::offset,
};
constexpr InternalValue internal_values[] = {
    PatternGenerator::phase_value,
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
};
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}};

constexpr Declaration about{
    2,    "PatternGenerator_sinusoidal", "sine with one clock for all joints (eq. 3.1)", parameters, internal_values,
    frame};

class Sinusoidal final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    state[current_phase] = phase_at(surroundings.tick, tuning);
  }

  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* state) const override {
    const std::int32_t swing =
        multiply(tuning.parameters[amplitude], sine(static_cast<std::uint32_t>(state[current_phase])), 30);
    return add_saturating(swing, tuning.parameters[offset]);
  }

 private:
  enum OwnDerived : std::uint8_t { joint_phase = first_own_derived };

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    const std::uint32_t travelled = std::uint32_t{context.joint} * static_cast<std::uint32_t>(values[phase_step]);
    derived[joint_phase] = add_wrapping(static_cast<std::int32_t>(travelled), values[phase_shift]);
  }

  void reset_pattern(const JointContext& /*context*/, const Tuning& tuning, std::int32_t* state) const override {
    state[current_phase] = tuning.derived[joint_phase];
  }

  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* /*state*/,
                       std::int32_t* next) const override {
    next[current_phase] = phase_at(surroundings.tick + 1, tuning);
  }

  static std::int32_t phase_at(std::uint32_t tick, const Tuning& tuning) {
    const std::uint32_t clock = tick * static_cast<std::uint32_t>(tuning.derived[phase_increment]);
    return add_wrapping(static_cast<std::int32_t>(clock), tuning.derived[joint_phase]);
  }
};

constexpr Sinusoidal instance;

}  // namespace

const ActuationModule& pattern_generator_sinusoidal() { return instance; }

}  // namespace proleg
