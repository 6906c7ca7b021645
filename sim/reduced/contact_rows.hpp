#pragma once

#include <cstddef>

#include "sim/reduced/chain_scratch.hpp"
#include "sim/reduced/lanes.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// Solves for the impulses of contacts and of weak motors, one row after the other, again and again (projected
/// Gauss-Seidel). First come normal impulses; they bound the friction. Then come both, again as long.
template <int width>
class ContactRows {
 public:
  using Number = typename Lanes<width>::Number;

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
      for (std::size_t i = 0; i < unknowns_; ++i) {
        Number sum = s_.inverse_matrix[i * stride_] * jacobian[0];
        for (std::size_t k = 1; k < unknowns_; ++k) {
          sum += s_.inverse_matrix[i * stride_ + k] * jacobian[k];
        }
        response[i] = sum;
        mobility += jacobian[i] * sum;
      }
      // A row of a contact that a lane does not have gives no impulse.
      s_.inverse[row] = select(contact_count > static_cast<double>(row / 2), 1.0 / mobility, Number{});
    }
  }

  /// center_speed: in and out. motors: free joints, the first unknowns - 1.
  void solve(Plane<Number>& center_speed, const Number* max_torque_impulse, const Number* wanted, const Number* lowest,
             const Number* highest) {
    constexpr int normal_sweeps = 8;
    constexpr int sweeps = 10;
    for (std::size_t k = 0; k < contacts_; ++k) {
      s_.normal_value[k] = s_.old_normal[k];
      s_.friction_value[k] = Number{};
      apply(2 * k, s_.normal_value[k], center_speed);
    }
    for (int sweep = 0; sweep < normal_sweeps; ++sweep) {
      turn_motors(max_torque_impulse, wanted, lowest, highest);
      for (std::size_t k = 0; k < contacts_; ++k) {
        push(k, center_speed);
      }
    }
    for (std::size_t k = 0; k < contacts_; ++k) {
      s_.most_friction[k] = s_.normal_value[k] * s_.friction[k];
      s_.friction_value[k] = bounded(s_.old_friction[k], -s_.most_friction[k], s_.most_friction[k]);
      apply(2 * k + 1, s_.friction_value[k], center_speed);
    }
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      turn_motors(max_torque_impulse, wanted, lowest, highest);
      for (std::size_t k = 0; k < contacts_; ++k) {
        push(k, center_speed);
        rub(k, center_speed);
      }
    }
  }

  /// m/s: speed in the direction of a row.
  [[nodiscard]] Number speed_of(std::size_t row, const Plane<Number>& center_speed) const {
    const Number* jacobian = s_.jacobian + row * stride_;
    Number speed = s_.bias[row] + dot(direction_of(row), center_speed);
    for (std::size_t i = 0; i < unknowns_; ++i) {
      speed += jacobian[i] * s_.unknown[i];
    }
    return speed;
  }

 private:
  [[nodiscard]] Plane<Number> direction_of(std::size_t row) const {
    return {s_.direction[2 * row], s_.direction[2 * row + 1]};
  }

  void apply(std::size_t row, Number impulse, Plane<Number>& center_speed) {
    center_speed = center_speed + direction_of(row) * (impulse * inverse_mass_);
    const Number* response = s_.response + row * stride_;
    for (std::size_t i = 0; i < unknowns_; ++i) {
      s_.unknown[i] += response[i] * impulse;
    }
  }

  void push(std::size_t contact, Plane<Number>& center_speed) {
    const std::size_t row = 2 * contact;
    const Number before = s_.normal_value[contact];
    const Number missing = s_.depth_speed[contact] - speed_of(row, center_speed);
    s_.normal_value[contact] = larger(before + missing * s_.inverse[row], Number{});
    apply(row, s_.normal_value[contact] - before, center_speed);
  }

  void rub(std::size_t contact, Plane<Number>& center_speed) {
    const std::size_t row = 2 * contact + 1;
    const Number before = s_.friction_value[contact];
    const Number most = s_.most_friction[contact];
    s_.friction_value[contact] = bounded(before - speed_of(row, center_speed) * s_.inverse[row], -most, most);
    apply(row, s_.friction_value[contact] - before, center_speed);
  }

  /// A motor tries to reach the wanted speed with the torque that it has; a stop keeps the speed within its bounds with
  /// any torque.
  void turn_motors(const Number* max_torque_impulse, const Number* wanted, const Number* lowest,
                   const Number* highest) {
    for (std::size_t motor = 0; motor + 1 < unknowns_; ++motor) {
      const std::size_t unknown = motor + 1;
      const Number before = s_.motor_impulse[motor];
      const Number speed = s_.unknown[unknown];
      const Number inverse = s_.motor_inverse[motor];
      const Number most = max_torque_impulse[motor];
      const Number own = bounded(before + (wanted[motor] - speed) * inverse, -most, most);
      const Number from_lower = before + (lowest[motor] - speed) * inverse;
      const Number from_upper = before + (highest[motor] - speed) * inverse;
      s_.motor_impulse[motor] = bounded(own, from_lower, from_upper);
      const Number change = s_.motor_impulse[motor] - before;
      for (std::size_t i = 0; i < unknowns_; ++i) {
        s_.unknown[i] += s_.inverse_matrix[i * stride_ + unknown] * change;
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
