#pragma once

#include <cstddef>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/chain_scratch.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/symmetric_inverse.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// The joints whose speeds are unknown because their motors are too weak, and the inertia that they and the rotation of
/// the chain have together. Number i of a lane is its i-th free joint: lanes differ in their free joints, but not in
/// their places here.
template <int width>
class PlanarFreeJoints {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Plane<Number>;

  PlanarFreeJoints(const ChainForm& form, const ChainMemory<Number>& memory, const ChainScratch<Number>& scratch)
      : form_(form), m_(memory), s_(scratch), joints_(form.counts.joints) {}

  /// All speeds are given.
  void leave_out() { unknowns_ = 1; }

  /// Numbers the free joints of each lane, in the order of the chain.
  void list() {
    Number count{};
    for (std::size_t j = 0; j < joints_; ++j) {
      s_.free_joint[j] = Lanes<width>::number(-1.0);
      const Mask is_free = m_.is_free[j] > 0.0;
      if (!any(is_free)) {
        continue;
      }
      for (std::size_t i = 0; i <= j; ++i) {
        put_where(is_free & (count == static_cast<double>(i)), s_.free_joint[i],
                  Lanes<width>::number(static_cast<double>(j)));
      }
      count = select(is_free, count + 1.0, count);
    }
    unknowns_ = 1;
    for (int lane = 0; lane < width; ++lane) {
      const auto own = static_cast<std::size_t>(count[lane]) + 1;
      unknowns_ = own > unknowns_ ? own : unknowns_;
    }
    count_ = count;
  }

  /// The rotation of the chain and its free joints, in the lane with most of them.
  [[nodiscard]] std::size_t unknowns() const { return unknowns_; }
  /// Whether a lane has free joint i.
  [[nodiscard]] Mask has(std::size_t i) const { return count_ > static_cast<double>(i); }

  /// kg m: mass times distance from the joint, of the links behind free joint i.
  [[nodiscard]] Vector lever(std::size_t i) const {
    return vector(s_.free_moment, i) - vector(s_.free_position, i) * s_.free_mass[i];
  }

  /// Free joints do not move until their speeds are known.
  void stop() const {
    if (unknowns_ > 1) {
      for (std::size_t j = 0; j < joints_; ++j) {
        s_.speed[j] = select(m_.is_free[j] > 0.0, Number{}, s_.speed[j]);
      }
    }
  }
  /// The unknowns become the speeds.
  void take_speeds() const {
    for (std::size_t i = 0; i + 1 < unknowns_; ++i) {
      for (std::size_t j = 0; j < joints_; ++j) {
        put_where(is_free_joint(i, j), s_.speed[j], s_.unknown[i + 1]);
      }
    }
  }

  /// The unknowns without contacts, with the motors' torques of the step before, and the inverse of their inertia.
  /// inertia and momentum: of the rotation. The sums over the links behind the joints must be there.
  void start(Number inertia, Number momentum) const {
    gather();
    set_matrix(inertia);
    s_.unknown[0] = momentum;
    for (std::size_t i = 1; i < unknowns_; ++i) {
      s_.unknown[i] = s_.free_momentum[i - 1];
    }
    invert_matrix();
    start_motors();
  }

 private:
  static Vector vector(const Number* array, std::size_t i) { return {array[2 * i], array[2 * i + 1]}; }
  static void put(Number* array, std::size_t i, const Vector& value) {
    array[2 * i] = value.x;
    array[2 * i + 1] = value.z;
  }
  static void put_where(Mask mask, Number& place, Number value) { place = select(mask, value, place); }

  /// Whether joint j is number i of the free joints of a lane.
  Mask is_free_joint(std::size_t i, std::size_t j) const { return s_.free_joint[i] == static_cast<double>(j); }

  /// What free joint i needs of its joint, by lane.
  void gather() const {
    for (std::size_t i = 0; i + 1 < unknowns_; ++i) {
      Vector position{};
      Vector moment{};
      Number mass{};
      Number inertia = Lanes<width>::number(1.0);
      Number momentum{};
      Number most{};
      Number wanted{};
      Number lowest{};
      Number highest{};
      Number start{};
      for (std::size_t j = 0; j < joints_; ++j) {
        const Mask is_this = is_free_joint(i, j);
        if (!any(is_this)) {
          continue;
        }
        const Vector joint = vector(s_.joint_position, j);
        position = select(is_this, joint, position);
        moment = select(is_this, vector(s_.moment_behind, j), moment);
        put_where(is_this, mass, s_.mass_behind[j]);
        put_where(is_this, inertia, s_.inertia_behind[j]);
        put_where(is_this, momentum, s_.angular_behind[j] - cross(joint, vector(s_.momentum_behind, j)));
        put_where(is_this, most, m_.max_torque[j] * form_.step_s);
        put_where(is_this, wanted, m_.wanted_speed[j]);
        put_where(is_this, lowest, s_.lowest_speed[j]);
        put_where(is_this, highest, s_.highest_speed[j]);
        put_where(is_this, start, m_.motor_torque[j] * form_.step_s);
      }
      put(s_.free_position, i, position);
      put(s_.free_moment, i, moment);
      s_.free_mass[i] = mass;
      s_.free_inertia[i] = inertia;
      s_.free_momentum[i] = momentum;
      s_.free_max_impulse[i] = most;
      s_.free_wanted[i] = wanted;
      s_.free_lowest[i] = lowest;
      s_.free_highest[i] = highest;
      s_.motor_impulse[i] = bounded(start, -most, most);
    }
  }

  void set_matrix(Number inertia) const {
    const std::size_t stride = joints_ + 1;
    s_.matrix[0] = inertia;
    for (std::size_t a = 0; a + 1 < unknowns_; ++a) {
      const Mask is_there = count_ > static_cast<double>(a);
      const Vector joint = vector(s_.free_position, a);
      const Number with_base = s_.free_inertia[a] - dot(vector(s_.free_moment, a), joint);
      s_.matrix[(a + 1) * stride] = select(is_there, with_base, Number{});
      // Free joints are in the order of the chain: the links behind b are also behind a.
      for (std::size_t b = a; b + 1 < unknowns_; ++b) {
        const Vector other = vector(s_.free_position, b);
        const Number value = s_.free_inertia[b] - dot(vector(s_.free_moment, b), joint + other) +
                             s_.free_mass[b] * dot(joint, other) - dot(lever(a), lever(b)) * m_.inverse_mass[0];
        const Mask both = count_ > static_cast<double>(b);
        s_.matrix[(b + 1) * stride + a + 1] = select(both, value, Lanes<width>::number(a == b ? 1.0 : 0.0));
      }
    }
  }

  /// And the unknowns from their momenta.
  void invert_matrix() const {
    const std::size_t stride = joints_ + 1;
    invert_symmetric(s_.matrix, s_.inverse_matrix, unknowns_, stride);
    for (std::size_t i = 0; i < unknowns_; ++i) {
      s_.matrix[i] = s_.unknown[i];  // the momenta; the first row of the factors is not needed any more
    }
    multiply(s_.inverse_matrix, s_.matrix, s_.unknown, unknowns_, stride);
  }

  /// The motors of free joints begin with the torque of the step before.
  void start_motors() const {
    const std::size_t stride = joints_ + 1;
    for (std::size_t motor = 0; motor + 1 < unknowns_; ++motor) {
      const Mask is_there = count_ > static_cast<double>(motor);
      s_.motor_inverse[motor] = select(is_there, 1.0 / s_.inverse_matrix[(motor + 1) * stride + motor + 1], Number{});
      for (std::size_t i = 0; i < unknowns_; ++i) {
        s_.unknown[i] += s_.inverse_matrix[i * stride + motor + 1] * s_.motor_impulse[motor];
      }
    }
  }

  const ChainForm& form_;
  const ChainMemory<Number>& m_;
  const ChainScratch<Number>& s_;
  std::size_t joints_;
  std::size_t unknowns_ = 1;
  Number count_{};  ///< of the free joints, by lane
};

}  // namespace
}  // namespace proleg::sim::reduced
