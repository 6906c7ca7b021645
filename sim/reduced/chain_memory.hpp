#pragma once

#include <cstddef>

#include "sim/reduced/kernel.hpp"

namespace proleg::sim::reduced {
namespace {  // each instruction set has its own: see chain_step.hpp

// Arrays of vectors in one block of memory. "A vector" of an array is Kind::axes numbers, "a spin" Kind::spin_axes, "an
// inertia" Kind::inertia_numbers. "From the centre" means from the centre of mass of the chain.

/// The results that only chains of this kind have.
template <typename Kind, typename Number>
struct OwnMemory;
template <typename Number>
struct OwnMemory<Planar, Number> {
  template <typename Add>
  void lay_out(const ChainCounts& /*counts*/, Add&& /*add*/) {}
};
template <typename Number>
struct OwnMemory<Spatial, Number> {
  Number* spin_momentum;  ///< a spin by link: angular momentum about its centre of mass, kg m^2/s; part of the state
  Number* link_turn;      ///< nine by link: its x, y and z axis, at the start of the step
  Number* overlap;        ///< 0, or 1 + first box + second box * boxes: two that touch

  template <typename Add>
  void lay_out(const ChainCounts& counts, Add&& add) {
    add(spin_momentum, 3 * counts.links);
    add(link_turn, 9 * counts.links);
    add(overlap, 1);
  }
};

/// The numbers of the chains that one vector steps together. Code for vectors of any width sees the same block: number
/// i of an array, of lane k, is the double at i * width + k.
template <typename Kind, typename Number>
struct ChainMemory : OwnMemory<Kind, Number> {
  // Constants of each chain.
  Number* mass;          ///< kg, by link
  Number* inertia;       ///< an inertia by link, about its centre of mass, kg m^2
  Number* inverse_mass;  ///< 1 / mass of the chain, 1/kg
  Number* gravity;       ///< a vector, m/s^2
  Number* friction;      ///< Coulomb coefficients, by pair (ChainModel::friction)
  // The speeds that the servos command.
  Number* wanted_speed;  ///< rad/s, by joint
  Number* max_torque;    ///< Nm, by joint
  Number* is_free;       ///< 1 or 0, by joint: in the step that is made, its motor is too weak to keep the wanted speed
  // State.
  Number* center;        ///< a vector: centre of mass of the chain, m
  Number* center_speed;  ///< a vector: velocity of `center`, m/s
  Number* orientation;   ///< Kind::orientation_numbers
  Number* joint_angle;   ///< rad
  Number* link_speed;    ///< a vector by link: velocity of its centre of mass, less that of the chain, m/s
  Number* rotation;      ///< a spin by link, rad/s; in space it is a result of the last step
  // Results of the last step.
  Number* motor_torque;   ///< Nm, by joint
  Number* link_position;  ///< a vector by link: its centre of mass, from the centre, m, at the start of the step
  Number* contact_force;  ///< N, by link
  Number* pressed;        ///< touch sensors by link: bit 0 rear, bit 1 front
  Number* sliding;        ///< on the terrain: normal forces, N; forces times speed, N m/s; power of friction, W
  Number* failed;         ///< 0, or why the chain is lost: not_finite, too_many_contacts
  // Contacts of the last step, also part of the state.
  Number* contact_count;  ///< how many contacts the chain has
  Number* contact_key;    ///< which corner touched what, by contact; those of a pair, or of a box, are neighbours
  Number* impulse;        ///< a vector by contact: friction, and last the normal impulse, Ns

  /// Size of the block, in vectors.
  static std::size_t size(const ChainCounts& counts) {
    std::size_t used = 0;
    ChainMemory().lay_out(counts, [&](Number*&, std::size_t count) { used += count; });
    return used;
  }
  /// width: of the vectors if Number is double, else 1.
  ChainMemory(Number* block, const ChainCounts& counts, std::size_t width = 1) {
    lay_out(counts, [&](Number*& array, std::size_t count) {
      array = block;
      block += count * width;
    });
  }

 private:
  ChainMemory() = default;

  /// A batch copies a whole chain from `mass` on, what a step changes from `is_free` on, and of the contacts at the end
  /// those that there are.
  template <typename Add>
  void lay_out(const ChainCounts& counts, Add&& add) {
    add(mass, counts.links);
    add(inertia, Kind::inertia_numbers * counts.links);
    add(inverse_mass, 1);
    add(gravity, Kind::axes);
    add(friction, counts.pairs);
    add(wanted_speed, counts.joints);
    add(max_torque, counts.joints);
    add(is_free, counts.joints);
    add(center, Kind::axes);
    add(center_speed, Kind::axes);
    add(orientation, Kind::orientation_numbers);
    add(joint_angle, counts.joints);
    add(link_speed, Kind::axes * counts.links);
    add(rotation, Kind::spin_axes * counts.links);
    OwnMemory<Kind, Number>::lay_out(counts, add);
    add(motor_torque, counts.joints);
    add(link_position, Kind::axes * counts.links);
    add(contact_force, counts.links);
    add(pressed, counts.links);
    add(sliding, 3);
    add(failed, 1);
    add(contact_count, 1);
    add(contact_key, counts.contacts);
    add(impulse, Kind::axes * counts.contacts);
  }
};

/// The scratch arrays that only steps of this kind have.
template <typename Kind, typename Number>
struct OwnScratch;
template <typename Number>
struct OwnScratch<Planar, Number> {
  Number* sine;    ///< sine of the angle of each link
  Number* cosine;  ///< cosine of the angle of each link
  // Arrays by contact.
  Number* other_link;  ///< the link that `link` touches; -1: the terrain
  Number* normal;      ///< a vector: the direction into `link`
  Number* direction;   ///< two vectors: directions in which friction and normal push the centre; 0 between two links
  // Arrays by free joint. Each lane numbers its own in the order of the chain. It has no number i if it has at most i
  // of them.
  Number* free_joint;     ///< its number among the joints; -1: none
  Number* free_position;  ///< joint_position of this joint; so are the next ones
  Number* free_moment;    ///< moment_behind
  Number* free_mass;      ///< mass_behind
  Number* free_inertia;   ///< inertia_behind
  Number* free_lever;     ///< a vector: mass times distance from the joint, of the links behind, kg m
  Number* free_mean;      ///< a vector: velocity of the centre of mass when it turns at 1 rad/s, m
  Number* free_momentum;  ///< kg m^2/s, about the joint: what is given lacks

  template <typename Add>
  void lay_out(const ChainCounts& counts, Add&& add) {
    add(sine, counts.links);
    add(cosine, counts.links);
    add(other_link, counts.contacts);
    add(normal, 2 * counts.contacts);
    add(direction, 4 * counts.contacts);
    add(free_joint, counts.joints);
    add(free_position, 2 * counts.joints);
    add(free_moment, 2 * counts.joints);
    add(free_mass, counts.joints);
    add(free_inertia, counts.joints);
    add(free_lever, 2 * counts.joints);
    add(free_mean, 2 * counts.joints);
    add(free_momentum, counts.joints);
  }
};
template <typename Number>
struct OwnScratch<Spatial, Number> {
  Number* axis;             ///< a vector by joint: unit vector
  Number* turned_inertia;   ///< an inertia by link, about its centre of mass, as the link is turned
  Number* new_momentum;     ///< a spin by link: spin_momentum after the step
  Number* contact_impulse;  ///< a vector by link, Ns: sum over its contacts
  Number* contact_moment;   ///< a spin by link, Nms: sum of the moments about the centre
  // Arrays by contact.
  Number* lever;      ///< a vector: the contact from the centre of mass of its link, m
  Number* link_spin;  ///< a spin: ChainScratch::spin of the link, rad/s
  // Arrays by free joint. One that is free in any lane has a number. In the other lanes it gets no impulse.
  Number* free_axis;  ///< a vector; 0 where it is not free
  Number* free_mean;  ///< a vector: velocity of the centre of mass when it turns and the first link does not move

  template <typename Add>
  void lay_out(const ChainCounts& counts, Add&& add) {
    add(axis, 3 * counts.joints);
    add(turned_inertia, 6 * counts.links);
    add(new_momentum, 3 * counts.links);
    add(contact_impulse, 3 * counts.links);
    add(contact_moment, 3 * counts.links);
    add(lever, 3 * counts.contacts);
    add(link_spin, 3 * counts.contacts);
    add(free_axis, 3 * counts.joints);
    add(free_mean, 3 * counts.joints);
  }
};

/// What a step computes and nothing keeps. A free joint is one whose speed follows from its torque, because its motor
/// is not strong enough to keep the speed that its servo commands; the others turn as commanded. The first
/// Kind::spin_axes "unknowns" are the rotation of the first link; then come the speeds of the free joints.
template <typename Kind, typename Number>
struct ChainScratch : OwnScratch<Kind, Number> {
  Number* joint_position;  ///< a vector by joint, from the centre, m
  Number* speed;           ///< rad/s, by joint: what it has after the step
  Number* lowest_speed;    ///< rad/s, by joint: so that it stays within its stops
  Number* highest_speed;   ///< rad/s
  Number* drift;           ///< a vector by link: velocity against the centre while the first link does not turn, m/s
  Number* spin;            ///< a spin by link, rad/s: rotation against the first link
  Number* torque_impulse;  ///< Nms, by joint
  Number* new_link_speed;  ///< ChainMemory::link_speed after the step
  Number* new_rotation;    ///< ChainMemory::rotation after the step

  // Sums over the links behind a joint, by joint.
  Number* mass_behind;      ///< kg
  Number* moment_behind;    ///< a vector: mass times position from the centre, kg m
  Number* inertia_behind;   ///< an inertia about the centre, kg m^2
  Number* momentum_behind;  ///< a vector, kg m/s
  Number* angular_behind;   ///< a spin: angular momentum about the centre, kg m^2/s

  // Arrays by contact. Vectors have friction first and the normal direction last: in a plane along the surface and out
  // of it, in space along x, y and z.
  Number* link;              ///< the link that touches
  Number* key;               ///< ChainMemory::contact_key
  Number* arm;               ///< a vector: the contact from the centre, m
  Number* depth_speed;       ///< m/s: at which the points must part
  Number* friction;          ///< Coulomb coefficient
  Number* old_impulse;       ///< a vector: impulses of the step before, Ns; 0 for a new contact
  Number* value;             ///< a vector: the impulses so far, Ns
  Number* most_friction;     ///< Ns
  Number* normal_inverse;    ///< kg: impulse for a change of speed of 1 m/s
  Number* friction_inverse;  ///< kg
  Number* given;             ///< a vector: speeds that do not depend on the unknowns, m/s; at the end sliding speeds
  // Arrays by row: each direction of each contact has one.
  Number* jacobian;  ///< by row, then by unknown: the speed in the direction of the row that each gives
  Number* response;  ///< by row, then by unknown: what an impulse of 1 Ns in the row changes

  // Arrays by unknown.
  Number* unknown;  ///< rad/s
  Number* matrix;   ///< inertia, then its factors
  Number* inverse_matrix;

  // Arrays by free joint.
  Number* free_max_impulse;  ///< Nms: the most that the motor gives
  Number* free_wanted;       ///< rad/s
  Number* free_lowest;       ///< rad/s
  Number* free_highest;      ///< rad/s
  Number* motor_impulse;     ///< Nms: what motor and stop give together
  Number* motor_inverse;     ///< kg m^2: impulse for a change of speed of 1 rad/s

  /// Size of the block, in vectors.
  static std::size_t size(const ChainCounts& counts) {
    std::size_t used = 0;
    ChainScratch().lay_out(counts, [&](Number*&, std::size_t count) { used += count; });
    return used;
  }
  ChainScratch(Number* block, const ChainCounts& counts) {
    lay_out(counts, [&](Number*& array, std::size_t count) {
      array = block;
      block += count;
    });
  }

 private:
  ChainScratch() = default;

  template <typename Add>
  void lay_out(const ChainCounts& counts, Add&& add) {
    const std::size_t unknowns = counts.joints + Kind::spin_axes;
    OwnScratch<Kind, Number>::lay_out(counts, add);
    add(joint_position, Kind::axes * counts.joints);
    add(speed, counts.joints);
    add(lowest_speed, counts.joints);
    add(highest_speed, counts.joints);
    add(drift, Kind::axes * counts.links);
    add(spin, Kind::spin_axes * counts.links);
    add(torque_impulse, counts.joints);
    add(new_link_speed, Kind::axes * counts.links);
    add(new_rotation, Kind::spin_axes * counts.links);
    add(mass_behind, counts.joints);
    add(moment_behind, Kind::axes * counts.joints);
    add(inertia_behind, Kind::inertia_numbers * counts.joints);
    add(momentum_behind, Kind::axes * counts.joints);
    add(angular_behind, Kind::spin_axes * counts.joints);
    add(link, counts.contacts);
    add(key, counts.contacts);
    add(arm, Kind::axes * counts.contacts);
    add(depth_speed, counts.contacts);
    add(friction, counts.contacts);
    add(old_impulse, Kind::axes * counts.contacts);
    add(value, Kind::axes * counts.contacts);
    add(most_friction, counts.contacts);
    add(normal_inverse, counts.contacts);
    add(friction_inverse, counts.contacts);
    add(given, Kind::axes * counts.contacts);
    add(jacobian, Kind::axes * counts.contacts * unknowns);
    add(response, Kind::axes * counts.contacts * unknowns);
    add(unknown, unknowns);
    add(matrix, unknowns * unknowns);
    add(inverse_matrix, unknowns * unknowns);
    add(free_max_impulse, counts.joints);
    add(free_wanted, counts.joints);
    add(free_lowest, counts.joints);
    add(free_highest, counts.joints);
    add(motor_impulse, counts.joints);
    add(motor_inverse, counts.joints);
  }
};

}  // namespace
}  // namespace proleg::sim::reduced
