#include "shared/gait/gait_features.hpp"

#include <algorithm>
#include <bit>

#include "shared/fixed/arithmetic.hpp"

namespace proleg {
namespace {

constexpr std::int32_t one = raw(Unit::ratio, 1);
/// Links whose changes of touch are counted: the first ones.
constexpr std::int32_t most_counted_links = 31;
constexpr std::uint32_t of_counted_links = (std::uint32_t{1} << most_counted_links) - 1;
/// The value of a state that has the links that touch.
constexpr unsigned touched_links = GaitFeatures::count;

constexpr std::uint32_t bit(GaitFeatures::Feature feature) { return 1U << unsigned{feature}; }

constexpr std::uint32_t of_readings = bit(GaitFeatures::pitch) | bit(GaitFeatures::pitch_swing) |
                                      bit(GaitFeatures::roll) | bit(GaitFeatures::current) |
                                      bit(GaitFeatures::tracking_error);
constexpr std::uint32_t of_touch =
    bit(GaitFeatures::touch) | bit(GaitFeatures::head_touch) | bit(GaitFeatures::touch_changes);

/// A feature a tick later. It stays between `before` and `input`, or one step beside them: so only the sum can leave
/// its range. Not inline, as the functions below: the image is small.
[[gnu::noinline]] std::int32_t averaged(std::int32_t part, std::int32_t before, std::int32_t input) {
  return add_saturating(before - multiply(part, before, 30), multiply(part, input, 30));
}

/// The same for input * times, of which the product need not fit in its number.
std::int32_t averaged(std::int32_t part, std::int32_t before, std::int32_t input, std::int32_t times) {
  const std::int64_t gain = multiply_wide(multiply(part, input, 30), times);
  return saturate(gain + before - multiply(part, before, 30));
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
  if ((used & of_touch) != 0) {
    advance_touch(surroundings, state, next);
  }
  if ((used & of_readings) != 0) {
    advance_readings(surroundings, state, next);
  }
}

[[gnu::noinline]] void GaitFeatures::advance_touch(const Surroundings& surroundings, const std::int32_t* state,
                                                   std::int32_t* next) const {
  const Contacts& contacts = surroundings.contacts;
  const unsigned head = contacts.pressed(0) ? 1 : 0;
  unsigned touching = head;
  std::uint32_t touched = head;
  std::uint32_t place = 2;  // 0 behind the 32nd link
  for (unsigned link = 1; link < contacts.link_count(); ++link) {
    if (contacts.pressed(link)) {
      ++touching;
      touched |= place;
    }
    place <<= 1U;
  }
  touched &= of_counted_links;
  next[touched_links] = static_cast<std::int32_t>(touched);
  if (uses(touch)) {
    next[touch] = averaged(part, state[touch], static_cast<std::int32_t>(touching) * link_share);
  }
  if (uses(head_touch)) {
    next[head_touch] = averaged(part, state[head_touch], static_cast<std::int32_t>(head) * one);
  }
  if (uses(touch_changes)) {
    const int changed = std::popcount(touched ^ static_cast<std::uint32_t>(state[touched_links]));
    const auto ticks_per_second = static_cast<std::int32_t>(1'000'000U / surroundings.context.tick_period_us);
    const std::int32_t share =
        contacts.link_count() > unsigned{most_counted_links} ? one / most_counted_links : link_share;
    next[touch_changes] = averaged(part, state[touch_changes], changed * share, ticks_per_second);
  }
}

[[gnu::noinline]] void GaitFeatures::advance_readings(const Surroundings& surroundings, const std::int32_t* state,
                                                      std::int32_t* next) const {
  const JointReadings& readings = surroundings.readings;
  const auto average = [&](Feature feature, JointReadings::Sensor sensor, const auto& input) {
    if (uses(feature)) {
      next[feature] = readings.has(sensor) ? averaged(part, state[feature], input()) : state[feature];
    }
  };
  const std::int32_t inclination = readings.pitch >> 2;
  average(pitch, JointReadings::inclination, [&] { return inclination; });
  average(pitch_swing, JointReadings::inclination, [&] { return distance(inclination, state[pitch]); });
  average(roll, JointReadings::inclination, [&] { return static_cast<std::int32_t>(magnitude(readings.roll) >> 3U); });
  average(current, JointReadings::servo_current, [&] { return in_amperes(readings.current_ma); });
  average(tracking_error, JointReadings::angle_of_joint,
          [&] { return distance(surroundings.setpoint, readings.angle) >> 2; });
}

}  // namespace proleg
