#include "shared/gait/pattern_generator.hpp"

#include <algorithm>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {

std::int32_t phase_increment_of(std::int32_t frequency, std::uint32_t tick_period_us) {
  // 2^32 / 2^24 = 2^8 steps of phase for a step of frequency in a second.
  return static_cast<std::int32_t>(
      static_cast<std::uint32_t>(divide_nearest(std::int64_t{frequency} * tick_period_us * 256, 1'000'000)));
}

void PatternGenerator::derive(const JointContext& context, const std::int32_t* parameters,
                              std::int32_t* derived) const {
  derived[phase_increment] = phase_increment_of(nominal_frequency(parameters), context.tick_period_us);
  derived[ticks_per_second] =
      saturate(divide_nearest(std::int64_t{1'000'000} << 16U, std::int64_t{context.tick_period_us}));
  derive_pattern(context, parameters, derived);
}

void PatternGenerator::reset(const JointContext& context, const Tuning& tuning, Pcg32& noise,
                             std::int32_t* state) const {
  reset_pattern(context, tuning, state);
  const Declaration& about = declaration();
  const auto parameter =
      std::ranges::find_if(about.parameters, [](const Parameter& each) { return is_noise(each.name); });
  if (parameter == about.parameters.end()) {
    return;
  }
  const std::int32_t level = tuning.parameters[parameter - about.parameters.begin()];
  for (std::size_t i = 0; i < about.internal_values.size(); ++i) {
    const InternalValue& value = about.internal_values[i];
    if (value.noise_scale != 0) {
      const std::int32_t deviation = saturate(shift_right_rounding(std::int64_t{value.noise_scale} * level, 28));
      const std::int64_t sample = shift_right_rounding(std::int64_t{deviation} * noise.gaussian(), 16);
      state[i] =
          wraps(value.unit) ? add_wrapping(state[i], static_cast<std::int32_t>(sample)) : saturate(state[i] + sample);
    }
  }
}

void PatternGenerator::advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                               std::int32_t* next) const {
  advance_pattern(surroundings, tuning, state, next);
  // The product of turns/tick in Q32 and ticks/s in Q16 is in Q48, and the frequency in Q24.
  next[measured_frequency] = saturate(shift_right_rounding(
      multiply_wide(subtract_wrapping(next[current_phase], state[current_phase]), tuning.derived[ticks_per_second]),
      24));
  next[measured_phase_difference] =
      surroundings.behind.present() ? subtract_wrapping(surroundings.behind.value(phase_field), state[current_phase])
                                    : 0;
}

std::optional<std::int32_t> PatternGenerator::phase_beside_neighbour(const Surroundings& surroundings,
                                                                     std::int32_t phase_difference) {
  const Neighbour& neighbour = surroundings.ahead.present() ? surroundings.ahead : surroundings.behind;
  if (!neighbour.present()) {
    return std::nullopt;
  }
  const std::uint32_t distance = surroundings.context.joint - neighbour.joint();
  const std::uint32_t step = distance * static_cast<std::uint32_t>(phase_difference);
  return add_wrapping(neighbour.value(phase_field), static_cast<std::int32_t>(step));
}

void PatternGenerator::extrapolate(const Tuning& tuning, const std::int32_t* /*state*/, StateFrame& frame) const {
  const std::int32_t last = unpack(declaration(), phase_field, frame);
  repack(declaration(), phase_field, add_wrapping(last, tuning.derived[phase_increment]), frame);
}

}  // namespace proleg
