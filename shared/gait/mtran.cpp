#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/polar.hpp"
#include "shared/gait/algorithms.hpp"
#include "shared/gait/critical_filter.hpp"
#include "shared/gait/generator_parameters.hpp"
#include "shared/gait/matsuoka_pair.hpp"
#include "shared/gait/pattern_generator.hpp"

namespace proleg {
namespace {

enum Parameters : std::uint8_t {
  extensor_gain,
  flexor_gain,
  frequency,
  offset,
  drive,
  feedback,
  ahead_same,
  ahead_opposite,
  behind_same,
  behind_opposite,
  time_ratio,
  fatigue,
  inhibition,
  rate,
  noise,
};

constexpr Parameter gain_of(ParameterName name, HostText help) {
  return {name, Unit::degree, raw(Unit::degree, 80), 0, quarter_turn, help};
}
constexpr Parameter weight(ParameterName name, std::int32_t default_value, HostText help) {
  return {name, Unit::ratio, default_value, raw(Unit::ratio, -1), raw(Unit::ratio, 1), help};
}

constexpr Parameter parameters[] = {
    gain_of("extensor_gain",
            "How far the joint swings down. m1: angle that the output 1 of the extensor neuron takes off."),
    gain_of("flexor_gain", "How far the joint swings up. m2: angle that the output 1 of the flexor neuron adds."),
    matsuoka_parameters::frequency,
    generator_parameters::offset,
    Parameter{"drive", Unit::ratio, raw(Unit::ratio, 1), 0, raw(Unit::ratio, 2),
              "How far the joint swings to both sides. u0: constant input of both neurons; the amplitude is "
              "proportional to it."},
    Parameter{"feedback", Unit::ratio, 0, raw(Unit::ratio, -1), raw(Unit::ratio, 1),
              "How much the joint feels its own angle. k: input of the neurons at a joint angle of 90 degrees; "
              "positive pulls the joint towards 0."},
    weight("ahead_same", 0,
           "How strongly this joint copies the joint ahead. Weight of each neuron of that joint on the same neuron."),
    weight("ahead_opposite", raw(Unit::ratio, -2, 10),
           "How strongly this joint opposes the joint ahead. Weight of each neuron of that joint on the opposite "
           "neuron; a negative one holds it back."),
    weight("behind_same", 0,
           "How strongly this joint copies the joint behind. Weight of each neuron of that joint on the same neuron."),
    weight("behind_opposite", 0,
           "How strongly this joint opposes the joint behind. Weight of each neuron of that joint on the opposite "
           "neuron; a negative one holds it back."),
    matsuoka_parameters::time_ratio,
    matsuoka_parameters::fatigue,
    matsuoka_parameters::inhibition,
    generator_parameters::rate,
    generator_parameters::noise(raw(Unit::ratio, 1)),
};

enum Values : std::uint8_t {
  u1 = PatternGenerator::first_own_value,
  u2,
  v1,
  v2,
  y1_sent,
  y2_sent,
  current_extensor_gain,
  extensor_gain_rate,
  current_flexor_gain,
  flexor_gain_rate,
  current_offset,
  offset_rate,
};
constexpr InternalValue internal_values[] = {
    InternalValue{PatternGenerator::phase_value.name, Unit::phase_degree, 0,
                  "phase of y2 - y1, estimated from it and from the fatigue"},
    PatternGenerator::frequency_value,
    PatternGenerator::phase_difference_value,
    matsuoka_values::u1,
    matsuoka_values::u2,
    matsuoka_values::v1,
    matsuoka_values::v2,
    InternalValue{"y1_sent", Unit::count, 0,
                  "output of the extensor neuron in 128ths, at most 255: what neighbours receive"},
    InternalValue{"y2_sent", Unit::count, 0, "the same of the flexor neuron"},
    InternalValue{"current_extensor_gain", Unit::degree, 0, "filtered gain of the extensor neuron"},
    InternalValue{"extensor_gain_rate", Unit::degree, 0, "its change in a second, times 2 / rate"},
    InternalValue{"current_flexor_gain", Unit::degree, 0, "filtered gain of the flexor neuron"},
    InternalValue{"flexor_gain_rate", Unit::degree, 0, "its change in a second, times 2 / rate"},
    generator_values::current_offset(),
    generator_values::offset_rate,
};
enum Fields : std::uint8_t { phase_sent, y1_field, y2_field };
constexpr FrameField frame[] = {FrameField{PatternGenerator::current_phase, 4}, FrameField{y1_sent, 1},
                                FrameField{y2_sent, 1}};

constexpr Declaration about{
    12,         "PatternGenerator_mtran", "pattern generator of M-TRAN: Matsuoka neurons that feel their joint",
    parameters, internal_values,          frame};

constexpr std::int32_t one = raw(Unit::ratio, 1);

class Mtran final : public PatternGenerator {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return about; }

  void rejoin(const Surroundings& /*surroundings*/, const Tuning& tuning, std::int32_t* state) const override {
    // The neighbours pull the new joint into the rhythm; the weights decide how far it is behind them.
    state[current_extensor_gain] = tuning.parameters[extensor_gain];
    state[current_flexor_gain] = tuning.parameters[flexor_gain];
    state[current_offset] = tuning.parameters[offset];
  }

  [[nodiscard]] std::int32_t output(const Tuning& /*tuning*/, const std::int32_t* state) const override {
    const std::int64_t lowered =
        shift_right_rounding(multiply_wide(state[current_extensor_gain], std::max(state[u1], std::int32_t{0})), 28);
    const std::int64_t raised =
        shift_right_rounding(multiply_wide(state[current_flexor_gain], std::max(state[u2], std::int32_t{0})), 28);
    return saturate(state[current_offset] + raised - lowered);
  }

 private:
  enum OwnDerived : std::uint8_t {
    steps = first_own_derived,
    inverse_x = steps + MatsuokaConstants::derived_size,  ///< 1 / x in Q27
    quadrature,                                           ///< (1 + x^2) / x in Q27
    filter_constants,
  };
  static_assert(filter_constants + CriticalFilter::derived_size <= max_derived);

  [[nodiscard]] std::int32_t nominal_frequency(const std::int32_t* values) const override {
    return values[Parameters::frequency];
  }

  void derive_pattern(const JointContext& context, const std::int32_t* values, std::int32_t* derived) const override {
    const MatsuokaConstants constants = make_matsuoka_constants(
        values[Parameters::frequency], values[time_ratio], values[fatigue], values[inhibition], context.tick_period_us);
    constants.store(derived + steps);
    derived[inverse_x] = saturate(divide_nearest(std::int64_t{1} << 51U, std::int64_t{constants.x}));
    derived[quadrature] = saturate(derived[inverse_x] + (std::int64_t{constants.x} << 3U));
    make_critical_filter(values[rate], context.tick_period_us).store(derived + filter_constants);
  }

  void reset_pattern(const JointContext& /*context*/, const Tuning& /*tuning*/, std::int32_t* state) const override {
    state[u1] = one / 10;  // a symmetrical start would stay symmetrical
  }

  void advance_pattern(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const override {
    const std::int32_t* values = tuning.parameters;
    // 90 degrees are 2^30, a ratio of 1 is 2^28.
    const std::int32_t felt =
        static_cast<std::int32_t>(shift_right_rounding(multiply_wide(values[feedback], output(tuning, state)), 30));
    std::int64_t input1 = std::int64_t{values[drive]} + felt;
    std::int64_t input2 = std::int64_t{values[drive]} - felt;
    add_inputs(surroundings.ahead, values[ahead_same], values[ahead_opposite], input1, input2);
    add_inputs(surroundings.behind, values[behind_same], values[behind_opposite], input1, input2);

    MatsuokaPair pair{state[u1], state[u2], state[v1], state[v2]};
    proleg::advance(pair, tuning.derived + steps, values[fatigue], values[inhibition], saturate(input1),
                    saturate(input2));
    next[u1] = pair.u1;
    next[u2] = pair.u2;
    next[v1] = pair.v1;
    next[v2] = pair.v2;
    send(pair, tuning, next);
    follow_parameters(tuning, state, next);
  }

  // Parts of a tick. They are separate functions, because they need no stack at the same time.

  [[gnu::noinline]] static void send(const MatsuokaPair& pair, const Tuning& tuning, std::int32_t* next) {
    next[y1_sent] = as_sent(pair.y1());
    next[y2_sent] = as_sent(pair.y2());
    // T v' = -v + y: if both are sines, v2 - v1 is the quadrature component of y2 - y1.
    const std::int32_t along = pair.y2() - pair.y1();
    const std::int32_t behind = saturate(std::int64_t{pair.v2} - pair.v1);
    const std::int64_t across =
        multiply_wide(along, tuning.derived[inverse_x]) / 2 - multiply_wide(behind, tuning.derived[quadrature]) / 2;
    next[current_phase] = polar(saturate(shift_right_rounding(across, 27)), along / 2).angle;
  }

  [[gnu::noinline]] static void follow_parameters(const Tuning& tuning, const std::int32_t* state, std::int32_t* next) {
    const std::int32_t* values = tuning.parameters;
    const CriticalFilter filter = CriticalFilter::load(tuning.derived + filter_constants);
    follow(filter, values[extensor_gain], state + current_extensor_gain, next + current_extensor_gain);
    follow(filter, values[flexor_gain], state + current_flexor_gain, next + current_flexor_gain);
    follow(filter, values[offset], state + current_offset, next + current_offset);
  }

  /// Shift by which an output in Q28 becomes 128ths, which fit into a byte.
  static constexpr unsigned sent_shift = 28 - 7;
  static std::int32_t as_sent(std::int32_t output_of_neuron) {
    constexpr std::int64_t most = 255;
    return static_cast<std::int32_t>(std::min(shift_right_rounding(std::int64_t{output_of_neuron}, sent_shift), most));
  }

  [[gnu::noinline]] static void add_inputs(const Neighbour& neighbour, std::int32_t same, std::int32_t opposite,
                                           std::int64_t& input1, std::int64_t& input2) {
    if (neighbour.present()) {
      const std::int32_t its_y1 = neighbour.value(y1_field) << sent_shift;
      const std::int32_t its_y2 = neighbour.value(y2_field) << sent_shift;
      input1 += shift_right_rounding(multiply_wide(same, its_y1) + multiply_wide(opposite, its_y2), 28);
      input2 += shift_right_rounding(multiply_wide(same, its_y2) + multiply_wide(opposite, its_y1), 28);
    }
  }
};

constexpr Mtran instance;

}  // namespace

const ActuationModule& pattern_generator_mtran() { return instance; }

}  // namespace proleg
