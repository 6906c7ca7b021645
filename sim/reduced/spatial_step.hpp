#pragma once

// A step of chains with joints of any axis on a level floor, one chain in each lane of a vector. The method is that of
// chain_step.hpp: while all motors are strong enough, joint speeds are given, and six unknowns remain, the velocity of
// the centre of mass and the rotation of the first link. The links' angular momenta are kept, not their rotations: so a
// body that turns freely keeps its momentum, whatever its inertia is after the step.

#include <cstddef>

#include "sim/reduced/box_overlap.hpp"
#include "sim/reduced/floor_contact.hpp"
#include "sim/reduced/free_joints.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/motors.hpp"
#include "sim/reduced/sine.hpp"
#include "sim/reduced/space.hpp"
#include "sim/reduced/spatial_memory.hpp"
#include "sim/reduced/spatial_rows.hpp"
#include "sim/reduced/spatial_scratch.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

template <int width>
class SpatialStep {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Space<Number>;
  using Inertia = Tensor<Number>;

  SpatialStep(const SpatialForm& form, const SpatialMemory<Number>& memory, const SpatialScratch<Number>& scratch)
      : form_(form),
        m_(memory),
        s_(scratch),
        links_(form.counts.links),
        joints_(form.counts.joints),
        motors_(form.step_s, memory, scratch),
        free_(form, memory, scratch) {}

  /// As ChainStep::step_strong().
  unsigned step_strong() {
    prepare();
    Mask open = Lanes<width>::none();
    for (std::size_t j = 0; j < joints_; ++j) {
      open |= m_.is_free[j] > 0.0;
    }
    solve<false>();
    find_torques();
    open |= motors_.free_weak_joints(joints_, ~open);
    finish(~open);
    unsigned lanes = 0;
    for (int lane = 0; lane < width; ++lane) {
      lanes |= open[lane] != 0 ? 1U << static_cast<unsigned>(lane) : 0U;
    }
    return lanes;
  }

  /// As ChainStep::step_weak().
  void step_weak() {
    prepare();
    Mask open = Lanes<width>::all();
    for (std::size_t round = 0; any(open); ++round) {
      const bool is_last = round > joints_;  // each round frees a joint
      free_.list();
      solve<true>();
      find_torques();
      const Mask changed = is_last ? Lanes<width>::none() : motors_.free_weak_joints(joints_, open);
      finish(open & ~changed);
      open &= changed;
    }
  }

  /// As ChainStep::place().
  void place() { place_links(); }

 private:
  static void put_where(Mask mask, Number& place, Number value) { place = select(mask, value, place); }
  static void put_where(Mask mask, Number* array, std::size_t i, const Vector& value) {
    put(array, i, select(mask, value, space_at(array, i)));
  }
  static Vector vector(const Point3& p) {
    return {Lanes<width>::number(p.x), Lanes<width>::number(p.y), Lanes<width>::number(p.z)};
  }
  [[nodiscard]] Vector position(std::size_t link) const { return space_at(m_.link_position, link); }
  [[nodiscard]] Vector joint(std::size_t j) const { return space_at(s_.joint_position, j); }

  void prepare() {
    place_links();
    find_inertia();
    for (std::size_t j = 0; j < joints_; ++j) {
      motors_.bound_speed(j, form_.joints[j].limits);
    }
    FloorContact<width> floor(form_, m_, s_);
    contacts_ = floor.run();
    contact_count_ = floor.counts();
    prepare_contacts();
    overlap_ = form_.self_collision ? BoxOverlap<width>(form_, m_).run() : Number{};
    free_speed_ = space_at(m_.center_speed, 0) + space_at(m_.gravity, 0) * Lanes<width>::number(form_.step_s);
  }

  void finish(Mask done) {
    keep(done);
    keep_contacts(done);
    note_failures(done);
  }

  void place_links() {
    Turn<Number> turn = first_turn();
    Vector middle{};
    Vector sum{};
    for (std::size_t i = 0; i < links_; ++i) {
      if (i > 0) {
        const std::size_t j = i - 1;
        const Vector axis = turn * vector(form_.joints[j].axis);
        const Vector place = middle + turn * vector(form_.links[j].rear);
        turn = turned(turn, axis, m_.joint_angle[j]);
        middle = place - turn * vector(form_.links[i].front);
        put(s_.axis, j, axis);
        put(s_.joint_position, j, place);
      }
      put(m_.link_position, i, middle);
      put(m_.link_turn, 3 * i, turn.x);
      put(m_.link_turn, 3 * i + 1, turn.y);
      put(m_.link_turn, 3 * i + 2, turn.z);
      sum = sum + middle * m_.mass[i];
    }
    const Vector mean = sum * m_.inverse_mass[0];
    for (std::size_t i = 0; i < links_; ++i) {
      put(m_.link_position, i, position(i) - mean);
    }
    for (std::size_t j = 0; j < joints_; ++j) {
      put(s_.joint_position, j, joint(j) - mean);
    }
  }

  [[nodiscard]] Turn<Number> first_turn() const {
    const Number w = m_.orientation[0];
    const Number x = m_.orientation[1];
    const Number y = m_.orientation[2];
    const Number z = m_.orientation[3];
    Turn<Number> turn;
    turn.x = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)};
    turn.y = {2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)};
    turn.z = cross(turn.x, turn.y);
    return turn;
  }

  /// About a unit vector in the world (Rodrigues).
  static Turn<Number> turned(const Turn<Number>& turn, const Vector& axis, Number angle) {
    const SineCosine<Number> by = sine_cosine<width>(angle);
    const auto turned_vector = [&](const Vector& v) {
      return v * by.cosine + cross(axis, v) * by.sine + axis * (dot(axis, v) * (1.0 - by.cosine));
    };
    Turn<Number> result;
    result.x = turned_vector(turn.x);
    result.y = turned_vector(turn.y);
    result.z = cross(result.x, result.y);
    return result;
  }

  /// Of each link about its own centre of mass, and of the links behind a joint and of all about that of the chain.
  void find_inertia() {
    inertia_ = Inertia{};
    for (std::size_t i = links_; i-- > 0;) {
      const Number* axes = m_.link_turn + 9 * i;
      const Turn<Number> turn{space_at(axes, 0), space_at(axes, 1), space_at(axes, 2)};
      const Inertia own = turned_inertia(turn, tensor_at(m_.inertia, i));
      put(s_.turned_inertia, i, own);
      inertia_ = inertia_ + own + point_inertia(m_.mass[i], position(i));
      if (i > 0) {
        put(s_.inertia_behind, i - 1, inertia_);
      }
    }
  }

  /// Depths to speeds; a contact that a lane does not have gets no impulse.
  void prepare_contacts() {
    constexpr double error_reduction = 0.2;  // as in ChainStep
    constexpr double rest_depth = 1e-6;      // m
    const double factor = error_reduction / form_.step_s;
    for (std::size_t k = 0; k < contacts_; ++k) {
      const Mask is_there = contact_count_ > static_cast<double>(k);
      s_.depth_speed[k] = select(is_there, (s_.depth_speed[k] - rest_depth) * factor, Number{});
      put(s_.old_impulse, k, select(is_there, space_at(s_.old_impulse, k), Vector{}));
      put(s_.arm, k, select(is_there, space_at(s_.arm, k), Vector{}));
      put(s_.lever, k, select(is_there, space_at(s_.lever, k), Vector{}));
      s_.link[k] = select(is_there, s_.link[k], Number{});
    }
  }

  template <bool has_free_joints>
  void solve() {
    if constexpr (has_free_joints) {
      free_.stop();
    }
    find_drift();
    const Vector momentum = sum_momenta<has_free_joints>();
    Inertia inverse{};
    motion_.center = free_speed_;
    if constexpr (has_free_joints) {
      free_.start(inertia_, momentum);
      motion_.rotation = space_at(s_.unknown, 0);
    } else {
      inverse = inverse_of(inertia_);
      motion_.rotation = inverse * momentum;
    }
    find_given_speeds();
    if constexpr (has_free_joints) {
      free_.set_jacobians(contacts_);
    }
    SpatialRows<width, has_free_joints> rows(form_, m_, s_, contacts_, free_.numbers(), free_.count());
    rows.prepare(contact_count_, inverse);
    rows.solve(motion_);
    for (std::size_t k = 0; k < contacts_; ++k) {
      s_.given[3 * k] = rows.speed_along(k, 0, motion_);
      s_.given[3 * k + 1] = rows.speed_along(k, 1, motion_);
    }
    if constexpr (has_free_joints) {
      free_.take_speeds();
      find_drift();  // all speeds are known now
    }
    for (std::size_t i = 0; i < links_; ++i) {
      put(s_.new_link_speed, i, space_at(s_.drift, i) + cross(motion_.rotation, position(i)));
      put(s_.new_momentum, i, tensor_at(s_.turned_inertia, i) * (space_at(s_.spin, i) + motion_.rotation));
    }
  }

  /// Velocities of the links against the centre for the speeds of the joints, while the first link does not turn.
  void find_drift() {
    Vector velocity{};
    Vector spin{};
    Vector sum{};
    for (std::size_t i = 0; i < links_; ++i) {
      if (i > 0) {
        const Vector place = joint(i - 1);
        velocity = velocity + cross(spin, place - position(i - 1));
        spin = spin + space_at(s_.axis, i - 1) * s_.speed[i - 1];
        velocity = velocity - cross(spin, place - position(i));
      }
      put(s_.drift, i, velocity);
      put(s_.spin, i, spin);
      sum = sum + velocity * m_.mass[i];
    }
    const Vector mean = sum * m_.inverse_mass[0];
    for (std::size_t i = 0; i < links_; ++i) {
      put(s_.drift, i, space_at(s_.drift, i) - mean);
    }
  }

  /// The angular momentum, about the centre, that the drift lacks.
  template <bool has_free_joints>
  Vector sum_momenta() {
    Vector angular{};
    Vector linear{};
    Vector moment{};
    Number mass{};
    for (std::size_t i = links_; i-- > 0;) {
      const Vector change = (space_at(m_.link_speed, i) - space_at(s_.drift, i)) * m_.mass[i];
      angular = angular + (space_at(m_.spin_momentum, i) - tensor_at(s_.turned_inertia, i) * space_at(s_.spin, i)) +
                cross(position(i), change);
      if (has_free_joints && i > 0) {
        linear = linear + change;
        moment = moment + position(i) * m_.mass[i];
        mass += m_.mass[i];
        put(s_.momentum_behind, i - 1, linear);
        put(s_.angular_behind, i - 1, angular);
        put(s_.moment_behind, i - 1, moment);
        s_.mass_behind[i - 1] = mass;
      }
    }
    return angular;
  }

  void find_given_speeds() {
    for (std::size_t k = 0; k < contacts_; ++k) {
      for (int lane = 0; lane < width; ++lane) {
        const std::size_t link = 3 * static_cast<std::size_t>(s_.link[k][lane]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          s_.given[3 * k + axis][lane] = s_.drift[link + axis][lane];
          s_.link_spin[3 * k + axis][lane] = s_.spin[link + axis][lane];
        }
      }
      put(s_.given, k, space_at(s_.given, k) + cross(space_at(s_.link_spin, k), space_at(s_.lever, k)));
    }
  }

  /// The torques that the new velocities take.
  void find_torques() {
    sum_contact_impulses();
    const Vector push = motion_.center - free_speed_;
    Vector linear{};
    Vector angular{};
    for (std::size_t i = links_; i-- > 1;) {
      const Vector change = (space_at(s_.new_link_speed, i) - space_at(m_.link_speed, i) + push) * m_.mass[i];
      linear = linear + (change - space_at(s_.contact_impulse, i));
      angular = angular + (space_at(s_.new_momentum, i) - space_at(m_.spin_momentum, i)) +
                (cross(position(i), change) - space_at(s_.contact_moment, i));
      s_.torque_impulse[i - 1] = dot(space_at(s_.axis, i - 1), angular - cross(joint(i - 1), linear));
    }
  }

  void sum_contact_impulses() {
    for (std::size_t i = 0; i < links_; ++i) {
      put(s_.contact_impulse, i, Vector{});
      put(s_.contact_moment, i, Vector{});
    }
    for (std::size_t k = 0; k < contacts_; ++k) {
      const Vector impulse = space_at(s_.value, k);
      const Vector moment = cross(space_at(s_.arm, k), impulse);
      for (int lane = 0; lane < width; ++lane) {
        if (contact_count_[lane] > static_cast<double>(k)) {
          const std::size_t link = 3 * static_cast<std::size_t>(s_.link[k][lane]);
          s_.contact_impulse[link][lane] += impulse.x[lane];
          s_.contact_impulse[link + 1][lane] += impulse.y[lane];
          s_.contact_impulse[link + 2][lane] += impulse.z[lane];
          s_.contact_moment[link][lane] += moment.x[lane];
          s_.contact_moment[link + 1][lane] += moment.y[lane];
          s_.contact_moment[link + 2][lane] += moment.z[lane];
        }
      }
    }
  }

  /// The result of lanes that are solved becomes their state.
  void keep(Mask done) {
    const Number h = Lanes<width>::number(form_.step_s);
    // The sum with 0 makes -0 to 0, which are different bits and may depend on the other lanes.
    const Vector zero{};
    put_where(done, m_.center_speed, 0, motion_.center + zero);
    put_where(done, m_.center, 0, space_at(m_.center, 0) + motion_.center * h);
    turn_first_link(done);
    for (std::size_t j = 0; j < joints_; ++j) {
      put_where(done, m_.joint_angle[j], m_.joint_angle[j] + s_.speed[j] * h);
      put_where(done, m_.is_free[j], Number{});
      const Number most = m_.max_torque[j];
      put_where(done, m_.motor_torque[j], bounded(s_.torque_impulse[j] * (1.0 / form_.step_s), -most, most) + 0.0);
    }
    for (std::size_t i = 0; i < links_; ++i) {
      put_where(done, m_.link_speed, i, space_at(s_.new_link_speed, i) + zero);
      put_where(done, m_.spin_momentum, i, space_at(s_.new_momentum, i) + zero);
      put_where(done, m_.rotation, i, space_at(s_.spin, i) + motion_.rotation + zero);
    }
    put_where(done, m_.overlap[0], overlap_);
  }

  /// As ODE does: the rotation's first order, made a unit quaternion again.
  void turn_first_link(Mask done) {
    const Number w = m_.orientation[0];
    const Vector v = space_at(m_.orientation + 1, 0);
    const Vector half = motion_.rotation * Lanes<width>::number(0.5 * form_.step_s);
    const Number new_w = w - dot(half, v);
    const Vector new_v = v + half * w + cross(half, v);
    const Number scale = 1.0 / square_root(new_w * new_w + dot(new_v, new_v));
    put_where(done, m_.orientation[0], new_w * scale + 0.0);
    put_where(done, m_.orientation + 1, 0, new_v * scale + Vector{});
  }

  void keep_contacts(Mask done) {
    const double steps_per_s = 1.0 / form_.step_s;
    put_where(done, m_.contact_count[0], contact_count_);
    Vector sliding{};
    for (std::size_t k = 0; k < contacts_; ++k) {
      const Mask is_there = done & (contact_count_ > static_cast<double>(k));
      const Vector impulse = space_at(s_.value, k);
      put_where(done, m_.contact_corner[k], s_.corner[k]);
      put_where(done, m_.impulse, k, impulse);
      const Number x = s_.given[3 * k];  // speeds after the step
      const Number y = s_.given[3 * k + 1];
      const Number force = impulse.z * steps_per_s;
      const Number power = magnitude(impulse.x * x + impulse.y * y) * steps_per_s;
      sliding = sliding + select(is_there, Vector{force, force * square_root(x * x + y * y), power}, Vector{});
    }
    put_where(done, m_.sliding, 0, sliding);
    for (std::size_t i = 0; i < links_; ++i) {
      put_where(done, m_.contact_force[i], s_.contact_impulse[3 * i + 2] * steps_per_s);
    }
  }

  /// A number that is not finite makes the product of the sum with 0 not 0.
  void note_failures(Mask done) {
    Number sum = m_.center[0] + m_.center[1] + m_.center[2] + m_.orientation[0];
    for (std::size_t j = 0; j < joints_; ++j) {
      sum += m_.joint_angle[j];
    }
    put_where(done & ~(sum * 0.0 == 0.0), m_.failed[0], Lanes<width>::number(not_finite));
  }

  const SpatialForm& form_;
  const SpatialMemory<Number>& m_;
  const SpatialScratch<Number>& s_;
  std::size_t links_;
  std::size_t joints_;
  std::size_t contacts_ = 0;  ///< most of a lane
  Number contact_count_{};
  Motors<width, SpatialMemory<Number>, SpatialScratch<Number>> motors_;
  FreeJoints<width> free_;
  Inertia inertia_;              ///< of the chain, about its centre of mass
  Vector free_speed_;            ///< of the centre, without contacts
  SpatialMotion<width> motion_;  ///< after the step
  Number overlap_;
};

}  // namespace
}  // namespace proleg::sim::reduced
