#pragma once

#include <cstddef>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/contact_list.hpp"
#include "sim/reduced/free_joints.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/vectors.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

/// Bounds the friction in a plane.
template <typename Number>
inline void bound_friction(const Number& most, Number (&friction)[1]) {
  friction[0] = bounded(friction[0], -most, most);
}
/// Bounds the friction on a floor in every direction alike: an impulse that is too large becomes shorter and keeps its
/// direction.
template <typename Number>
inline void bound_friction(const Number& most, Number (&friction)[2]) {
  const Number square = friction[0] * friction[0] + friction[1] * friction[1];
  const auto is_too_large = square > most * most;
  const Number one = Number{} + 1.0;
  const Number factor = select(is_too_large, most / square_root(select(is_too_large, square, one)), one);
  friction[0] = friction[0] * factor;
  friction[1] = friction[1] * factor;
}

/// Solves for the impulses of contacts and of motors of free joints, one row after the other, again and again
/// (projected Gauss-Seidel). First come normal impulses; they bound the friction. Then come both. The impulses of the
/// last step are the start. has_free_joints: whether any lane has free joints.
template <typename Kind, int width, bool has_free_joints>
class ContactRows {
 public:
  using Number = typename Lanes<width>::Number;
  using Spin = typename Quantities<Kind, Number>::Spin;
  using Inertia = typename Quantities<Kind, Number>::Inertia;
  using Unknowns = Motion<Kind, Number>;

  ContactRows(const ChainScratch<Kind, Number>& scratch, const Contacts<Kind, width>& contacts,
              const FreeJoints<Kind, width>& free, std::size_t joints, const Number& inverse_mass)
      : s_(scratch),
        contacts_(contacts),
        free_(free),
        stride_(joints + Kind::spin_axes),
        most_contacts_(contacts.most()),
        free_count_(has_free_joints ? free.count() : 0),
        inverse_mass_(inverse_mass) {}

  /// Computes the responses. The rows of the contacts and the Jacobians of free joints must be there. inverse: that of
  /// the inertia, if there are no free joints.
  void prepare(const Inertia& inverse) const {
    for (std::size_t k = 0; k < most_contacts_; ++k) {
      Number mobility[Kind::axes];
      for_friction([&](auto axis) { mobility[axis] = respond<axis>(k, inverse); });
      mobility[normal] = respond<normal>(k, inverse);
      Number most = mobility[0];
      for (std::size_t axis = 1; axis < normal; ++axis) {
        most = larger(most, mobility[axis]);
      }
      // A contact that a lane does not have gives no impulse.
      s_.normal_inverse[k] = select(contacts_.has(k), 1.0 / mobility[normal], Number{});
      s_.friction_inverse[k] = select(contacts_.has(k), 1.0 / most, Number{});
    }
  }

  /// motion: in and out, as the unknowns of free joints in the scratch memory. At the end ChainScratch::given has the
  /// sliding speeds.
  void solve(Unknowns& motion) const {
    constexpr int normal_sweeps = 4;
    constexpr int sweeps = 6;
    Unknowns v = motion;
    for (std::size_t k = 0; k < most_contacts_; ++k) {
      value(k, normal) = s_.old_impulse[Kind::axes * k + normal];
      apply<normal>(k, value(k, normal), v);
    }
    for (int sweep = 0; sweep < normal_sweeps; ++sweep) {
      turn_motors(v);
      for (std::size_t k = 0; k < most_contacts_; ++k) {
        push(k, v);
      }
    }
    for (std::size_t k = 0; k < most_contacts_; ++k) {
      s_.most_friction[k] = value(k, normal) * s_.friction[k];
      Number friction[normal];
      for_friction([&](auto axis) { friction[axis] = s_.old_impulse[Kind::axes * k + axis]; });
      bound_friction(s_.most_friction[k], friction);
      for_friction([&](auto axis) {
        value(k, axis) = friction[axis];
        apply<axis>(k, friction[axis], v);
      });
    }
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      turn_motors(v);
      for (std::size_t k = 0; k < most_contacts_; ++k) {
        push(k, v);
        rub(k, v);
      }
    }
    for (std::size_t k = 0; k < most_contacts_; ++k) {
      for_friction([&](auto axis) { s_.given[Kind::axes * k + axis] = speed_along<axis>(k, v); });
    }
    motion = v;
  }

 private:
  static constexpr std::size_t normal = Kind::axes - 1;  ///< the row of a contact behind those of its friction

  /// The number of a row among those of a contact, known when the program is compiled.
  template <std::size_t number>
  struct Axis {
    constexpr operator std::size_t() const { return number; }  // NOLINT(google-explicit-constructor)
  };
  /// act(axis): for each row of friction.
  template <typename Act>
  static void for_friction(const Act& act) {
    act(Axis<0>{});
    if constexpr (normal > 1) {
      act(Axis<1>{});
    }
  }

  [[nodiscard]] Number& value(std::size_t contact, std::size_t axis) const {
    return s_.value[Kind::axes * contact + axis];
  }
  [[nodiscard]] Number* jacobian_of(std::size_t contact, std::size_t axis) const {
    return s_.jacobian + (Kind::axes * contact + axis) * stride_;
  }
  [[nodiscard]] Number* response_of(std::size_t contact, std::size_t axis) const {
    return s_.response + (Kind::axes * contact + axis) * stride_;
  }

  /// The speed in the direction of a row, m/s.
  template <std::size_t axis>
  [[nodiscard]] Number speed_along(std::size_t contact, const Unknowns& v) const {
    Number speed = contacts_.template speed_along<axis>(contact, v);
    if constexpr (has_free_joints) {
      const Number* jacobian = jacobian_of(contact, axis);
      for (std::size_t i = Kind::spin_axes; i < Kind::spin_axes + free_count_; ++i) {
        speed += jacobian[i] * s_.unknown[i];
      }
    }
    return speed;
  }

  /// Returns the mobility of the row.
  template <std::size_t axis>
  Number respond(std::size_t contact, const Inertia& inverse) const {
    Number* response = response_of(contact, axis);
    const Spin turning = contacts_.template turning<axis>(contact);
    const Number of_center = contacts_.template center_mobility<axis>(contact);
    if constexpr (!has_free_joints) {
      const Spin answer = inverse * turning;
      put(response, 0, answer);
      return of_center + dot(answer, turning);
    } else {
      Number* jacobian = jacobian_of(contact, axis);
      put(jacobian, 0, turning);
      constexpr bool adds_center_first = Kind::axes == 2;  // which decides the last bit
      Number mobility = adds_center_first ? of_center : Number{};
      for (std::size_t i = 0; i < Kind::spin_axes + free_count_; ++i) {
        const Number* row = s_.inverse_matrix + i * stride_;
        Number sum = row[0] * jacobian[0];
        for (std::size_t k = 1; k < Kind::spin_axes + free_count_; ++k) {
          sum += row[k] * jacobian[k];
        }
        response[i] = sum;
        mobility += jacobian[i] * sum;
      }
      return adds_center_first ? mobility : of_center + mobility;
    }
  }

  template <std::size_t axis>
  void apply(std::size_t contact, const Number& impulse, Unknowns& v) const {
    contacts_.template push_center<axis>(contact, impulse * inverse_mass_, v);
    answer({response_of(contact, axis), 1}, impulse, v);
  }

  void answer(const Response<Number>& response, const Number& impulse, Unknowns& v) const {
    v.rotation = v.rotation + at<Spin>(response.first, 0) * impulse;
    if constexpr (has_free_joints) {
      for (std::size_t i = Kind::spin_axes; i < Kind::spin_axes + free_count_; ++i) {
        s_.unknown[i] += response.first[i * response.step] * impulse;
      }
    }
  }

  [[gnu::always_inline]] void push(std::size_t contact, Unknowns& v) const {
    const Number before = value(contact, normal);
    const Number missing = s_.depth_speed[contact] - speed_along<normal>(contact, v);
    const Number after = larger(before + missing * s_.normal_inverse[contact], Number{});
    value(contact, normal) = after;
    apply<normal>(contact, after - before, v);
  }

  void rub(std::size_t contact, Unknowns& v) const {
    Number after[normal];
    for_friction([&](auto axis) {
      after[axis] = value(contact, axis) - speed_along<axis>(contact, v) * s_.friction_inverse[contact];
    });
    bound_friction(s_.most_friction[contact], after);
    for_friction([&](auto axis) {
      const Number before = value(contact, axis);
      value(contact, axis) = after[axis];
      apply<axis>(contact, after[axis] - before, v);
    });
  }

  /// A motor tries to reach the wanted speed with the torque that it has; a stop keeps the speed within its bounds with
  /// any torque.
  [[gnu::always_inline]] void turn_motors(Unknowns& v) const {
    if constexpr (has_free_joints) {
      for (std::size_t i = 0; i < free_count_; ++i) {
        const Number before = s_.motor_impulse[i];
        const Number speed = s_.unknown[Kind::spin_axes + i];
        const Number inverse = s_.motor_inverse[i];
        const Number most = s_.free_max_impulse[i];
        const Number own = bounded(before + (s_.free_wanted[i] - speed) * inverse, -most, most);
        const Number from_lower = before + (s_.free_lowest[i] - speed) * inverse;
        const Number from_upper = before + (s_.free_highest[i] - speed) * inverse;
        s_.motor_impulse[i] = bounded(own, from_lower, from_upper);
        answer(free_.motor_response(i), s_.motor_impulse[i] - before, v);
      }
    }
  }

  const ChainScratch<Kind, Number>& s_;
  const Contacts<Kind, width>& contacts_;
  const FreeJoints<Kind, width>& free_;
  std::size_t stride_;  ///< from row to row, in unknowns
  std::size_t most_contacts_;
  std::size_t free_count_;
  Number inverse_mass_;
};

}  // namespace
}  // namespace proleg::sim::reduced
