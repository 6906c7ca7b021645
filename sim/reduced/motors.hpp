#pragma once

#include <cstddef>

#include "sim/reduced/chain_form.hpp"
#include "sim/reduced/lanes.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// The speeds that motors give their joints, and which motors are too weak for them. Memory and Scratch: of chains in a
/// plane, or in space.
template <int width, typename Memory, typename Scratch>
class Motors {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;

  Motors(double step_s, const Memory& memory, const Scratch& scratch) : m_(memory), s_(scratch), step_s_(step_s) {}

  /// Joint j gets the speed that its servo wants, but not beyond its stops.
  void bound_speed(std::size_t j, const JointForm& limits) const {
    const double steps_per_s = 1.0 / step_s_;
    s_.lowest_speed[j] = (limits.lower - m_.joint_angle[j]) * steps_per_s;
    s_.highest_speed[j] = (limits.upper - m_.joint_angle[j]) * steps_per_s;
    s_.speed[j] = bounded(m_.wanted_speed[j], s_.lowest_speed[j], s_.highest_speed[j]);
    // A limp joint is free from the start.
    m_.is_free[j] = select(m_.max_torque[j] == 0.0, Lanes<width>::number(1.0), m_.is_free[j]);
  }

  /// Of all joints, when their torques are known. Returns the lanes in which one was freed.
  [[nodiscard]] Mask free_weak_joints(std::size_t joints, Mask open) const {
    Mask changed = Lanes<width>::none();
    for (std::size_t j = 0; j < joints; ++j) {
      const Number most = m_.max_torque[j] * (step_s_ * (1.0 + 1e-9));
      const Number impulse = s_.torque_impulse[j];
      // At a stop the stop gives what the motor lacks.
      const Mask at_lower = m_.wanted_speed[j] < s_.lowest_speed[j];
      const Mask at_upper = m_.wanted_speed[j] > s_.highest_speed[j];
      const Mask is_weak = ((impulse > most) & ~at_lower) | ((impulse < -most) & ~at_upper);
      const Mask is_new = open & is_weak & (m_.is_free[j] == 0.0);
      m_.is_free[j] = select(is_new, Lanes<width>::number(1.0), m_.is_free[j]);
      changed |= is_new;
    }
    return changed;
  }

 private:
  const Memory& m_;
  const Scratch& s_;
  double step_s_;
};

}  // namespace
}  // namespace proleg::sim::reduced
