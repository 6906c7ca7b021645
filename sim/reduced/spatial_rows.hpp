#pragma once

#include <cstddef>

#include "sim/reduced/lanes.hpp"
#include "sim/reduced/space.hpp"
#include "sim/reduced/spatial_memory.hpp"
#include "sim/reduced/spatial_scratch.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// The unknowns that every chain has.
template <int width>
struct SpatialMotion {
  using Number = typename Lanes<width>::Number;
  Space<Number> center;    ///< velocity of the centre of mass, m/s
  Space<Number> rotation;  ///< of the first link, rad/s
};

/// As ContactRows, for contacts with the floor. Friction is bound in every direction alike: an impulse that is too
/// large becomes shorter and keeps its direction. has_free_joints: whether any lane has free joints.
template <int width, bool has_free_joints>
class SpatialRows {
 public:
  using Number = typename Lanes<width>::Number;
  using Vector = Space<Number>;
  using Motion = SpatialMotion<width>;

  /// free_joints: the numbers of the free joints.
  SpatialRows(const SpatialForm& form, const SpatialMemory<Number>& memory, const SpatialScratch<Number>& scratch,
              std::size_t contacts, const std::size_t* free_joints, std::size_t free_count)
      : m_(memory),
        s_(scratch),
        joints_(form.counts.joints),
        contacts_(contacts),
        free_joints_(free_joints),
        free_count_(free_count),
        inverse_mass_(memory.inverse_mass[0]) {}

  /// After the arms and the Jacobians of free joints: the responses. inverse: of the inertia, if there are no free
  /// joints.
  void prepare(Number contact_count, const Tensor<Number>& inverse) {
    for (std::size_t k = 0; k < contacts_; ++k) {
      const Vector arm = space_at(s_.arm, k);
      const Vector turns[3] = {{Number{}, arm.z, -arm.y}, {-arm.z, Number{}, arm.x}, {arm.y, -arm.x, Number{}}};
      Number mobility[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        mobility[axis] = inverse_mass_ + respond(k, axis, turns[axis], inverse);
      }
      // A contact that a lane does not have gives no impulse.
      const auto is_there = contact_count > static_cast<double>(k);
      s_.normal_inverse[k] = select(is_there, 1.0 / mobility[2], Number{});
      s_.friction_inverse[k] = select(is_there, 1.0 / larger(mobility[0], mobility[1]), Number{});
    }
  }

  /// motion: in and out, as the unknowns of free joints in the scratch memory.
  void solve(Motion& motion) {
    constexpr int normal_sweeps = 4;
    constexpr int sweeps = 6;
    Motion v = motion;
    for (std::size_t k = 0; k < contacts_; ++k) {
      s_.value[3 * k + 2] = s_.old_impulse[3 * k + 2];
      apply(k, 2, s_.value[3 * k + 2], v);
    }
    for (int sweep = 0; sweep < normal_sweeps; ++sweep) {
      turn_motors(v);
      for (std::size_t k = 0; k < contacts_; ++k) {
        push(k, v);
      }
    }
    for (std::size_t k = 0; k < contacts_; ++k) {
      s_.most_friction[k] = s_.value[3 * k + 2] * s_.friction[k];
      set_friction(k, s_.old_impulse[3 * k], s_.old_impulse[3 * k + 1]);
      apply(k, 0, s_.value[3 * k], v);
      apply(k, 1, s_.value[3 * k + 1], v);
    }
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      turn_motors(v);
      for (std::size_t k = 0; k < contacts_; ++k) {
        push(k, v);
        rub(k, v);
      }
    }
    motion = v;
  }

  /// m/s: of a contact, along x, y or z.
  [[nodiscard]] Number speed_along(std::size_t contact, std::size_t axis, const Motion& v) const {
    const Vector arm = space_at(s_.arm, contact);
    const Number* given = s_.given + 3 * contact;
    Number speed;
    if (axis == 0) {
      speed = (v.center.x + given[0]) + (v.rotation.y * arm.z - v.rotation.z * arm.y);
    } else if (axis == 1) {
      speed = (v.center.y + given[1]) + (v.rotation.z * arm.x - v.rotation.x * arm.z);
    } else {
      speed = (v.center.z + given[2]) + (v.rotation.x * arm.y - v.rotation.y * arm.x);
    }
    if constexpr (has_free_joints) {
      const Number* jacobian = jacobian_of(contact, axis);
      for (std::size_t i = 0; i < free_count_; ++i) {
        speed += jacobian[i] * s_.unknown[3 + i];
      }
    }
    return speed;
  }

 private:
  [[nodiscard]] Number* jacobian_of(std::size_t contact, std::size_t axis) const {
    return s_.jacobian + (3 * contact + axis) * joints_;
  }
  [[nodiscard]] Number* response_of(std::size_t contact, std::size_t axis) const {
    return s_.response + (3 * contact + axis) * (joints_ + 3);
  }

  /// Returns the mobility of the row without that of the centre. turn: the Jacobian of the rotation.
  Number respond(std::size_t contact, std::size_t axis, const Vector& turn, const Tensor<Number>& inverse) {
    Number* response = response_of(contact, axis);
    if constexpr (!has_free_joints) {
      const Vector answer = inverse * turn;
      put(response, 0, answer);
      return dot(answer, turn);
    } else {
      const std::size_t stride = joints_ + 3;
      const Number* jacobian = jacobian_of(contact, axis);
      Number mobility{};
      for (std::size_t i = 0; i < 3 + free_count_; ++i) {
        const Number* row = s_.inverse_matrix + i * stride;
        Number sum = row[0] * turn.x + row[1] * turn.y + row[2] * turn.z;
        for (std::size_t j = 0; j < free_count_; ++j) {
          sum += row[3 + j] * jacobian[j];
        }
        response[i] = sum;
        mobility += sum * (i == 0 ? turn.x : i == 1 ? turn.y : i == 2 ? turn.z : jacobian[i - 3]);
      }
      return mobility;
    }
  }

  void apply(std::size_t contact, std::size_t axis, Number impulse, Motion& v) {
    Number& along = axis == 0 ? v.center.x : (axis == 1 ? v.center.y : v.center.z);
    along += impulse * inverse_mass_;
    answer(response_of(contact, axis), impulse, v);
  }

  void answer(const Number* response, Number impulse, Motion& v) {
    v.rotation = v.rotation + space_at(response, 0) * impulse;
    if constexpr (has_free_joints) {
      for (std::size_t i = 3; i < 3 + free_count_; ++i) {
        s_.unknown[i] += response[i] * impulse;
      }
    }
  }

  void push(std::size_t contact, Motion& v) {
    const Number before = s_.value[3 * contact + 2];
    const Number missing = s_.depth_speed[contact] - speed_along(contact, 2, v);
    const Number value = larger(before + missing * s_.normal_inverse[contact], Number{});
    s_.value[3 * contact + 2] = value;
    apply(contact, 2, value - before, v);
  }

  void rub(std::size_t contact, Motion& v) {
    const Number before_x = s_.value[3 * contact];
    const Number before_y = s_.value[3 * contact + 1];
    const Number inverse = s_.friction_inverse[contact];
    set_friction(contact, before_x - speed_along(contact, 0, v) * inverse,
                 before_y - speed_along(contact, 1, v) * inverse);
    apply(contact, 0, s_.value[3 * contact] - before_x, v);
    apply(contact, 1, s_.value[3 * contact + 1] - before_y, v);
  }

  void set_friction(std::size_t contact, Number x, Number y) {
    const Number most = s_.most_friction[contact];
    const Number square = x * x + y * y;
    const auto is_too_large = square > most * most;
    const Number one = Lanes<width>::number(1.0);
    const Number factor = select(is_too_large, most / square_root(select(is_too_large, square, one)), one);
    s_.value[3 * contact] = x * factor;
    s_.value[3 * contact + 1] = y * factor;
  }

  /// A motor tries to reach the wanted speed with the torque that it has; a stop keeps the speed within its bounds with
  /// any torque.
  void turn_motors(Motion& v) {
    if constexpr (has_free_joints) {
      for (std::size_t i = 0; i < free_count_; ++i) {
        const std::size_t joint = free_joints_[i];
        const Number before = s_.motor_impulse[i];
        const Number speed = s_.unknown[3 + i];
        const Number inverse = s_.motor_inverse[i];
        const Number most = s_.free_max_impulse[i];
        const Number own = bounded(before + (m_.wanted_speed[joint] - speed) * inverse, -most, most);
        const Number from_lower = before + (s_.lowest_speed[joint] - speed) * inverse;
        const Number from_upper = before + (s_.highest_speed[joint] - speed) * inverse;
        s_.motor_impulse[i] = bounded(own, from_lower, from_upper);
        answer(s_.inverse_matrix + (3 + i) * (joints_ + 3), s_.motor_impulse[i] - before, v);
      }
    }
  }

  const SpatialMemory<Number>& m_;
  const SpatialScratch<Number>& s_;
  std::size_t joints_;
  std::size_t contacts_;
  const std::size_t* free_joints_;
  std::size_t free_count_;
  Number inverse_mass_;
};

}  // namespace
}  // namespace proleg::sim::reduced
