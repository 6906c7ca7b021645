#include "shared/gait/smooth_wave.hpp"

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/sine.hpp"

namespace proleg {

void SmoothWave::derive_wave(const JointContext& context, std::int32_t rate, std::int32_t harmonic,
                             std::int32_t* derived) {
  derived[clock_increment] = derived[phase_increment];
  derived[phase_increment] = static_cast<std::int32_t>(static_cast<std::uint32_t>(derived[clock_increment]) *
                                                       static_cast<std::uint32_t>(harmonic));
  make_critical_filter(rate, context.tick_period_us).store(derived + filter_constants);
}

std::int32_t SmoothWave::multiple(const Tuning& /*tuning*/) const { return 1; }

std::uint32_t SmoothWave::warped(const Tuning& /*tuning*/, std::uint32_t phase) const { return phase; }

void SmoothWave::rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const {
  const Target wave = target(tuning);
  state[current_amplitude] = wave.amplitude;
  state[current_offset] = wave.offset;
  state[current_shift] = wave.shift;
  const std::uint32_t since_start = surroundings.tick * static_cast<std::uint32_t>(tuning.derived[phase_increment]);
  state[current_phase] = add_wrapping(static_cast<std::int32_t>(since_start), state[current_shift]);
  const Neighbour& neighbour = surroundings.ahead.present() ? surroundings.ahead : surroundings.behind;
  if (neighbour.present()) {
    if (const auto lead = lead_over(surroundings.context, tuning, neighbour.joint())) {
      state[current_phase] = add_wrapping(neighbour.value(phase_field), *lead);
    }
  }
  // Several values of the clock give this phase. The angle of the joint is the same for all of them.
  const std::int32_t harmonic = multiple(tuning);
  state[clock] = subtract_wrapping(state[current_phase], state[current_shift]) / harmonic;
  state[current_phase] = add_wrapping(state[clock] * harmonic, state[current_shift]);
}

std::int32_t SmoothWave::output(const Tuning& tuning, const std::int32_t* state) const {
  const std::uint32_t argument = warped(tuning, static_cast<std::uint32_t>(state[current_phase]));
  return add_saturating(multiply(state[current_amplitude], sine(argument), 30), state[current_offset]);
}

void SmoothWave::reset_pattern(const JointContext& /*context*/, const Tuning& tuning, std::int32_t* state) const {
  state[current_shift] = target(tuning).shift;
  state[current_phase] = state[current_shift];
}

void SmoothWave::advance_pattern(const Surroundings& /*surroundings*/, const Tuning& tuning, const std::int32_t* state,
                                 std::int32_t* next) const {
  const CriticalFilter filter = CriticalFilter::load(tuning.derived + filter_constants);
  const Target wave = target(tuning);
  follow(filter, wave.amplitude, state + current_amplitude, next + current_amplitude);
  follow(filter, wave.offset, state + current_offset, next + current_offset);

  next[shift_rate] = state[shift_rate];
  next[current_shift] = add_wrapping(
      wave.shift, proleg::advance(filter, subtract_wrapping(state[current_shift], wave.shift), next[shift_rate]));

  next[clock] = add_wrapping(state[clock], tuning.derived[clock_increment]);
  const std::uint32_t argument = static_cast<std::uint32_t>(next[clock]) * static_cast<std::uint32_t>(multiple(tuning));
  next[current_phase] = add_wrapping(static_cast<std::int32_t>(argument), next[current_shift]);
}

}  // namespace proleg
