#pragma once

// Short names for things that the tests of gaits and of the kernel use often.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>

#include "shared/gait/registry.hpp"
#include "shared/kernel/kernel.hpp"

namespace proleg::test {

inline double in_degrees(std::int32_t angle) { return angle * (90.0 / (1 << 30)); }
inline double in_radians(std::int32_t angle) { return angle * (std::numbers::pi / 2147483648.0); }
inline std::int32_t degrees(double value) { return static_cast<std::int32_t>(std::lround(value * ((1 << 30) / 90.0))); }
/// The phase of any number of degrees.
inline std::int32_t phase(double value) {
  return static_cast<std::int32_t>(
      static_cast<std::uint32_t>(std::llround(std::fmod(value, 360.0) * (4294967296.0 / 360.0))));
}
inline std::int32_t hertz(double value) { return static_cast<std::int32_t>(std::lround(value * (1 << 24))); }
inline std::int32_t per_second(double value) { return hertz(value); }
inline std::int32_t ratio(double value) { return static_cast<std::int32_t>(std::lround(value * (1 << 28))); }

inline const ActuationModule& algorithm(std::string_view name) {
  const ActuationModule* found = find_algorithm(name);
  EXPECT_NE(found, nullptr) << name;
  return *found;
}

inline constexpr std::string_view direct = "DirectJointAccess";
inline constexpr std::string_view sinusoidal = "PatternGenerator_sinusoidal";
inline constexpr std::string_view extended = "PatternGenerator_sinusoidal_extended";
inline constexpr std::string_view coupled = "PatternGenerator_coupled_oscillator";
inline constexpr std::string_view stimulus = "PatternGenerator_head_stimulus";
inline constexpr std::string_view reflex = "SensingModule_uneven_ground_reflex";
inline constexpr std::string_view adaptive_touch = "SensingModule_global_adaptive_touch";
inline constexpr std::string_view selector = "SensingModule_gait_selector";
inline constexpr std::string_view serpenoid = "PatternGenerator_serpenoid";
inline constexpr std::string_view compound = "PatternGenerator_compound_serpenoid";
inline constexpr std::string_view hopf = "PatternGenerator_hopf";
inline constexpr std::string_view matsuoka = "PatternGenerator_matsuoka";
inline constexpr std::string_view half_centre = "PatternGenerator_half_centre";
inline constexpr std::string_view push_pull = "PatternGenerator_push_pull";
inline constexpr std::string_view mtran = "PatternGenerator_mtran";
inline constexpr std::string_view asymmetric = "PatternGenerator_asymmetric_wave";

/// Joints and links of the robot that most tests of gaits use.
inline constexpr unsigned robot_joints = 5;
inline constexpr unsigned robot_links = robot_joints + 1;

/// A robot whose first slot drives all joints.
inline KernelConfiguration one_slot(const ActuationModule& module, unsigned joints, std::uint32_t tick_us = 10'000,
                                    std::uint64_t seed = 1) {
  KernelConfiguration configuration;
  configuration.joint_count = static_cast<std::uint8_t>(joints);
  configuration.tick_period_us = tick_us;
  configuration.seed = seed;
  configuration.slots[0] = {&module, JointMask::first(joints)};
  return configuration;
}

inline unsigned parameter_index(const Kernel& kernel, unsigned slot, std::string_view name) {
  const int index = find_parameter(kernel.configuration().slots[slot].algorithm->declaration(), name);
  EXPECT_GE(index, 0) << name;
  return static_cast<unsigned>(index);
}

inline unsigned value_index(const Kernel& kernel, unsigned slot, std::string_view name) {
  const int index = find_internal_value(kernel.configuration().slots[slot].algorithm->declaration(), name);
  EXPECT_GE(index, 0) << name;
  return static_cast<unsigned>(index);
}

/// Sets a parameter of a slot on one local joint, or on all that the slot drives.
inline void set(Kernel& kernel, unsigned slot, unsigned joint, std::string_view name, std::int32_t value) {
  ASSERT_EQ(kernel.set_parameter(slot, joint, parameter_index(kernel, slot, name), value), Status::ok)
      << name << " = " << value;
}
inline void set_all(Kernel& kernel, unsigned slot, std::string_view name, std::int32_t value) {
  for (unsigned i = 0; i < kernel.local_joint_count(); ++i) {
    if (kernel.drives(slot, kernel.first_joint() + i)) {
      set(kernel, slot, kernel.first_joint() + i, name, value);
    }
  }
}

/// Sets a parameter of a slot on all local joints when the kernel comes to `tick`.
inline void commit_all(Kernel& kernel, unsigned slot, std::string_view name, std::int32_t value, std::uint32_t tick) {
  for (unsigned i = 0; i < kernel.local_joint_count(); ++i) {
    if (kernel.drives(slot, kernel.first_joint() + i)) {
      ASSERT_EQ(kernel.stage(1, slot, kernel.first_joint() + i, parameter_index(kernel, slot, name), value),
                Status::ok);
    }
  }
  ASSERT_EQ(kernel.commit(1, tick), Status::ok);
}

/// Overwrites an internal value at the coming tick.
inline Status distort(Kernel& kernel, unsigned slot, unsigned joint, unsigned internal_value, std::int32_t value) {
  constexpr std::uint16_t transaction = 0xD157;
  const Status status = kernel.stage_internal(transaction, slot, joint, internal_value, value);
  return status == Status::ok ? kernel.commit(transaction, kernel.tick()) : status;
}

inline std::int32_t value(const Kernel& kernel, unsigned slot, unsigned joint, std::string_view name) {
  return kernel.internal_value(slot, joint, value_index(kernel, slot, name));
}

inline void run(Kernel& kernel, unsigned ticks) {
  for (unsigned i = 0; i < ticks; ++i) {
    kernel.advance();
  }
}

}  // namespace proleg::test
