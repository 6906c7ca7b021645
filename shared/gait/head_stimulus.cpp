#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/sine.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t { amplitude, frequency, phase_step, phase_shift, offset, retreat, sensor };
constexpr Parameter parameters[] = {
    generator_parameters::amplitude,
    generator_parameters::frequency,
    generator_parameters::phase_difference,
    generator_parameters::phase,
    generator_parameters::offset,
    Parameter{
        "retreat", Unit::count, 300, 0, 60'000,
        "How long the robot goes back after a touch. Ticks for which the wave stays reversed after the last touch."},
    Parameter{"sensor", Unit::count, 2, 1, 3, "Which sensor of the head counts. 1 rear, 2 front, 3 either."},
};

enum Values : std::uint8_t { retreat_ticks = PatternGenerator::first_own_value };
constexpr InternalValue internal_values[] = {
    InternalValue{"current_phase", Unit::phase_degree, 0, "phase of the wave, without the parameter `phase`"},
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
    InternalValue{"retreat_ticks", Unit::count, 0, "ticks that the retreat continues without another touch"},
};
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}, FrameField{retreat_ticks, 2}};
constexpr std::size_t retreat_field = 1;

constexpr Declaration about{15,
                            "PatternGenerator_head_stimulus",
                            "sine whose wave runs backwards for a while after something touched the head",
                            parameters,
                            internal_values,
                            frame};

class HeadStimulus final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }
  [[nodiscard]] bool senses_contacts() const override { return true; }

  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    const Neighbour& neighbour = surroundings.ahead.present() ? surroundings.ahead : surroundings.behind;
    if (neighbour.present()) {
      state[current_phase] = *phase_beside_neighbour(surroundings, tuning.parameters[phase_step]);
      state[retreat_ticks] = neighbour.value(retreat_field);
    } else {
      const std::uint32_t since_start = surroundings.tick * static_cast<std::uint32_t>(tuning.derived[phase_increment]);
      state[current_phase] = add_wrapping(state[current_phase], static_cast<std::int32_t>(since_start));
    }
  }

  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* state) const override {
    const std::int32_t argument = add_wrapping(state[current_phase], tuning.parameters[phase_shift]);
    const std::int32_t swing = multiply(tuning.parameters[amplitude], sine(static_cast<std::uint32_t>(argument)), 30);
    return add_saturating(swing, tuning.parameters[offset]);
  }

  /// The neighbour's wave is taken to run in the direction of the joint's own wave.
  void extrapolate(const Tuning& tuning, const std::int32_t* state, StateFrame& missed) const override {
    repack(about, phase_field, moved(unpack(about, phase_field, missed), state[retreat_ticks] > 0, tuning), missed);
    repack(about, retreat_field, unpack(about, retreat_field, missed) - 1, missed);  // repack() cuts it at 0
  }

 private:
  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& /*context*/, const std::int32_t* /*values*/,
                      std::int32_t* /*derived*/) const override {}

  void reset_pattern(const JointContext& context, const Tuning& tuning, std::int32_t* state) const override {
    const std::uint32_t travelled =
        std::uint32_t{context.joint} * static_cast<std::uint32_t>(tuning.parameters[phase_step]);
    state[current_phase] = static_cast<std::int32_t>(travelled);
  }

  /// A joint takes the state of the joint ahead of it. So a joint that missed a touch, or was disturbed, is right again
  /// a tick later.
  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const override {
    const bool follows = surroundings.ahead.present();
    // The value is limited, because the parameter may have been lowered or the counter overwritten.
    const std::int32_t left = std::clamp<std::int32_t>(
        follows ? surroundings.ahead.value(retreat_field) : state[retreat_ticks], 0, tuning.parameters[retreat]);
    const bool is_touched = touches_head(surroundings.contacts, tuning.parameters[sensor]);
    next[retreat_ticks] = is_touched ? tuning.parameters[retreat] : std::max<std::int32_t>(left - 1, 0);
    const std::int32_t phase =
        follows ? *phase_beside_neighbour(surroundings, tuning.parameters[phase_step]) : state[current_phase];
    next[current_phase] = moved(phase, next[retreat_ticks] > 0, tuning);
  }

  static bool touches_head(const Contacts& contacts, std::int32_t sensors) {
    return ((sensors & 1) != 0 && contacts.pressed(0, TouchSensor::rear)) ||
           ((sensors & 2) != 0 && contacts.pressed(0, TouchSensor::front));
  }

  /// The phase a tick later.
  static std::int32_t moved(std::int32_t phase, bool backwards, const Tuning& tuning) {
    const std::int32_t step = tuning.derived[phase_increment];
    return backwards ? subtract_wrapping(phase, step) : add_wrapping(phase, step);
  }
};

constexpr HeadStimulus instance;

}  // namespace

const ActuationModule& pattern_generator_head_stimulus() { return instance; }

}  // namespace proleg
