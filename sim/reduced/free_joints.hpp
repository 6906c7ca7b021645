#pragma once

#include <cstddef>

#include "sim/reduced/lanes.hpp"
#include "sim/reduced/space.hpp"
#include "sim/reduced/spatial_memory.hpp"
#include "sim/reduced/spatial_scratch.hpp"
#include "sim/reduced/symmetric_inverse.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// The joints that are free in any lane, and the inertia that they and the rotation of the first link have together.
template <int width>
class FreeJoints {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Space<Number>;

  FreeJoints(const SpatialForm& form, const SpatialMemory<Number>& memory, const SpatialScratch<Number>& scratch)
      : m_(memory), s_(scratch), joints_(form.counts.joints), step_s_(form.step_s) {}

  void list() {
    count_ = 0;
    for (std::size_t j = 0; j < joints_; ++j) {
      if (any(m_.is_free[j] > 0.0)) {
        numbers_[count_++] = j;
      }
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] const std::size_t* numbers() const { return numbers_; }

  /// Of the free joints, where they are free: at rest.
  void stop() {
    for (std::size_t i = 0; i < count_; ++i) {
      set_speed(i, Number{});
    }
  }
  /// The unknowns become the speeds.
  void take_speeds() {
    for (std::size_t i = 0; i < count_; ++i) {
      set_speed(i, s_.unknown[3 + i]);
    }
  }

  /// The unknowns without contacts, with the motors' torques of the step before, and the inverse of their inertia.
  /// inertia and momentum: of the rotation. The sums over the links behind the joints must be there.
  void start(const Tensor<Number>& inertia, const Vector& momentum) {
    set_matrix(inertia, momentum);
    const std::size_t n = 3 + count_;
    const std::size_t stride = joints_ + 3;
    invert_symmetric(s_.matrix, s_.inverse_matrix, n, stride);
    for (std::size_t i = 0; i < n; ++i) {
      s_.matrix[i] = s_.unknown[i];  // the momenta; the first row of the factors is not needed any more
    }
    multiply(s_.inverse_matrix, s_.matrix, s_.unknown, n, stride);
    start_motors();
  }

  void set_jacobians(std::size_t contacts) {
    for (std::size_t k = 0; k < contacts; ++k) {
      for (std::size_t i = 0; i < count_; ++i) {
        const std::size_t j = numbers_[i];
        const Mask is_behind = s_.link[k] > static_cast<double>(j);
        const Vector turning = cross(space_at(s_.free_axis, i), space_at(s_.arm, k) - joint(j));
        const Vector velocity = select(is_behind, turning, Vector{}) - space_at(s_.free_mean, i);
        s_.jacobian[3 * k * joints_ + i] = velocity.x;
        s_.jacobian[(3 * k + 1) * joints_ + i] = velocity.y;
        s_.jacobian[(3 * k + 2) * joints_ + i] = velocity.z;
      }
    }
  }

 private:
  [[nodiscard]] Vector joint(std::size_t j) const { return space_at(s_.joint_position, j); }

  void set_speed(std::size_t i, Number speed) {
    const std::size_t j = numbers_[i];
    s_.speed[j] = select(m_.is_free[j] > 0.0, speed, s_.speed[j]);
  }

  /// Of the unknowns; the lower half. The unknowns are their momenta then.
  void set_matrix(const Tensor<Number>& inertia, const Vector& momentum) {
    const std::size_t stride = joints_ + 3;
    Number* matrix = s_.matrix;
    matrix[0] = inertia.xx;
    matrix[stride] = inertia.xy;
    matrix[stride + 1] = inertia.yy;
    matrix[2 * stride] = inertia.xz;
    matrix[2 * stride + 1] = inertia.yz;
    matrix[2 * stride + 2] = inertia.zz;
    put(s_.unknown, 0, momentum);
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t j = numbers_[i];
      const Mask is_free = m_.is_free[j] > 0.0;
      // Momenta of the links behind while the joint turns at 1 rad/s.
      const Vector axis = select(is_free, space_at(s_.axis, j), Vector{});
      const Vector moment = space_at(s_.moment_behind, j);
      const Vector linear = cross(axis, moment - joint(j) * s_.mass_behind[j]);
      const Vector angular = tensor_at(s_.inertia_behind, j) * axis - cross(moment, cross(axis, joint(j)));
      const Vector mean = linear * m_.inverse_mass[0];
      put(s_.free_axis, i, axis);
      put(s_.free_mean, i, mean);
      Number* row = matrix + (3 + i) * stride;
      put(row, 0, angular);
      // Free joints are in the order of the chain: the links behind joint j are also behind the joints before it.
      for (std::size_t k = 0; k <= i; ++k) {
        const Vector about_joint = angular - cross(joint(numbers_[k]), linear);
        row[3 + k] = dot(space_at(s_.free_axis, k), about_joint) - dot(space_at(s_.free_mean, k), linear);
      }
      row[3 + i] = select(is_free, row[3 + i], Lanes<width>::number(1.0));
      s_.unknown[3 + i] = dot(axis, space_at(s_.angular_behind, j) - cross(joint(j), space_at(s_.momentum_behind, j)));
    }
  }

  /// The motors of free joints begin with the torque of the step before.
  void start_motors() {
    const std::size_t stride = joints_ + 3;
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t j = numbers_[i];
      const Mask is_free = m_.is_free[j] > 0.0;
      const Number* column = s_.inverse_matrix + (3 + i) * stride;
      const Number most = select(is_free, m_.max_torque[j] * step_s_, Number{});
      s_.free_max_impulse[i] = most;
      s_.motor_inverse[i] = select(is_free, 1.0 / column[3 + i], Number{});
      s_.motor_impulse[i] = bounded(m_.motor_torque[j] * step_s_, -most, most);
      for (std::size_t k = 0; k < 3 + count_; ++k) {
        s_.unknown[k] += column[k] * s_.motor_impulse[i];
      }
    }
  }

  const SpatialMemory<Number>& m_;
  const SpatialScratch<Number>& s_;
  std::size_t joints_;
  double step_s_;
  std::size_t count_ = 0;
  std::size_t numbers_[max_spatial_joints];
};

}  // namespace
}  // namespace proleg::sim::reduced
