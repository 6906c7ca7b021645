#pragma once

#include <optional>

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// An algorithm that produces a periodic signal (thesis, section 5.2.1 and listing A.2). The base class measures
/// frequency and phase difference to the next joint in each tick, adds seeded Gaussian noise to the internal values at
/// reset, and extrapolates the phase of a neighbour whose frame is lost.
///
/// Its declaration must start with the three internal values below, its frame with the phase on four bytes. Its first
/// derived constant is the phase increment.
class PatternGenerator : public ActuationModule {
 public:
  /// The first internal values of every pattern generator.
  enum Value : std::uint8_t {
    current_phase,              ///< argument of the periodic signal
    measured_frequency,         ///< change of the phase over the last tick
    measured_phase_difference,  ///< phase of the next joint of the group minus the own; 0 for the last joint
    first_own_value
  };
  static constexpr InternalValue phase_value{"current_phase", Unit::phase_degree, 0, "argument of the periodic signal"};
  static constexpr InternalValue frequency_value{"measured_frequency", Unit::hertz, 0, "measured frequency"};
  static constexpr InternalValue phase_difference_value{"measured_phase_difference", Unit::phase_degree, 0,
                                                        "measured phase difference to the next joint towards the tail"};
  static constexpr std::size_t phase_field = 0;

  /// The first derived constants of every pattern generator.
  enum Derived : std::uint8_t {
    phase_increment,   ///< change of the phase in a tick, 2^32 = one turn
    ticks_per_second,  ///< Q16
    first_own_derived
  };

  void derive(const JointContext& context, const std::int32_t* parameters, std::int32_t* derived) const final;
  void reset(const JointContext& context, const Tuning& tuning, Pcg32& noise, std::int32_t* state) const final;
  void advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
               std::int32_t* next) const final;
  /// Advances the phase by the increment.
  void extrapolate(const Tuning& tuning, const std::int32_t* state, StateFrame& frame) const override;

 protected:
  ~PatternGenerator() = default;

  /// The phase that a joint has beside a neighbour when the phase grows by phase_difference from joint to joint. It is
  /// computed from the neighbour ahead if that is present, else from the one behind; nothing if none is present.
  [[nodiscard]] static std::optional<std::int32_t> phase_beside_neighbour(const Surroundings& surroundings,
                                                                          std::int32_t phase_difference);

  /// How far a neighbour's phase is ahead of the phase that fits the joint's own phase, when the phase grows by
  /// phase_difference from joint to joint. The neighbour must be present.
  [[nodiscard]] static std::uint32_t lead_of(const Neighbour& neighbour, const JointContext& context,
                                             std::int32_t phase_difference, std::int32_t own_phase) {
    const std::uint32_t distance = neighbour.joint() - context.joint;
    const std::uint32_t wanted = distance * static_cast<std::uint32_t>(phase_difference);
    return static_cast<std::uint32_t>(neighbour.value(phase_field)) - static_cast<std::uint32_t>(own_phase) - wanted;
  }

 private:
  /// The generator's nominal frequency, in Q24 hertz.
  [[nodiscard]] virtual std::int32_t nominal_frequency(const std::int32_t* parameters) const = 0;
  /// Writes the derived constants from `first_own_derived` on. The phase increment is that of the nominal frequency;
  /// a generator whose phase runs at a multiple of it corrects it here.
  virtual void derive_pattern(const JointContext& context, const std::int32_t* parameters,
                              std::int32_t* derived) const = 0;
  /// Writes state 0, as ActuationModule::reset() does, without the noise.
  virtual void reset_pattern(const JointContext& context, const Tuning& tuning, std::int32_t* state) const = 0;
  /// Computes state k + 1, as ActuationModule::advance() does, for all values except the two measured ones.
  virtual void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                               std::int32_t* next) const = 0;
};

/// Phase increment of a tick: the integer nearest to 2^32 * frequency * tick. frequency: Q24 hertz. The rounding makes
/// the phase drift by at most half a step a tick (0.0151 degrees an hour at 10 ms), equally in all modules and in the
/// simulator.
[[nodiscard]] std::int32_t phase_increment_of(std::int32_t frequency, std::uint32_t tick_period_us);

}  // namespace proleg
