#pragma once

// A user's algorithm for tests, which makes a mistake where the test wants it. Sources that include this file are
// compiled without run-time type information, as the core is.

#include <functional>

#include "shared/gait/actuation_module.hpp"

namespace proleg::test {

inline constexpr Parameter user_parameters[] = {
    Parameter{"step", Unit::count, 1, 0, 1000, "what is added in a tick"},
    Parameter{"offset", Unit::degree, 0, -quarter_turn, quarter_turn, "angle of the joint"},
};
inline constexpr InternalValue user_values[] = {
    InternalValue{"count", Unit::count, 0, "sum of the steps"},
};
inline constexpr FrameField user_frame[] = {FrameField{0, 2}};
inline constexpr Declaration user_declaration{96,         "counter", "counts its ticks", user_parameters, user_values,
                                              user_frame, 0xC0FFEE};

/// count(k + 1) = count(k) + step; the angle is offset + count.
class Counter : public ActuationModule {
 public:
  [[nodiscard]] const Declaration& declaration() const override { return user_declaration; }
  [[nodiscard]] std::uint8_t senses_readings() const override { return JointReadings::inclination; }
  void derive(const JointContext& /*context*/, const std::int32_t* parameters, std::int32_t* derived) const override {
    derived[7] = 2 * parameters[0];
  }
  void reset(const JointContext& context, const Tuning& /*tuning*/, Pcg32& /*noise*/,
             std::int32_t* state) const override {
    state[0] = 100 * context.joint;
  }
  void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const override {
    state[0] = static_cast<std::int32_t>(surroundings.tick) * tuning.parameters[0];
  }
  void advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
               std::int32_t* next) const override {
    if (mistake && surroundings.tick == 3 && surroundings.context.joint == 1) {
      mistake(tuning, state, next);
    }
    next[0] = state[0] + tuning.derived[7] / 2;
  }
  [[nodiscard]] std::int32_t output(const Tuning& tuning, const std::int32_t* state) const override {
    return tuning.parameters[1] + state[0];
  }
  void extrapolate(const Tuning& /*tuning*/, const std::int32_t* state, StateFrame& frame) const override {
    frame.bytes[0] = static_cast<std::uint8_t>(state[0]);
    frame.bytes[7] = 0x77;
  }

  std::function<void(const Tuning&, const std::int32_t*, std::int32_t*)> mistake;

 protected:
  ~Counter() = default;
};

class TestedCounter final : public Counter {};

}  // namespace proleg::test
