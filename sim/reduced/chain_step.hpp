#pragma once

// A step of chains, one in each lane of a vector.
//
// This header and those that it includes are compiled once for each instruction set. Everything in them has internal
// linkage: a function that the linker took from another of these texts would run instructions that a processor does not
// have. For the same reason they call nothing from the standard library.
//
// Method. The state is kept as velocities of the links. In a step their momenta are projected onto the motions that the
// joints allow in the present pose, as an engine in maximal coordinates does; so results are near those of sim/ode.
// - A motor reaches the speed that its servo wants if its torque suffices. While all do, joint speeds are given, and
// three
//   unknowns remain: the velocity of the centre of mass and the rotation of the first link. Contacts are solved against
//   these.
// - From the result follows the torque of each motor. Where one is too large, the step is solved again with the speed
// of
//   that joint unknown and its torque bounded, until no further motor is too weak. Few chains need this in a step;
//   ChainBatch collects them, so that the others do not wait.
// - Featherstone, Rigid Body Dynamics Algorithms (2008), section 9.5, has the inertia in such coordinates.

#include <cstddef>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/chain_scratch.hpp"
#include "sim/reduced/contact_rows.hpp"
#include "sim/reduced/contact_search.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/motors.hpp"
#include "sim/reduced/planar_free_joints.hpp"
#include "sim/reduced/sine.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own

template <int width>
class ChainStep {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = Plane<Number>;

  ChainStep(const ChainForm& form, const ChainMemory<Number>& memory, const ChainScratch<Number>& scratch)
      : form_(form),
        m_(memory),
        s_(scratch),
        links_(form.counts.links),
        joints_(form.counts.joints),
        motors_(form.step_s, memory, scratch),
        free_(form, memory, scratch) {}

  /// Makes the step of the chains whose motors are all strong enough. Returns the lanes of the others: bit k for lane
  /// k. They have not changed, but is_free is set for their weak joints.
  unsigned step_strong() {
    prepare();
    Mask open = Lanes<width>::none();
    for (std::size_t j = 0; j < joints_; ++j) {
      open |= m_.is_free[j] > 0.0;
    }
    free_.leave_out();
    solve();
    find_torques();
    open |= motors_.free_weak_joints(joints_, ~open);
    finish(~open);
    return bits_of(open);
  }

  /// Makes the step of chains that step_strong() left.
  void step_weak() {
    prepare();
    Mask open = Lanes<width>::all();
    for (std::size_t round = 0; any(open); ++round) {
      const bool is_last = round > joints_;  // each round frees a joint
      free_.list();
      solve();
      find_torques();
      const Mask changed = is_last ? Lanes<width>::none() : motors_.free_weak_joints(joints_, open);
      finish(open & ~changed);
      open &= changed;
    }
  }

  /// Without a step: places the links, so that positions can be read.
  void place() { place_links(); }

 private:
  static Vector vector(const Number* array, std::size_t i) { return {array[2 * i], array[2 * i + 1]}; }
  static void put(Number* array, std::size_t i, const Vector& value) {
    array[2 * i] = value.x;
    array[2 * i + 1] = value.z;
  }
  static void put_where(Mask mask, Number& place, Number value) { place = select(mask, value, place); }

  [[nodiscard]] Vector turned_with(std::size_t link, const Point& point) const {
    return {s_.cosine[link] * point.x - s_.sine[link] * point.z, s_.sine[link] * point.x + s_.cosine[link] * point.z};
  }

  static unsigned bits_of(Mask mask) {
    unsigned bits = 0;
    for (int lane = 0; lane < width; ++lane) {
      bits |= mask[lane] != 0 ? 1U << static_cast<unsigned>(lane) : 0U;
    }
    return bits;
  }

  void prepare() {
    place_links();
    for (std::size_t j = 0; j < joints_; ++j) {
      motors_.bound_speed(j, form_.joints[j]);
    }
    ContactSearch<width> search(form_, m_, s_);
    contacts_ = search.run();
    contact_count_ = search.counts();
    prepare_contacts();
    const Vector gravity{m_.gravity[0], m_.gravity[1]};
    free_speed_ = Vector{m_.center_speed[0], m_.center_speed[1]} + gravity * Lanes<width>::number(form_.step_s);
  }

  void finish(Mask done) {
    keep(done);
    sum_contact_forces(done);
    note_failures(done);
  }

  void place_links() {
    Number angle = m_.angle[0];
    Vector joint{};
    Vector sum{};
    for (std::size_t i = 0; i < links_; ++i) {
      if (i > 0) {
        angle += m_.joint_angle[i - 1];
      }
      const SineCosine<Number> turn = sine_cosine<width>(angle);
      s_.sine[i] = turn.sine;
      s_.cosine[i] = turn.cosine;
      Vector position{};
      if (i > 0) {
        position = joint - turned_with(i, form_.links[i].front);
      }
      if (i < joints_) {
        joint = position + turned_with(i, form_.links[i].rear);
        put(s_.joint_position, i, joint);
      }
      put(m_.link_position, i, position);
      sum = sum + position * m_.mass[i];
    }
    const Vector mean = sum * m_.inverse_mass[0];
    for (std::size_t i = 0; i < links_; ++i) {
      put(m_.link_position, i, vector(m_.link_position, i) - mean);
    }
    for (std::size_t j = 0; j < joints_; ++j) {
      put(s_.joint_position, j, vector(s_.joint_position, j) - mean);
    }
  }

  /// Depths to speeds. Where two links touch, the joints between them are free: what they do moves the centre not at
  /// all.
  void prepare_contacts() {
    constexpr double error_reduction = 0.2;  // share of a depth that a step corrects, as in sim/ode
    // m, of a contact at rest. If it were 0, such contacts would end, the link fall and touch anew, again and again.
    constexpr double rest_depth = 1e-6;
    const double factor = error_reduction / form_.step_s;
    for (std::size_t k = 0; k < contacts_; ++k) {
      const Mask is_there = contact_count_ > static_cast<double>(k);
      s_.depth_speed[k] = select(is_there, (s_.depth_speed[k] - rest_depth) * factor, Number{});
      s_.old_normal[k] = select(is_there, s_.old_normal[k], Number{});
      s_.old_friction[k] = select(is_there, s_.old_friction[k], Number{});
      s_.other_link[k] = select(is_there, s_.other_link[k], Lanes<width>::number(-1.0));
      const Mask is_between_links = s_.other_link[k] >= 0.0;
      if (any(is_between_links)) {
        for (std::size_t j = 0; j < joints_; ++j) {
          const auto joint = static_cast<double>(j);
          const Mask is_between = is_between_links & (s_.link[k] <= joint) & (s_.other_link[k] > joint);
          put_where(is_between, m_.is_free[j], Lanes<width>::number(1.0));
        }
      }
    }
  }

  void solve() {
    find_drift();
    find_free_motion();
    set_rows();
    if (free_.unknowns() == 1) {
      solve_rows<false>();
    } else {
      solve_rows<true>();
    }
    free_.take_speeds();
    // All speeds are known now.
    find_drift_of_speeds();
    for (std::size_t i = 0; i < links_; ++i) {
      put(s_.new_link_speed, i, vector(s_.drift, i) + turned(vector(m_.link_position, i)) * base_.rotation);
      s_.new_rotation[i] = s_.spin[i] + base_.rotation;
    }
  }

  template <bool has_free_joints>
  void solve_rows() {
    ContactRows<width, has_free_joints> rows(form_, s_, contacts_, free_.unknowns(), m_.inverse_mass[0]);
    rows.prepare(contact_count_);
    base_ = {free_speed_, s_.unknown[0]};
    rows.solve(base_);
    for (std::size_t k = 0; k < contacts_; ++k) {
      s_.sliding_speed[k] = magnitude(rows.speed_of(2 * k + 1, base_));
    }
  }

  /// Velocities of the links against the centre for the speeds of the joints, while the first link does not turn.
  void find_drift_of_speeds() {
    Vector velocity{};
    Number spin{};
    Vector sum{};
    for (std::size_t i = 0; i < links_; ++i) {
      if (i > 0) {
        const Vector joint = vector(s_.joint_position, i - 1);
        velocity = velocity + turned(joint - vector(m_.link_position, i - 1)) * spin;
        spin += s_.speed[i - 1];
        velocity = velocity - turned(joint - vector(m_.link_position, i)) * spin;
      }
      put(s_.drift, i, velocity);
      s_.spin[i] = spin;
      sum = sum + velocity * m_.mass[i];
    }
    const Vector mean = sum * m_.inverse_mass[0];
    for (std::size_t i = 0; i < links_; ++i) {
      put(s_.drift, i, vector(s_.drift, i) - mean);
    }
  }

  void find_drift() {
    free_.stop();
    find_drift_of_speeds();
  }

  /// The unknowns without contacts and motors of free joints, and the inverse of their inertia.
  void find_free_motion() {
    Number inertia{};
    Number momentum{};
    Vector linear{};
    Vector moment{};
    Number mass{};
    for (std::size_t i = links_; i-- > 0;) {
      const Vector position = vector(m_.link_position, i);
      const Vector change = (vector(m_.link_speed, i) - vector(s_.drift, i)) * m_.mass[i];
      inertia += m_.inertia[i] + m_.mass[i] * dot(position, position);
      momentum += m_.inertia[i] * (m_.rotation[i] - s_.spin[i]) + cross(position, change);
      if (i > 0 && free_.unknowns() > 1) {
        linear = linear + change;
        moment = moment + position * m_.mass[i];
        mass += m_.mass[i];
        put(s_.momentum_behind, i - 1, linear);
        put(s_.moment_behind, i - 1, moment);
        s_.mass_behind[i - 1] = mass;
        s_.inertia_behind[i - 1] = inertia;
        s_.angular_behind[i - 1] = momentum;
      }
    }
    if (free_.unknowns() == 1) {
      s_.inverse_matrix[0] = 1.0 / inertia;
      s_.unknown[0] = momentum * s_.inverse_matrix[0];
      return;
    }
    free_.start(inertia, momentum);
  }

  void set_rows() {
    const std::size_t stride = joints_ + 1;
    for (std::size_t k = 0; k < contacts_; ++k) {
      const Mask is_terrain = s_.other_link[k] < 0.0;
      const Vector arm = vector(s_.arm, k);
      const Vector normal = vector(s_.normal, k);
      const Vector along{normal.z, -normal.x};
      const Vector given = velocity_at(k, arm);
      const Number ground = select(is_terrain, Lanes<width>::number(1.0), Number{});
      for (std::size_t row = 2 * k; row < 2 * k + 2; ++row) {
        const Vector& direction = row == 2 * k ? normal : along;
        put(s_.direction, row, direction * ground);
        s_.bias[row] = dot(direction, given);
        s_.jacobian[row * stride] = cross(arm, direction) * ground;
      }
      for (std::size_t i = 0; i + 1 < free_.unknowns(); ++i) {
        const Mask is_there = free_.has(i);
        const Vector lever = turned(arm - vector(s_.free_position, i));
        Vector velocity = select(s_.link[k] > s_.free_joint[i], lever, Vector{});
        velocity = select(s_.other_link[k] > s_.free_joint[i], velocity - lever, velocity);
        velocity = select(is_terrain, velocity - turned(free_.lever(i)) * m_.inverse_mass[0], velocity);
        velocity = select(is_there, velocity, Vector{});
        s_.jacobian[2 * k * stride + i + 1] = dot(normal, velocity);
        s_.jacobian[(2 * k + 1) * stride + i + 1] = dot(along, velocity);
      }
    }
  }

  /// Of the point of a contact, for the given joint speeds: against the centre, or against the other link.
  Vector velocity_at(std::size_t contact, const Vector& arm) const {
    Vector velocity{};
    for (std::size_t i = 0; i < links_; ++i) {
      const auto link = static_cast<double>(i);
      const Mask is_link = s_.link[contact] == link;
      const Mask is_other = s_.other_link[contact] == link;
      if (any(is_link | is_other)) {
        const Vector own = vector(s_.drift, i) + turned(arm - vector(m_.link_position, i)) * s_.spin[i];
        velocity = select(is_link, velocity + own, velocity);
        velocity = select(is_other, velocity - own, velocity);
      }
    }
    return velocity;
  }

  /// The torques that the new velocities take.
  void find_torques() {
    const Vector push = base_.center - free_speed_;
    Vector linear{};
    Number angular{};
    for (std::size_t i = links_; i-- > 1;) {
      const Vector position = vector(m_.link_position, i);
      const Vector change = (vector(s_.new_link_speed, i) - vector(m_.link_speed, i) + push) * m_.mass[i];
      linear = linear + change;
      angular += m_.inertia[i] * (s_.new_rotation[i] - m_.rotation[i]) + cross(position, change);
      for (std::size_t k = 0; k < contacts_; ++k) {
        const auto link = static_cast<double>(i);
        const Mask is_link = s_.link[k] == link;
        const Mask is_other = s_.other_link[k] == link;
        if (!any(is_link | is_other)) {
          continue;
        }
        const Vector normal = vector(s_.normal, k);
        const Vector impulse = normal * s_.normal_value[k] + Vector{normal.z, -normal.x} * s_.friction_value[k];
        const Vector own = select(is_link, impulse, select(is_other, Vector{} - impulse, Vector{}));
        const Vector felt = select(contact_count_ > static_cast<double>(k), own, Vector{});
        linear = linear - felt;
        angular -= cross(vector(s_.arm, k), felt);
      }
      s_.torque_impulse[i - 1] = angular - cross(vector(s_.joint_position, i - 1), linear);
    }
  }

  /// The result of lanes that are solved becomes their state.
  void keep(Mask done) {
    const double h = form_.step_s;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Number speed = axis == 0 ? base_.center.x : base_.center.z;
      put_where(done, m_.center_speed[axis], speed);
      put_where(done, m_.center[axis], m_.center[axis] + speed * h);
    }
    put_where(done, m_.angle[0], m_.angle[0] + base_.rotation * h);
    for (std::size_t j = 0; j < joints_; ++j) {
      put_where(done, m_.joint_angle[j], m_.joint_angle[j] + s_.speed[j] * h);
      put_where(done, m_.is_free[j], Number{});
      const Number most = m_.max_torque[j];
      put_where(done, m_.motor_torque[j], bounded(s_.torque_impulse[j] * (1.0 / h), -most, most));
    }
    for (std::size_t i = 0; i < links_; ++i) {
      put_where(done, m_.link_speed[2 * i], s_.new_link_speed[2 * i]);
      put_where(done, m_.link_speed[2 * i + 1], s_.new_link_speed[2 * i + 1]);
      put_where(done, m_.rotation[i], s_.new_rotation[i]);
    }
    keep_contacts(done);
  }

  void keep_contacts(Mask done) {
    const double steps_per_s = 1.0 / form_.step_s;
    put_where(done, m_.contact_count[0], contact_count_);
    put_where(done, m_.sliding[0], Number{});
    put_where(done, m_.sliding[1], Number{});
    put_where(done, m_.sliding[2], Number{});
    for (std::size_t k = 0; k < contacts_; ++k) {
      put_where(done, m_.contact_key[k], s_.key[k]);
      put_where(done, m_.normal_impulse[k], s_.normal_value[k]);
      put_where(done, m_.friction_impulse[k], s_.friction_value[k]);
      const Mask is_terrain = done & (s_.other_link[k] < 0.0) & (contact_count_ > static_cast<double>(k));
      // A lane that an earlier round has solved may have numbers here that are not finite.
      const Number force = s_.normal_value[k] * steps_per_s;
      const Number friction = magnitude(s_.friction_value[k]) * steps_per_s;
      m_.sliding[0] += select(is_terrain, force, Number{});
      m_.sliding[1] += select(is_terrain, force * s_.sliding_speed[k], Number{});
      m_.sliding[2] += select(is_terrain, friction * s_.sliding_speed[k], Number{});
    }
  }

  void sum_contact_forces(Mask done) {
    for (std::size_t i = 0; i < links_; ++i) {
      put_where(done, m_.contact_force[i], Number{});
    }
    const double steps_per_s = 1.0 / form_.step_s;
    for (int lane = 0; lane < width; ++lane) {
      const auto count = done[lane] != 0 ? static_cast<std::size_t>(contact_count_[lane]) : 0;
      for (std::size_t k = 0; k < count; ++k) {
        const double force = m_.normal_impulse[k][lane] * steps_per_s;
        m_.contact_force[static_cast<std::size_t>(s_.link[k][lane])][lane] += force;
        if (s_.other_link[k][lane] >= 0.0) {
          m_.contact_force[static_cast<std::size_t>(s_.other_link[k][lane])][lane] += force;
        }
      }
    }
  }

  /// A number that is not finite makes the product of the sum with 0 not 0.
  void note_failures(Mask done) {
    Number sum = m_.center[0] + m_.center[1] + m_.angle[0];
    for (std::size_t j = 0; j < joints_; ++j) {
      sum += m_.joint_angle[j];
    }
    put_where(done & ~(sum * 0.0 == 0.0), m_.failed[0], Lanes<width>::number(not_finite));
  }

  const ChainForm& form_;
  const ChainMemory<Number>& m_;
  const ChainScratch<Number>& s_;
  std::size_t links_;
  std::size_t joints_;
  Motors<width, ChainMemory<Number>, ChainScratch<Number>> motors_;
  PlanarFreeJoints<width> free_;
  std::size_t contacts_ = 0;  ///< most of a lane
  Number contact_count_{};
  Vector free_speed_;       ///< of the centre, without contacts
  BaseMotion<width> base_;  ///< after the step
};

}  // namespace
}  // namespace proleg::sim::reduced
