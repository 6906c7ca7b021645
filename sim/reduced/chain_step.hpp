#pragma once

// A step of chains, one in each lane of a vector.
//
// This header and those that it includes are compiled once for each instruction set. Everything in them has internal
// linkage: a function that the linker took from another of these texts would run instructions that a processor does not
// have. For the same reason they call nothing from the standard library.
//
// Method. The state is kept as velocities of the links. In a step their momenta are projected onto the motions that the
// joints allow in the present pose, as an engine in maximal coordinates does; so results are near those of sim/ode.
// - A motor reaches the speed that its servo commands if its torque suffices. While all do, joint speeds are given, and
//   three unknowns remain (six in space): the velocity of the centre of mass and the rotation of the first link.
//   Contacts are solved against these.
// - From the result follows the torque of each motor. Where one is too large, the step is solved again with the speed
// of
//   that joint unknown and its torque bounded, until no further motor is too weak. Few chains need this in a step;
//   ChainBatch collects them, so that the others do not wait.
// - Featherstone, Rigid Body Dynamics Algorithms (2008), section 9.5, has the inertia in such coordinates.

#include <cstddef>

#include "sim/reduced/chain_memory.hpp"
#include "sim/reduced/contact_rows.hpp"
#include "sim/reduced/free_joints.hpp"
#include "sim/reduced/kernel.hpp"
#include "sim/reduced/lanes.hpp"
#include "sim/reduced/mechanics.hpp"
#include "sim/reduced/planar_contacts.hpp"
#include "sim/reduced/spatial_contacts.hpp"
#include "sim/reduced/vectors.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own

template <typename Kind, int width>
class ChainStep {
 public:
  using Number = typename Lanes<width>::Number;
  using Mask = typename Lanes<width>::Mask;
  using Vector = typename Quantities<Kind, Number>::Vector;
  using Spin = typename Quantities<Kind, Number>::Spin;
  using Inertia = typename Quantities<Kind, Number>::Inertia;

  ChainStep(const ChainForm<Kind>& form, const ChainMemory<Kind, Number>& memory,
            const ChainScratch<Kind, Number>& scratch)
      : form_(form),
        m_(memory),
        s_(scratch),
        links_(form.counts.links),
        joints_(form.counts.joints),
        mechanics_(form, memory, scratch),
        contacts_(form, memory, scratch),
        free_(form, memory, scratch) {}

  /// Makes the step of the chains whose motors are all strong enough. Returns the lanes of the others: bit k for lane
  /// k. They have not changed, but is_free is set for their weak joints.
  unsigned step_strong() {
    prepare();
    Mask open = Lanes<width>::none();
    for (std::size_t j = 0; j < joints_; ++j) {
      open |= m_.is_free[j] > 0.0;
    }
    solve<false>();
    find_torques();
    open |= free_weak_joints(~open);
    keep(~open);
    return bits_of(open);
  }

  /// Makes the step of chains that step_strong() left.
  void step_weak() {
    prepare();
    Mask open = Lanes<width>::all();
    for (std::size_t round = 0; any(open); ++round) {
      const bool is_last = round > joints_;  // each round frees a joint
      free_.list();
      solve<true>();
      find_torques();
      const Mask changed = is_last ? Lanes<width>::none() : free_weak_joints(open);
      keep(open & ~changed);
      open &= changed;
    }
  }

  /// Computes where the links are, without a step.
  void place_links() {
    auto turn = mechanics_.first_turn();
    Vector middle{};
    Vector sum{};
    for (std::size_t i = 0; i < links_; ++i) {
      if (i > 0) {
        const Vector place = middle + turn * form_.links[i - 1].rear;
        mechanics_.turn_joint(i - 1, turn);
        middle = place - turn * form_.links[i].front;
        put(s_.joint_position, i - 1, place);
      }
      mechanics_.keep_turn(i, turn);
      put(m_.link_position, i, middle);
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

 private:
  [[nodiscard]] Vector position(std::size_t link) const { return at<Vector>(m_.link_position, link); }
  [[nodiscard]] Vector joint(std::size_t j) const { return at<Vector>(s_.joint_position, j); }

  void prepare() {
    place_links();
    find_inertia();
    for (std::size_t j = 0; j < joints_; ++j) {
      bound_speed(j);
    }
    contacts_.find();
    free_speed_ = at<Vector>(m_.center_speed, 0) + at<Vector>(m_.gravity, 0) * Lanes<width>::number(form_.step_s);
  }

  /// The inertia of the links behind each joint, and that of all, about the centre.
  void find_inertia() {
    inertia_ = Inertia{};
    for (std::size_t i = links_; i-- > 0;) {
      inertia_ = with_link(inertia_, mechanics_.own_inertia(i), point_inertia(m_.mass[i], position(i)));
      if (i > 0) {
        put(s_.inertia_behind, i - 1, inertia_);
      }
    }
  }

  /// Joint j gets the speed that its servo commands, but not beyond its stops.
  void bound_speed(std::size_t j) const {
    const double steps_per_s = 1.0 / form_.step_s;
    s_.lowest_speed[j] = (form_.joints[j].lower - m_.joint_angle[j]) * steps_per_s;
    s_.highest_speed[j] = (form_.joints[j].upper - m_.joint_angle[j]) * steps_per_s;
    s_.speed[j] = bounded(m_.wanted_speed[j], s_.lowest_speed[j], s_.highest_speed[j]);
    // A limp joint is free from the start.
    put_where(m_.max_torque[j] == 0.0, m_.is_free[j], Lanes<width>::number(1.0));
  }

  template <bool has_free_joints>
  void solve() {
    if constexpr (has_free_joints) {
      free_.stop();
    }
    find_drift();
    const Spin momentum = sum_momenta<has_free_joints>();
    Inertia inverse{};
    motion_.center = free_speed_;
    if constexpr (has_free_joints) {
      free_.start(inertia_, momentum);
      motion_.rotation = at<Spin>(s_.unknown, 0);
    } else {
      inverse = inverse_of(inertia_);
      motion_.rotation = inverse * momentum;
    }
    contacts_.set_rows();
    if constexpr (has_free_joints) {
      free_.set_jacobians(contacts_.most());
    }
    const ContactRows<Kind, width, has_free_joints> rows(s_, contacts_, free_, joints_, m_.inverse_mass[0]);
    rows.prepare(inverse);
    rows.solve(motion_);
    if constexpr (has_free_joints) {
      free_.take_speeds();
      find_drift();  // all speeds are known now
    }
    for (std::size_t i = 0; i < links_; ++i) {
      put(s_.new_link_speed, i, at<Vector>(s_.drift, i) + cross(motion_.rotation, position(i)));
      put(s_.new_rotation, i, at<Spin>(s_.spin, i) + motion_.rotation);
      mechanics_.set_new_momentum(i);
    }
  }

  /// Velocities of the links against the centre for the speeds of the joints, while the first link does not turn.
  void find_drift() const {
    Vector velocity{};
    Spin spin{};
    Vector sum{};
    for (std::size_t i = 0; i < links_; ++i) {
      if (i > 0) {
        const Vector place = joint(i - 1);
        velocity = velocity + cross(spin, place - position(i - 1));
        spin = spin + mechanics_.joint_spin(i - 1);
        velocity = velocity - cross(spin, place - position(i));
      }
      put(s_.drift, i, velocity);
      put(s_.spin, i, spin);
      sum = sum + velocity * m_.mass[i];
    }
    const Vector mean = sum * m_.inverse_mass[0];
    for (std::size_t i = 0; i < links_; ++i) {
      put(s_.drift, i, at<Vector>(s_.drift, i) - mean);
    }
  }

  /// The angular momentum, about the centre, that the drift lacks.
  template <bool has_free_joints>
  Spin sum_momenta() const {
    Spin angular{};
    Vector linear{};
    Vector moment{};
    Number mass{};
    for (std::size_t i = links_; i-- > 0;) {
      const Vector change = (at<Vector>(m_.link_speed, i) - at<Vector>(s_.drift, i)) * m_.mass[i];
      angular = with_link(angular, mechanics_.missing_momentum(i), cross(position(i), change));
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

  /// The torques that the new velocities take.
  void find_torques() const {
    contacts_.sum_impulses();
    const Vector push = motion_.center - free_speed_;
    Vector linear{};
    Spin angular{};
    for (std::size_t i = links_; i-- > 1;) {
      const Vector gain = (at<Vector>(s_.new_link_speed, i) - at<Vector>(m_.link_speed, i) + push) * m_.mass[i];
      contacts_.add_link(i, gain, mechanics_.gained_momentum(i), cross(position(i), gain), linear, angular);
      s_.torque_impulse[i - 1] = mechanics_.along_axis(i - 1, angular - cross(joint(i - 1), linear));
    }
  }

  /// Frees the joints whose torques are too large. Returns the lanes in which one was freed.
  [[nodiscard]] Mask free_weak_joints(Mask open) const {
    Mask changed = Lanes<width>::none();
    for (std::size_t j = 0; j < joints_; ++j) {
      const Number most = m_.max_torque[j] * (form_.step_s * (1.0 + 1e-9));
      const Number impulse = s_.torque_impulse[j];
      // At a stop the stop gives what the motor lacks.
      const Mask at_lower = m_.wanted_speed[j] < s_.lowest_speed[j];
      const Mask at_upper = m_.wanted_speed[j] > s_.highest_speed[j];
      const Mask is_weak = ((impulse > most) & ~at_lower) | ((impulse < -most) & ~at_upper);
      const Mask is_new = open & is_weak & (m_.is_free[j] == 0.0);
      put_where(is_new, m_.is_free[j], Lanes<width>::number(1.0));
      changed |= is_new;
    }
    return changed;
  }

  /// The result of lanes that are solved becomes their state.
  void keep(Mask done) const {
    const Number h = Lanes<width>::number(form_.step_s);
    put_where(done, m_.center_speed, 0, mechanics_.kept(motion_.center));
    put_where(done, m_.center, 0, at<Vector>(m_.center, 0) + motion_.center * h);
    mechanics_.turn_first_link(done, motion_.rotation, form_.step_s);
    for (std::size_t j = 0; j < joints_; ++j) {
      put_where(done, m_.joint_angle[j], m_.joint_angle[j] + s_.speed[j] * h);
      put_where(done, m_.is_free[j], Number{});
      const Number most = m_.max_torque[j];
      put_where(done, m_.motor_torque[j],
                mechanics_.kept(bounded(s_.torque_impulse[j] * (1.0 / form_.step_s), -most, most)));
    }
    for (std::size_t i = 0; i < links_; ++i) {
      put_where(done, m_.link_speed, i, mechanics_.kept(at<Vector>(s_.new_link_speed, i)));
      put_where(done, m_.rotation, i, mechanics_.kept(at<Spin>(s_.new_rotation, i)));
      mechanics_.keep_momentum(done, i);
    }
    contacts_.keep(done);
    note_failures(done);
  }

  /// A number that is not finite makes the product of the sum with 0 not 0.
  void note_failures(Mask done) const {
    Number sum = m_.center[0];
    for (std::size_t axis = 1; axis < Kind::axes; ++axis) {
      sum += m_.center[axis];
    }
    sum += m_.orientation[0];
    for (std::size_t j = 0; j < joints_; ++j) {
      sum += m_.joint_angle[j];
    }
    put_where(done & ~(sum * 0.0 == 0.0), m_.failed[0], Lanes<width>::number(not_finite));
  }

  const ChainForm<Kind>& form_;
  const ChainMemory<Kind, Number>& m_;
  const ChainScratch<Kind, Number>& s_;
  std::size_t links_;
  std::size_t joints_;
  Mechanics<Kind, width> mechanics_;
  Contacts<Kind, width> contacts_;
  FreeJoints<Kind, width> free_;
  Inertia inertia_;              ///< inertia of the chain about its centre of mass
  Vector free_speed_;            ///< velocity of the centre without contacts
  Motion<Kind, Number> motion_;  ///< the motion after the step
};

template <typename Kind, int width>
struct Block {
  using Number = typename Lanes<width>::Number;

  Block(const ChainForm<Kind>& form, double* block, double* scratch_numbers)
      : memory(reinterpret_cast<Number*>(block), form.counts),
        scratch(reinterpret_cast<Number*>(scratch_numbers), form.counts),
        step(form, memory, scratch) {}

  ChainMemory<Kind, Number> memory;
  ChainScratch<Kind, Number> scratch;
  ChainStep<Kind, width> step;
};

template <typename Kind, int width>
unsigned step_strong(const ChainForm<Kind>& form, double* block, double* scratch) {
  return Block<Kind, width>(form, block, scratch).step.step_strong();
}
template <typename Kind, int width>
void step_weak(const ChainForm<Kind>& form, double* block, double* scratch) {
  Block<Kind, width>(form, block, scratch).step.step_weak();
}
template <typename Kind, int width>
void place(const ChainForm<Kind>& form, double* block, double* scratch) {
  Block<Kind, width>(form, block, scratch).step.place_links();
}

/// What a kernel with vectors of this width does to a kind of chains.
template <typename Kind, int width>
constexpr KernelSteps<Kind> steps_of{step_strong<Kind, width>, step_weak<Kind, width>, place<Kind, width>};

}  // namespace
}  // namespace proleg::sim::reduced
