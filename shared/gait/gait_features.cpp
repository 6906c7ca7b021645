#include "shared/gait/gait_features.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {
namespace {

constexpr std::int32_t one = raw(Unit::ratio, 1);
constexpr unsigned counted_links = 31;
/// The value of a state that has the links that touch.
constexpr unsigned touched_links = GaitFeatures::count;

constexpr std::uint32_t bit(GaitFeatures::Feature feature) { return 1U << unsigned{feature}; }

/// What a feature averages: value * times, of which the product need not fit in its number.
struct Input {
  bool is_known;
  std::int32_t value;
  std::int32_t times = 1;
};

/// Not inline, as sense_touch(): the image is small.
[[gnu::noinline]] std::int32_t averaged(std::int32_t part, std::int32_t before, const Input& input) {
  const std::int64_t gain = std::int64_t{multiply(part, input.value, 30)} * input.times;
  return saturate(gain + before - multiply(part, before, 30));
}

[[gnu::noinline]] void sense_touch(const Surroundings& surroundings, std::int32_t share, std::uint32_t touched_before,
                                   std::int32_t& touched_now, Input* inputs) {
  const Contacts& contacts = surroundings.contacts;
  std::int32_t count = 0;
  std::uint32_t touched = 0;
  for (unsigned link = 0; link < contacts.link_count(); ++link) {
    const std::uint32_t is_touched = contacts.pressed(link) ? 1 : 0;
    count += static_cast<std::int32_t>(is_touched);
    touched |= link < counted_links ? is_touched << link : 0U;
  }
  touched_now = static_cast<std::int32_t>(touched);
  const int changed = std::popcount(touched ^ touched_before);
  const auto ticks_per_second = static_cast<std::int32_t>(1'000'000U / surroundings.context.tick_period_us);
  inputs[GaitFeatures::touch] = {true, count * share};
  inputs[GaitFeatures::head_touch] = {true, (touched & 1U) != 0 ? one : 0};
  inputs[GaitFeatures::touch_changes] = {true, changed * share, ticks_per_second};
}

/// |value|, with 2^31 for the value that has no opposite.
std::uint32_t magnitude(std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  return value < 0 ? 0U - bits : bits;
}

std::int32_t distance(std::int32_t a, std::int32_t b) {
  const std::int64_t difference = std::int64_t{a} - b;
  return saturate(difference < 0 ? -difference : difference);
}

std::int32_t in_amperes(std::int32_t milliamperes) {
  constexpr std::int32_t of_1024_ma = raw(Unit::ratio, 1'024, 1'000);
  return saturate(shift_right_rounding(multiply_wide(milliamperes, of_1024_ma), 10));
}

}  // namespace

GaitFeatures GaitFeatures::make(const JointContext& context, std::int32_t window_ms, std::uint32_t used) {
  const std::int64_t share_of_tick =
      divide_nearest(std::int64_t{context.tick_period_us} << 30U, std::int64_t{window_ms} * 1'000);
  return {saturate(std::min(share_of_tick, std::int64_t{1} << 30U)),
          (used & bit(pitch_swing)) != 0 ? used | bit(pitch) : used,
          static_cast<std::int32_t>(divide_nearest(one, context.joint_count + 1))};
}

void GaitFeatures::store(std::int32_t* derived) const {
  derived[0] = part;
  derived[1] = static_cast<std::int32_t>(used);
  derived[2] = link_share;
}

std::uint8_t GaitFeatures::required_readings(std::uint32_t used) {
  const auto needs = [used](std::uint32_t features, JointReadings::Sensor sensor) {
    return (used & features) != 0 ? unsigned{sensor} : 0U;
  };
  return static_cast<std::uint8_t>(needs(bit(pitch) | bit(pitch_swing) | bit(roll), JointReadings::inclination) |
                                   needs(bit(current), JointReadings::servo_current) |
                                   needs(bit(tracking_error), JointReadings::angle_of_joint));
}

void GaitFeatures::advance(const Surroundings& surroundings, const std::int32_t* state, std::int32_t* next) const {
  std::fill(next, next + state_size, 0);
  if (used == 0) {
    return;
  }
  const JointReadings& readings = surroundings.readings;
  const bool is_inclined = readings.has(JointReadings::inclination);
  const std::int32_t inclination = readings.pitch >> 2;
  std::array<Input, count> inputs{};
  inputs[pitch] = {is_inclined, inclination};
  inputs[pitch_swing] = {is_inclined, distance(inclination, state[pitch])};
  inputs[roll] = {is_inclined, static_cast<std::int32_t>(magnitude(readings.roll) >> 3U)};
  inputs[current] = {readings.has(JointReadings::servo_current), in_amperes(readings.current_ma)};
  inputs[tracking_error] = {readings.has(JointReadings::angle_of_joint),
                            distance(surroundings.setpoint, readings.angle) >> 2};
  if ((used & (bit(touch) | bit(head_touch) | bit(touch_changes))) != 0) {
    sense_touch(surroundings, link_share, static_cast<std::uint32_t>(state[touched_links]), next[touched_links],
                inputs.data());
  }
  for (unsigned i = 0; i < count; ++i) {
    if (((used >> i) & 1U) != 0) {
      next[i] = inputs[i].is_known ? averaged(part, state[i], inputs[i]) : state[i];
    }
  }
}

}  // namespace proleg
