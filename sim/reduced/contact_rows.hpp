#pragma once

#include <cstddef>

#include "sim/reduced/chain_form.hpp"
#include "sim/reduced/chain_scratch.hpp"
#include "sim/reduced/lanes.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// The unknowns that every chain has.
template <int width>
struct BaseMotion {
  using Number = typename Lanes<width>::Number;
  Plane<Number> center;  ///< velocity of the centre of mass, m/s
  Number rotation;       ///< of the first link, rad/s
};

/// Solves for the impulses of contacts and of motors of free joints, one row after the other, again and again
/// (projected Gauss-Seidel). First come normal impulses; they bound the friction. Then come both. The impulses of the
/// last step are the start. has_free_joints: whether any lane has free joints.
template <int width, bool has_free_joints>
class ContactRows {
 public:
  using Number = typename Lanes<width>::Number;
  using Motion = BaseMotion<width>;

  /// contacts: most contacts of a lane; unknowns: 1, and the most free joints of a lane.
  ContactRows(const ChainForm& form, const ChainScratch<Number>& scratch, std::size_t contacts, std::size_t unknowns,
              Number inverse_mass)
      : s_(scratch),
        contacts_(contacts),
        unknowns_(unknowns),
        stride_(form.counts.joints + 1),
        inverse_mass_(inverse_mass) {}

  /// After the Jacobians and directions of all rows: their responses.
  void prepare(Number contact_count) {
    for (std::size_t row = 0; row < 2 * contacts_; ++row) {
      const Number* jacobian = s_.jacobian + row * stride_;
      Number* response = s_.response + row * stride_;
      const Plane<Number> direction = direction_of(row);
      Number mobility = dot(direction, direction) * inverse_mass_;
      for (std::size_t i = 0; i < unknowns(); ++i) {
        Number sum = s_.inverse_matrix[i * stride_] * jacobian[0];
        for (std::size_t k = 1; k < unknowns(); ++k) {
          sum += s_.inverse_matrix[i * stride_ + k] * jacobian[k];
        }
        response[i] = sum;
        mobility += jacobian[i] * sum;
      }
      // A row of a contact that a lane does not have gives no impulse.
      const std::size_t contact = row / 2;
      s_.inverse[row] = select(contact_count > static_cast<double>(contact), 1.0 / mobility, Number{});
    }
  }

  /// base: in and out, as the unknowns of free joints in the scratch memory.
  void solve(Motion& base) {
    constexpr int normal_sweeps = 4;
    constexpr int sweeps = 6;
    Motion motion = base;
    for (std::size_t k = 0; k < contacts_; ++k) {
      s_.normal_value[k] = s_.old_normal[k];
      apply(2 * k, s_.normal_value[k], motion);
    }
    for (int sweep = 0; sweep < normal_sweeps; ++sweep) {
      turn_motors(motion);
      for (std::size_t k = 0; k < contacts_; ++k) {
        push(k, motion);
      }
    }
    for (std::size_t k = 0; k < contacts_; ++k) {
      s_.most_friction[k] = s_.normal_value[k] * s_.friction[k];
      s_.friction_value[k] = bounded(s_.old_friction[k], -s_.most_friction[k], s_.most_friction[k]);
      apply(2 * k + 1, s_.friction_value[k], motion);
    }
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      turn_motors(motion);
      for (std::size_t k = 0; k < contacts_; ++k) {
        push(k, motion);
        rub(k, motion);
      }
    }
    base = motion;
  }

  /// m/s: speed in the direction of a row.
  [[nodiscard]] Number speed_of(std::size_t row, const Motion& motion) const {
    const Number* jacobian = s_.jacobian + row * stride_;
    Number speed = (s_.bias[row] + jacobian[0] * motion.rotation) + dot(direction_of(row), motion.center);
    for (std::size_t i = 1; i < unknowns(); ++i) {
      speed += jacobian[i] * s_.unknown[i];
    }
    return speed;
  }

 private:
  [[nodiscard]] std::size_t unknowns() const {
    if constexpr (has_free_joints) {
      return unknowns_;
    } else {
      return 1;
    }
  }

  [[nodiscard]] Plane<Number> direction_of(std::size_t row) const {
    return {s_.direction[2 * row], s_.direction[2 * row + 1]};
  }

  void apply(std::size_t row, Number impulse, Motion& motion) {
    const Number* response = s_.response + row * stride_;
    motion.center = motion.center + direction_of(row) * (impulse * inverse_mass_);
    motion.rotation += response[0] * impulse;
    for (std::size_t i = 1; i < unknowns(); ++i) {
      s_.unknown[i] += response[i] * impulse;
    }
  }

  void push(std::size_t contact, Motion& motion) {
    const std::size_t row = 2 * contact;
    const Number before = s_.normal_value[contact];
    const Number missing = s_.depth_speed[contact] - speed_of(row, motion);
    const Number value = larger(before + missing * s_.inverse[row], Number{});
    s_.normal_value[contact] = value;
    apply(row, value - before, motion);
  }

  void rub(std::size_t contact, Motion& motion) {
    const std::size_t row = 2 * contact + 1;
    const Number before = s_.friction_value[contact];
    const Number most = s_.most_friction[contact];
    const Number value = bounded(before - speed_of(row, motion) * s_.inverse[row], -most, most);
    s_.friction_value[contact] = value;
    apply(row, value - before, motion);
  }

  /// A motor tries to reach the wanted speed with the torque that it has; a stop keeps the speed within its bounds with
  /// any torque.
  void turn_motors(Motion& motion) {
    if constexpr (has_free_joints) {
      for (std::size_t motor = 0; motor + 1 < unknowns_; ++motor) {
        const std::size_t unknown = motor + 1;
        const Number before = s_.motor_impulse[motor];
        const Number speed = s_.unknown[unknown];
        const Number inverse = s_.motor_inverse[motor];
        const Number most = s_.free_max_impulse[motor];
        const Number own = bounded(before + (s_.free_wanted[motor] - speed) * inverse, -most, most);
        const Number from_lower = before + (s_.free_lowest[motor] - speed) * inverse;
        const Number from_upper = before + (s_.free_highest[motor] - speed) * inverse;
        s_.motor_impulse[motor] = bounded(own, from_lower, from_upper);
        const Number change = s_.motor_impulse[motor] - before;
        motion.rotation += s_.inverse_matrix[unknown] * change;
        for (std::size_t i = 1; i < unknowns_; ++i) {
          s_.unknown[i] += s_.inverse_matrix[i * stride_ + unknown] * change;
        }
      }
    }
  }

  const ChainScratch<Number>& s_;
  std::size_t contacts_;
  std::size_t unknowns_;
  std::size_t stride_;  ///< of a row, in unknowns
  Number inverse_mass_;
};

}  // namespace
}  // namespace proleg::sim::reduced
