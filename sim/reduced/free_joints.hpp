#pragma once

#include <cstddef>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/kernel.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/vectors.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

/// Inverts a positive definite matrix of n rows, from its lower half, which becomes its factors L D L^T. stride: from
/// row to row of both matrices.
template <typename Number>
inline void invert_symmetric(Number* matrix, Number* inverse_matrix, std::size_t n, std::size_t stride) {
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) {
      matrix[j * stride + j] -= matrix[j * stride + k] * matrix[j * stride + k] * matrix[k * stride + k];
    }
    const Number inverse = 1.0 / matrix[j * stride + j];
    for (std::size_t i = j + 1; i < n; ++i) {
      Number value = matrix[i * stride + j];
      for (std::size_t k = 0; k < j; ++k) {
        value -= matrix[i * stride + k] * matrix[j * stride + k] * matrix[k * stride + k];
      }
      matrix[i * stride + j] = value * inverse;
    }
  }
  for (std::size_t column = 0; column < n; ++column) {
    Number* x = inverse_matrix + column * stride;  // symmetric but for the last bits: a row is a column
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = Number{} + (i == column ? 1.0 : 0.0);
      for (std::size_t k = column; k < i; ++k) {
        x[i] -= matrix[i * stride + k] * x[k];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = x[i] / matrix[i * stride + i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) {
        x[i] -= matrix[k * stride + i] * x[k];
      }
    }
  }
}

/// The product of the first n rows with the vector.
template <typename Number>
inline void multiply(const Number* matrix, const Number* vector, Number* result, std::size_t n, std::size_t stride) {
  for (std::size_t i = 0; i < n; ++i) {
    Number sum{};
    for (std::size_t k = 0; k < n; ++k) {
      sum += matrix[i * stride + k] * vector[k];
    }
    result[i] = sum;
  }
}

/// What the unknowns answer to an impulse: number i is at first[i * step].
template <typename Number>
struct Response {
  const Number* first;
  std::size_t step;
};

/// The joints whose speeds are unknown because their motors are too weak, and the inertia that they and the rotation of
/// the first link have together.
template <typename Kind, int width>
class FreeJointList {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;

  [[nodiscard]] std::size_t count() const { return count_; }

  /// Stops the free joints: they do not move until their speeds are known.
  void stop() const {
    for (std::size_t j = 0; j < joints_; ++j) {
      s_.speed[j] = select(m_.is_free[j] > 0.0, Number{}, s_.speed[j]);
    }
  }

  /// What an impulse of the motor of free joint i moves. The inverse matrix is symmetric but for the last bits: which
  /// of its halves is taken is a part of the result.
  [[nodiscard]] Response<Number> motor_response(std::size_t i) const {
    const std::size_t unknown = Kind::spin_axes + i;
    if constexpr (Kind::axes == 2) {
      return {s_.inverse_matrix + unknown, stride_};
    } else {
      return {s_.inverse_matrix + unknown * stride_, 1};
    }
  }

 protected:
  FreeJointList(const ChainForm<Kind>& form, const ChainMemory<Kind, Number>& memory,
                const ChainScratch<Kind, Number>& scratch)
      : m_(memory),
        s_(scratch),
        joints_(form.counts.joints),
        stride_(joints_ + Kind::spin_axes),
        step_s_(form.step_s) {}

  /// Computes the unknowns without contacts, from their momenta and the matrix, and the inverse of the matrix. The
  /// motors begin with the torque of the step before. has(i): the lanes in which free joint i is free.
  template <typename Has>
  void solve(const Has& has) const {
    const std::size_t unknowns = Kind::spin_axes + count_;
    invert_symmetric(s_.matrix, s_.inverse_matrix, unknowns, stride_);
    for (std::size_t i = 0; i < unknowns; ++i) {
      s_.matrix[i] = s_.unknown[i];  // the momenta; the first row of the factors is not needed any more
    }
    multiply(s_.inverse_matrix, s_.matrix, s_.unknown, unknowns, stride_);
    for (std::size_t i = 0; i < count_; ++i) {
      const Response<Number> response = motor_response(i);
      s_.motor_inverse[i] = select(has(i), 1.0 / response.first[(Kind::spin_axes + i) * response.step], Number{});
      for (std::size_t k = 0; k < unknowns; ++k) {
        s_.unknown[k] += response.first[k * response.step] * s_.motor_impulse[i];
      }
    }
  }

  const ChainMemory<Kind, Number>& m_;
  const ChainScratch<Kind, Number>& s_;
  std::size_t joints_;
  std::size_t stride_;  ///< from row to row, in unknowns
  double step_s_;
  std::size_t count_ = 0;
};

template <typename Kind, int width>
class FreeJoints;

/// Number i of a lane is its i-th free joint: lanes differ in their free joints, but not in their places here. count()
/// is how many the lane with most of them has.
template <int width>
class FreeJoints<Planar, width> : public FreeJointList<Planar, width> {
  using Base = FreeJointList<Planar, width>;
  using Base::count_;
  using Base::joints_;
  using Base::m_;
  using Base::s_;
  using Base::step_s_;
  using Base::stride_;

 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Plane<Number>;

  FreeJoints(const ChainForm<Planar>& form, const ChainMemory<Planar, Number>& memory,
             const ChainScratch<Planar, Number>& scratch)
      : Base(form, memory, scratch) {}

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
    count_ = 0;
    for (int lane = 0; lane < width; ++lane) {
      const auto own = static_cast<std::size_t>(count[lane]);
      count_ = own > count_ ? own : count_;
    }
    counts_ = count;
  }

  /// Makes the unknowns the speeds of the joints.
  void take_speeds() const {
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t j = 0; j < joints_; ++j) {
        put_where(is_free_joint(i, j), s_.speed[j], s_.unknown[i + 1]);
      }
    }
  }

  /// Computes the unknowns without contacts, and the inverse of their inertia. inertia and momentum: those of the
  /// rotation. The sums over the links behind the joints must be there.
  void start(Number inertia, Number momentum) const {
    gather();
    set_matrix(inertia);
    s_.unknown[0] = momentum;
    for (std::size_t i = 0; i < count_; ++i) {
      s_.unknown[i + 1] = s_.free_momentum[i];
    }
    Base::solve([&](std::size_t i) { return has(i); });
  }

  void set_jacobians(std::size_t contacts) const {
    for (std::size_t k = 0; k < contacts; ++k) {
      const Mask is_terrain = s_.other_link[k] < 0.0;
      const Vector arm = at<Vector>(s_.arm, k);
      const Vector normal = at<Vector>(s_.normal, k);
      const Vector along{normal.z, -normal.x};
      for (std::size_t i = 0; i < count_; ++i) {
        const Vector from_joint = turned(arm - at<Vector>(s_.free_position, i));
        Vector velocity = select(s_.link[k] > s_.free_joint[i], from_joint, Vector{});
        velocity = select(s_.other_link[k] > s_.free_joint[i], velocity - from_joint, velocity);
        velocity = select(is_terrain, velocity - at<Vector>(s_.free_mean, i), velocity);
        velocity = select(has(i), velocity, Vector{});
        s_.jacobian[2 * k * stride_ + i + 1] = dot(along, velocity);
        s_.jacobian[(2 * k + 1) * stride_ + i + 1] = dot(normal, velocity);
      }
    }
  }

 private:
  /// The lanes that have free joint i.
  [[nodiscard]] Mask has(std::size_t i) const { return counts_ > static_cast<double>(i); }
  /// The lanes in which joint j is number i of the free joints.
  [[nodiscard]] Mask is_free_joint(std::size_t i, std::size_t j) const {
    return s_.free_joint[i] == static_cast<double>(j);
  }
  /// Collects what each free joint needs of its joint, which differs from lane to lane.
  void gather() const {
    for (std::size_t i = 0; i < count_; ++i) {
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
        const Vector joint = at<Vector>(s_.joint_position, j);
        position = select(is_this, joint, position);
        moment = select(is_this, at<Vector>(s_.moment_behind, j), moment);
        put_where(is_this, mass, s_.mass_behind[j]);
        put_where(is_this, inertia, s_.inertia_behind[j]);
        put_where(is_this, momentum, s_.angular_behind[j] - cross(joint, at<Vector>(s_.momentum_behind, j)));
        put_where(is_this, most, m_.max_torque[j] * step_s_);
        put_where(is_this, wanted, m_.wanted_speed[j]);
        put_where(is_this, lowest, s_.lowest_speed[j]);
        put_where(is_this, highest, s_.highest_speed[j]);
        put_where(is_this, start, m_.motor_torque[j] * step_s_);
      }
      const Vector lever = moment - position * mass;
      put(s_.free_position, i, position);
      put(s_.free_moment, i, moment);
      put(s_.free_lever, i, lever);
      put(s_.free_mean, i, turned(lever) * m_.inverse_mass[0]);
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
    s_.matrix[0] = inertia;
    for (std::size_t a = 0; a < count_; ++a) {
      const Vector joint = at<Vector>(s_.free_position, a);
      const Number with_base = s_.free_inertia[a] - dot(at<Vector>(s_.free_moment, a), joint);
      s_.matrix[(a + 1) * stride_] = select(has(a), with_base, Number{});
      // Free joints are in the order of the chain: the links behind b are also behind a.
      for (std::size_t b = a; b < count_; ++b) {
        const Vector other = at<Vector>(s_.free_position, b);
        const Number value = s_.free_inertia[b] - dot(at<Vector>(s_.free_moment, b), joint + other) +
                             s_.free_mass[b] * dot(joint, other) -
                             dot(at<Vector>(s_.free_lever, a), at<Vector>(s_.free_lever, b)) * m_.inverse_mass[0];
        s_.matrix[(b + 1) * stride_ + a + 1] = select(has(b), value, Lanes<width>::number(a == b ? 1.0 : 0.0));
      }
    }
  }

  Number counts_{};  ///< how many free joints each lane has
};

/// Number i is a joint that is free in any lane. count() is how many such joints there are.
template <int width>
class FreeJoints<Spatial, width> : public FreeJointList<Spatial, width> {
  using Base = FreeJointList<Spatial, width>;
  using Base::count_;
  using Base::joints_;
  using Base::m_;
  using Base::s_;
  using Base::step_s_;
  using Base::stride_;

 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Space<Number>;

  FreeJoints(const ChainForm<Spatial>& form, const ChainMemory<Spatial, Number>& memory,
             const ChainScratch<Spatial, Number>& scratch)
      : Base(form, memory, scratch) {}

  void list() {
    count_ = 0;
    for (std::size_t j = 0; j < joints_; ++j) {
      if (any(m_.is_free[j] > 0.0)) {
        numbers_[count_++] = j;
      }
    }
  }

  /// Makes the unknowns the speeds of the joints.
  void take_speeds() const {
    for (std::size_t i = 0; i < count_; ++i) {
      put_where(is_free(i), s_.speed[numbers_[i]], s_.unknown[3 + i]);
    }
  }

  /// Computes the unknowns without contacts, and the inverse of their inertia. inertia and momentum: those of the
  /// rotation. The sums over the links behind the joints must be there.
  void start(const Tensor<Number>& inertia, const Vector& momentum) const {
    gather();
    set_matrix(inertia, momentum);
    Base::solve([&](std::size_t i) { return is_free(i); });
  }

  void set_jacobians(std::size_t contacts) const {
    for (std::size_t k = 0; k < contacts; ++k) {
      for (std::size_t i = 0; i < count_; ++i) {
        const std::size_t j = numbers_[i];
        const Mask is_behind = s_.link[k] > static_cast<double>(j);
        const Vector turning = cross(at<Vector>(s_.free_axis, i), at<Vector>(s_.arm, k) - joint(j));
        const Vector velocity = select(is_behind, turning, Vector{}) - at<Vector>(s_.free_mean, i);
        Number* const first = s_.jacobian + 3 * k * stride_ + 3 + i;
        first[0] = velocity.x;
        first[stride_] = velocity.y;
        first[2 * stride_] = velocity.z;
      }
    }
  }

 private:
  [[nodiscard]] Vector joint(std::size_t j) const { return at<Vector>(s_.joint_position, j); }
  [[nodiscard]] Mask is_free(std::size_t i) const { return m_.is_free[numbers_[i]] > 0.0; }

  void gather() const {
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t j = numbers_[i];
      const Number most = select(is_free(i), m_.max_torque[j] * step_s_, Number{});
      s_.free_max_impulse[i] = most;
      s_.free_wanted[i] = m_.wanted_speed[j];
      s_.free_lowest[i] = s_.lowest_speed[j];
      s_.free_highest[i] = s_.highest_speed[j];
      s_.motor_impulse[i] = bounded(m_.motor_torque[j] * step_s_, -most, most);
    }
  }

  /// Computes the lower half of the matrix of the unknowns, and for each unknown its momentum.
  void set_matrix(const Tensor<Number>& inertia, const Vector& momentum) const {
    Number* matrix = s_.matrix;
    matrix[0] = inertia.xx;
    matrix[stride_] = inertia.xy;
    matrix[stride_ + 1] = inertia.yy;
    matrix[2 * stride_] = inertia.xz;
    matrix[2 * stride_ + 1] = inertia.yz;
    matrix[2 * stride_ + 2] = inertia.zz;
    put(s_.unknown, 0, momentum);
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t j = numbers_[i];
      // Momenta of the links behind while the joint turns at 1 rad/s.
      const Vector axis = select(is_free(i), at<Vector>(s_.axis, j), Vector{});
      const Vector moment = at<Vector>(s_.moment_behind, j);
      const Vector linear = cross(axis, moment - joint(j) * s_.mass_behind[j]);
      const Vector angular = at<Tensor<Number>>(s_.inertia_behind, j) * axis - cross(moment, cross(axis, joint(j)));
      const Vector mean = linear * m_.inverse_mass[0];
      put(s_.free_axis, i, axis);
      put(s_.free_mean, i, mean);
      Number* row = matrix + (3 + i) * stride_;
      put(row, 0, angular);
      // Free joints are in the order of the chain: the links behind joint j are also behind the joints before it.
      for (std::size_t k = 0; k <= i; ++k) {
        const Vector about_joint = angular - cross(joint(numbers_[k]), linear);
        row[3 + k] = dot(at<Vector>(s_.free_axis, k), about_joint) - dot(at<Vector>(s_.free_mean, k), linear);
      }
      row[3 + i] = select(is_free(i), row[3 + i], Lanes<width>::number(1.0));
      s_.unknown[3 + i] =
          dot(axis, at<Vector>(s_.angular_behind, j) - cross(joint(j), at<Vector>(s_.momentum_behind, j)));
    }
  }

  std::size_t numbers_[Spatial::max_joints];
};

}  // namespace
}  // namespace proleg::sim::reduced
