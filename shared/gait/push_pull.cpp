#include <algorithm>
#include <bit>
#include <iterator>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/exponential.hpp"
#include "shared/fixed/polar.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/critical_filter.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/pattern_generator.hpp"
#include "shared/gait/rulkov_neuron.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t {
  amplitude,
  frequency,
  phase_step,
  offset,
  mutual_inhibition,
  next_inhibition,
  next_excitation,
  rate,
  noise
};
constexpr Parameter parameters[] = {
    Parameter{
        "amplitude", Unit::degree, raw(Unit::degree, 40), 0, quarter_turn,
        "How far the joint swings to each side. Exact at 1 Hz; slower bursts swing further, faster ones less far."},
    Parameter{"frequency", Unit::hertz, raw(Unit::hertz, 1), raw(Unit::hertz, 1, 20), raw(Unit::hertz, 13, 10),
              "How many times the joint swings in a second. Frequency of the bursts; acts as at most 0.0022 for an "
              "iteration of the neurons."},
    generator_parameters::phase_difference,
    generator_parameters::offset,
    Parameter{"mutual_inhibition", Unit::ratio, raw(Unit::ratio, 12, 10), raw(Unit::ratio, 1, 10), raw(Unit::ratio, 2),
              "How firmly the two muscles of a joint take turns. Conductance of the synapses between its promotor and "
              "its remotor."},
    Parameter{"next_inhibition", Unit::ratio, raw(Unit::ratio, 3, 10), 0, raw(Unit::ratio, 1),
              "How strongly the joint in front holds this one back. Conductance of the inhibitory synapses from the "
              "joint in front of the wave."},
    Parameter{"next_excitation", Unit::ratio, raw(Unit::ratio, 2, 10), 0, raw(Unit::ratio, 1),
              "How strongly the joint in front pulls this one along. Conductance of the excitatory synapses from that "
              "joint."},
    generator_parameters::rate,
    generator_parameters::noise(raw(Unit::ratio, 1)),
};

enum Values : std::uint8_t {
  promotor_x = PatternGenerator::first_own_value,
  promotor_y,
  remotor_x,
  remotor_y,
  activity,
  own_receptors,
  next_receptors,
  promotor_history,
  promotor_history_2,
  remotor_history,
  remotor_history_2,
  smoothed,
  output_level,
  current_amplitude,
  amplitude_rate,
  current_offset,
  offset_rate,
};
constexpr InternalValue internal_values[] = {
    InternalValue{PatternGenerator::phase_value.name, Unit::phase_degree, 0, "phase of output_level"},
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
    InternalValue{"promotor_x", Unit::ratio, raw(Unit::ratio, 1, 40), "membrane potential of the promotor / 4"},
    InternalValue{"promotor_y", Unit::ratio, raw(Unit::ratio, 1, 20), "slow variable of the promotor / 4"},
    InternalValue{"remotor_x", Unit::ratio, raw(Unit::ratio, 1, 40), "membrane potential of the remotor / 4"},
    InternalValue{"remotor_y", Unit::ratio, raw(Unit::ratio, 1, 20), "slow variable of the remotor / 4"},
    InternalValue{
        "activity", Unit::count, 0,
        "bits 0, 1: promotor, remotor released transmitter in the tick; bits 2-4, 5-7: iterations it lasts on"},
    InternalValue{"own_receptors", Unit::count, 0,
                  "open receptors of the remotor's and, in the low half, the promotor's transmitter, of 65536"},
    InternalValue{"next_receptors", Unit::count, 0, "the same for the transmitter of the joint that drives this one"},
    InternalValue{"promotor_history", Unit::count, 0, "ticks in which that joint's promotor released: a bit each"},
    InternalValue{"promotor_history_2", Unit::count, 0, "the 32 bits before"},
    InternalValue{"remotor_history", Unit::count, 0, "the same for its remotor"},
    InternalValue{"remotor_history_2", Unit::count, 0, "the 32 bits before"},
    InternalValue{"smoothed", Unit::ratio, 0, "promotor's minus remotor's activity, filtered once"},
    InternalValue{"output_level", Unit::ratio, 0, "filtered twice"},
    generator_values::current_amplitude(),
    generator_values::amplitude_rate,
    generator_values::current_offset(),
    generator_values::offset_rate,
};
static_assert(std::size(internal_values) <= max_internal_values);
enum Fields : std::uint8_t { phase_sent, activity_sent };
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}, FrameField{activity, 1}};

constexpr Declaration about{11,
                            "PatternGenerator_push_pull",
                            "push-pull network of bursting neurons (Rulkov maps)",
                            parameters,
                            internal_values,
                            frame};

constexpr std::int32_t one = raw(Unit::ratio, 1);

/// Number of iterations for which a spike releases transmitter.
constexpr std::uint32_t release_time = 5;
/// Number of iterations by which the wave is behind the joint that drives it, without a delay.
constexpr std::int64_t synaptic_delay = 20;
constexpr unsigned history_bits = 64;

/// mu times the period of the bursts in iterations, in Q20, for 0, 1, 2, ... bursts in 4096 iterations, with the
/// default conductances. The numbers are from a model in double precision.
constexpr std::int32_t mu_times_period[] = {1174405, 1258825, 1331167, 1385169, 1407189,
                                            1420820, 1434452, 1432355, 1437073, 1444938};

class PushPull final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void rejoin(const Surroundings& /*surroundings*/, const Tuning& tuning, std::int32_t* state) const override {
    // The synapses pull the new joint into the rhythm within a few bursts.
    state[current_amplitude] = tuning.parameters[amplitude];
    state[current_offset] = tuning.parameters[offset];
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    // Bursts of 1 Hz, with the pauses between them, have the amplitude 0.570 behind both filters.
    constexpr std::int32_t inverse_gain = 470939397;  // 1 / 0.570 in Q28
    const std::int32_t share = saturate(shift_right_rounding(multiply_wide(state[output_level], inverse_gain), 28));
    const std::int64_t swing = shift_right_rounding(multiply_wide(state[current_amplitude], share), 28);
    return saturate(swing + state[current_offset]);
  }

 private:
  enum OwnDerived : std::uint8_t {
    mu = first_own_derived,  ///< Q31
    iterations,              ///< number of iterations in a tick
    filter_step,             ///< part of the way that a smoothing filter goes in a tick, Q30
    delay,                   ///< bit of the history; bit 8: promotor and remotor exchanged; bit 9: driven from behind
    history_period_mask,     ///< the history moves on at ticks of which these bits are 0
    filter_constants,
  };
  static_assert(filter_constants + CriticalFilter::derived_size <= max_derived);
  static constexpr std::int32_t exchanged = 1 << 8;
  static constexpr std::int32_t from_behind = 1 << 9;

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    derive_network(context, values, derived);
    make_critical_filter(values[rate], context.tick_period_us).store(derived + filter_constants);
  }

  [[gnu::noinline]] static void derive_network(const JointContext& context, const std::int32_t* values,
                                               std::int32_t* derived) {
    // One iteration takes about 1.7 ms: a tick of 10 ms has instructions for no more of them.
    const std::uint32_t count = std::clamp<std::uint32_t>((context.tick_period_us + 833U) / 1667U, 1U, 6U);
    derived[iterations] = static_cast<std::int32_t>(count);

    // Bursts in an iteration are in Q36: at most 9 / 4096.
    constexpr std::int64_t most_bursts = std::int64_t{9} << 24U;
    const std::int64_t bursts =
        std::clamp(divide_nearest((std::int64_t{values[Parameters::frequency]} * context.tick_period_us) << 12U,
                                  1'000'000 * std::int64_t{count}),
                   std::int64_t{1}, most_bursts - 1);
    const auto place = static_cast<std::size_t>(bursts >> 24U);
    const std::int64_t fraction = bursts & 0xFFFFFF;
    const std::int64_t product =
        mu_times_period[place] +
        ((std::int64_t{mu_times_period[place + 1]} - mu_times_period[place]) * fraction >> 24U);
    derived[mu] = static_cast<std::int32_t>(shift_right_rounding(bursts * product, 25));  // Q36 * Q20 to Q31

    // The filters' time constant is 1 / (2 pi) of a period.
    constexpr std::int64_t two_pi = 411774;                                        // Q16
    const std::int64_t angle = shift_right_rounding(bursts * count * two_pi, 28);  // angle of a tick, Q24
    derived[filter_step] = (1 << 30) - exponential_decay(saturate(angle));

    set_delay(context, values, bursts, count, derived);
  }

  /// The wave reaches a joint from the side on which the phase is ahead.
  static void set_delay(const JointContext& context, const std::int32_t* values, std::int64_t bursts,
                        std::uint32_t count, std::int32_t* derived) {
    const bool behind = values[phase_step] > 0;
    const int driver = behind ? context.group.after(context.joint) : context.group.before(context.joint);
    const std::uint32_t distance =
        driver < 0 ? 1U : static_cast<std::uint32_t>(behind ? driver - context.joint : context.joint - driver);
    const auto step = static_cast<std::uint32_t>(values[phase_step]);
    std::uint32_t lag = distance * (behind ? step : 0U - step);
    std::int32_t flags = behind ? from_behind : 0;
    if (lag >= 0x80000000U) {  // half a turn later the two neurons have exchanged their roles
      lag -= 0x80000000U;
      flags |= exchanged;
    }
    // Q32 turns divided by bursts in an iteration in Q36 are iterations in Q-4.
    const std::int64_t late = (std::int64_t{lag} << 4U) / bursts - synaptic_delay;
    const std::int64_t ticks = divide_nearest(std::max(late, std::int64_t{0}), count);
    unsigned shift = 0;
    while ((ticks >> shift) >= history_bits) {
      ++shift;
    }
    derived[delay] = flags | static_cast<std::int32_t>(ticks >> shift);
    derived[history_period_mask] = (1 << shift) - 1;
  }

  void reset_pattern(const JointContext& /*context*/, const Tuning& /*tuning*/, std::int32_t* state) const override {
    // The start is between bursts, and the promotor is the first to fire.
    state[promotor_x] = -rulkov::unit;
    state[promotor_y] = -7 * rulkov::unit - rulkov::unit / 2;
    state[remotor_x] = -rulkov::unit - rulkov::unit / 4;
    state[remotor_y] = -8 * rulkov::unit;
  }

  /// The shares of open receptors of two neurons, 16 bits each, in a state value.
  struct Receptors {
    explicit Receptors(std::int32_t packed)
        : promotor(static_cast<std::uint32_t>(packed) & 0xFFFFU), remotor(static_cast<std::uint32_t>(packed) >> 16U) {}
    [[nodiscard]] std::int32_t packed() const { return static_cast<std::int32_t>(remotor << 16U | promotor); }

    std::uint32_t promotor;  ///< opened by the promotor's transmitter
    std::uint32_t remotor;
  };

  /// A neuron, and the number of iterations for which it still releases transmitter.
  struct Cell {
    rulkov::Neuron neuron;
    std::uint32_t release;
    bool was_active = false;

    void iterate(const rulkov::Synapses& open, std::int32_t mu_value) {
      const std::int32_t before = neuron.x;
      neuron = rulkov::iterate(neuron, open, mu_value);
      if (before <= 0 && neuron.x > 0) {
        release = release_time;
      } else if (release > 0) {
        --release;
      }
      if (release > 0) {
        was_active = true;
      }
    }
  };

  static Cell cell_from(std::int32_t x, std::int32_t y, std::uint32_t release) {
    return {{std::clamp(x, -rulkov::largest, rulkov::largest), std::clamp(y, -rulkov::largest, rulkov::largest)},
            std::min(release, release_time)};
  }

  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const override {
    smooth(fire(surroundings, tuning, state, next), tuning, state, next);
  }

  /// Computes the iterations of a tick. Returns the promotor's minus the remotor's activity. Not inline, because its
  /// variables would lie on the stack below those of the filters.
  [[gnu::noinline]] static std::int32_t fire(const Surroundings& surroundings, const Tuning& tuning,
                                             const std::int32_t* state, std::int32_t* next) {
    const std::int32_t* values = tuning.parameters;
    const std::int32_t* derived = tuning.derived;
    const std::uint32_t driven = listen(surroundings, derived, state, next);
    const bool next_promotor = (driven & 1U) != 0;
    const bool next_remotor = (driven & 2U) != 0;

    const auto bits = static_cast<std::uint32_t>(state[activity]);
    Cell promotor = cell_from(state[promotor_x], state[promotor_y], (bits >> 2U) & 7U);
    Cell remotor = cell_from(state[remotor_x], state[remotor_y], (bits >> 5U) & 7U);
    Receptors own(state[own_receptors]);
    Receptors far(state[next_receptors]);
    const std::uint32_t mutual = conductance_of(values[mutual_inhibition]);
    const std::uint32_t next_inhibiting = conductance_of(values[next_inhibition]);
    const std::uint32_t next_exciting = conductance_of(values[next_excitation]);
    for (std::int32_t i = 0; i < derived[iterations]; ++i) {
      // The two neurons inhibit each other. A neuron of the driving joint excites the like neuron and inhibits its
      // opponent.
      const rulkov::Synapses to_promotor{conductance(mutual, own.remotor) + conductance(next_inhibiting, far.remotor),
                                         conductance(next_exciting, far.promotor)};
      const rulkov::Synapses to_remotor{conductance(mutual, own.promotor) + conductance(next_inhibiting, far.promotor),
                                        conductance(next_exciting, far.remotor)};
      promotor.iterate(to_promotor, derived[mu]);
      remotor.iterate(to_remotor, derived[mu]);
      own.promotor = rulkov::receptors(own.promotor, promotor.release > 0);
      own.remotor = rulkov::receptors(own.remotor, remotor.release > 0);
      far.promotor = rulkov::receptors(far.promotor, next_promotor);
      far.remotor = rulkov::receptors(far.remotor, next_remotor);
    }
    next[promotor_x] = promotor.neuron.x;
    next[promotor_y] = promotor.neuron.y;
    next[remotor_x] = remotor.neuron.x;
    next[remotor_y] = remotor.neuron.y;
    next[own_receptors] = own.packed();
    next[next_receptors] = far.packed();
    next[activity] = static_cast<std::int32_t>((promotor.was_active ? 1U : 0U) | (remotor.was_active ? 2U : 0U) |
                                               promotor.release << 2U | remotor.release << 5U);
    return (promotor.was_active ? one : 0) - (remotor.was_active ? one : 0);
  }

  /// The largest conductance in Q12, from a parameter in Q28: its product with a share of receptors has 32 bits.
  static std::uint32_t conductance_of(std::int32_t parameter) { return static_cast<std::uint32_t>(parameter) >> 16U; }
  /// The conductance of open receptors in Q28.
  static std::int32_t conductance(std::uint32_t largest_conductance, std::uint32_t share) {
    return static_cast<std::int32_t>(largest_conductance * share);
  }

  /// Advances the history of the driving joint. Returns the joint's activity before the delay, as in `activity`.
  static std::uint32_t listen(const Surroundings& surroundings, const std::int32_t* derived, const std::int32_t* state,
                              std::int32_t* next) {
    const auto flags = static_cast<std::uint32_t>(derived[delay]);
    const Neighbour& driver = (flags & from_behind) != 0 ? surroundings.behind : surroundings.ahead;
    const std::uint32_t now = driver.present() ? static_cast<std::uint32_t>(driver.value(activity_sent)) : 0U;
    const bool moves_on = (surroundings.tick & static_cast<std::uint32_t>(derived[history_period_mask])) == 0;
    const unsigned bit = flags & 0xFFU;
    std::uint32_t past = record(now & 1U, moves_on, bit, state + promotor_history, next + promotor_history);
    past |= record((now >> 1U) & 1U, moves_on, bit, state + remotor_history, next + remotor_history) << 1U;
    return (flags & exchanged) != 0 ? (past >> 1U | past << 1U) & 3U : past;
  }

  static std::uint32_t record(std::uint32_t active, bool moves_on, unsigned bit, const std::int32_t* state,
                              std::int32_t* next) {
    auto recent = static_cast<std::uint32_t>(state[0]);
    auto older = static_cast<std::uint32_t>(state[1]);
    if (moves_on) {
      older = older << 1U | recent >> 31U;
      recent = recent << 1U | active;
    }
    next[0] = static_cast<std::int32_t>(recent);
    next[1] = static_cast<std::int32_t>(older);
    return ((bit < 32 ? recent >> bit : older >> (bit - 32)) & 1U);
  }

  [[gnu::noinline]] static void smooth(std::int32_t level, const Tuning& tuning, const std::int32_t* state,
                                       std::int32_t* next) {
    const std::int32_t step = tuning.derived[filter_step];
    next[smoothed] = add_saturating(state[smoothed], multiply(subtract_saturating(level, state[smoothed]), step, 30));
    next[output_level] = add_saturating(
        state[output_level], multiply(saturate(std::int64_t{next[smoothed]} - state[output_level]), step, 30));
    // With a time constant of 1 / omega, the input of a filter minus its output is a quarter of a period ahead.
    const std::int32_t ahead = saturate((std::int64_t{next[smoothed]} - next[output_level]) / 2);
    next[current_phase] = polar(ahead, next[output_level] / 2).angle;

    const CriticalFilter filter = CriticalFilter::load(tuning.derived + filter_constants);
    follow(filter, tuning.parameters[amplitude], state + current_amplitude, next + current_amplitude);
    follow(filter, tuning.parameters[offset], state + current_offset, next + current_offset);
  }
};

constexpr PushPull instance;

}  // namespace

const ActuationModule& pattern_generator_push_pull() { return instance; }

}  // namespace proleg
