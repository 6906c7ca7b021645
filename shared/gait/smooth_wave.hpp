#pragma once

#include <optional>

#include "shared/gait/critical_filter.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {

/// A pattern generator whose joint follows a wave: amplitude * shape(phase) + offset. The phase is a whole multiple of
/// a clock plus a shift; the clock is accumulated over the ticks, so the phase is continuous when the frequency
/// changes. Amplitude, shift and offset approach their targets through critically damped filters; amplitude and offset
/// start at 0. So no change of a parameter makes the joint jump.
///
/// Its declaration must have the internal values `wave_values`, and its frame must be `wave_frame`.
class SmoothWave : public PatternGenerator {
 public:
  enum Value : std::uint8_t {
    clock = first_own_value,
    current_amplitude,
    amplitude_rate,
    current_shift,
    shift_rate,
    current_offset,
    offset_rate,
  };

  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const final;
  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* state) const final;

 protected:
  ~SmoothWave() = default;

  /// The constants that the class derives for itself. An algorithm writes its own from first_wave_derived on.
  enum Derived : std::uint8_t {
    clock_increment = first_own_derived,
    filter_constants,
    first_wave_derived = filter_constants + CriticalFilter::derived_size,
  };

  static constexpr InternalValue wave_values[] = {
      phase_value,
      frequency_value,
      phase_difference_value,
      InternalValue{"clock", Unit::phase_degree, 0, "phase accumulated over the ticks"},
      generator_values::current_amplitude(raw(Unit::degree, 5)),
      generator_values::amplitude_rate,
      InternalValue{"current_shift", Unit::phase_degree, raw(Unit::degree, 30), "filtered phase of the joint"},
      InternalValue{"shift_rate", Unit::degree, 0, "its change in a second, times 2 / rate"},
      generator_values::current_offset(raw(Unit::degree, 5)),
      generator_values::offset_rate,
  };
  static constexpr FrameField wave_frame[] = {FrameField{current_phase, 4}};

  /// The values that the joint's wave approaches.
  struct Target {
    std::int32_t amplitude;  ///< 90 degrees = 2^30; negative: the wave is upside down
    std::int32_t shift;      ///< phase of the joint at tick 0
    std::int32_t offset;
  };

  /// Derives the class's constants. rate: of the filters, in Q24 1/s. A generator calls it at the end of
  /// derive_pattern(), when derived[phase_increment] is the increment of the clock.
  static void derive_wave(const JointContext& context, std::int32_t rate, std::int32_t harmonic, std::int32_t* derived);

  /// The phase that phase_difference adds up to over a number of joints, which may be negative modulo 2^32.
  [[nodiscard]] static std::int32_t travelled_phase(std::uint32_t joints, std::int32_t phase_difference) {
    return static_cast<std::int32_t>(joints * static_cast<std::uint32_t>(phase_difference));
  }

 private:
  [[nodiscard]] virtual Target target(const Tuning& tuning) const = 0;
  /// The multiple of the clock with which the joint oscillates.
  [[nodiscard]] virtual std::int32_t multiple(const Tuning& tuning) const;
  /// The joint's phase minus that of another joint of the group, if all have the same parameters; nothing if the two
  /// run at different frequencies.
  [[nodiscard]] virtual std::optional<std::int32_t> lead_over(const JointContext& context, const Tuning& tuning,
                                                              unsigned joint) const = 0;
  /// The argument of the sine that is the wave's shape.
  [[nodiscard]] virtual std::uint32_t warped(const Tuning& tuning, std::uint32_t phase) const;

  void reset_pattern(const JointContext& context, const Tuning& tuning, std::int32_t* state) const final;
  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const final;
};

}  // namespace proleg
