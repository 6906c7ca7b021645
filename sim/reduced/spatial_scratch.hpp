#pragma once

#include <cstddef>

#include "sim/reduced/spatial_form.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// As ChainScratch, for a SpatialForm. "From the centre": of mass of the chain. A free joint is one whose speed follows
/// from its torque. "Unknowns" 0 to 2 are the rotation of the first link; number i + 3 is the speed of free joint i.
template <typename Number>
struct SpatialScratch {
  Number* joint_position;  ///< three by joint, from the centre, m
  Number* axis;            ///< three by joint
  Number* turned_inertia;  ///< six by link, about its centre of mass
  Number* speed;           ///< rad/s, by joint: what it has after the step
  Number* lowest_speed;    ///< rad/s, by joint: so that it stays within its stops
  Number* highest_speed;
  Number* drift;           ///< three by link: velocity against the centre while the first link does not turn, m/s
  Number* spin;            ///< three by link, rad/s: rotation against the first link
  Number* torque_impulse;  ///< Nms, by joint
  Number* new_link_speed;  ///< as in SpatialMemory
  Number* new_momentum;
  Number* contact_impulse;  ///< three by link, Ns: of all its contacts
  Number* contact_moment;   ///< three by link, Nms, about the centre

  // Sums over the links behind a joint, by joint.
  Number* mass_behind;      ///< kg
  Number* moment_behind;    ///< three: mass times position from the centre, kg m
  Number* inertia_behind;   ///< six, about the centre, kg m^2
  Number* momentum_behind;  ///< three, kg m/s
  Number* angular_behind;   ///< three, about the centre, kg m^2/s

  // By contact.
  Number* link;         ///< that touches
  Number* corner;       ///< as in SpatialMemory
  Number* arm;          ///< three, from the centre
  Number* lever;        ///< three, from the middle of the link
  Number* given;        ///< three, m/s: velocity against the centre while the first link does not turn
  Number* link_spin;    ///< three, rad/s: spin of the link
  Number* depth_speed;  ///< m/s: at which the contact must part
  Number* friction;     ///< Coulomb coefficient
  Number* old_impulse;  ///< three, Ns: of the step before, 0 for a new contact
  Number* value;        ///< three, Ns: the impulse so far
  Number* most_friction;
  Number* normal_inverse;  ///< kg: impulse for a change of speed of 1 m/s
  Number* friction_inverse;
  Number* jacobian;  ///< by contact and direction (x, y, z), then by free joint: speed for each
  Number* response;  ///< by contact and direction, then by unknown: to an impulse of 1 Ns

  // By unknown.
  Number* unknown;  ///< rad/s
  Number* matrix;   ///< inertia, then its factors
  Number* inverse_matrix;

  // By free joint: any that is free in a lane. In the other lanes it gets no impulse.
  Number* free_axis;         ///< three; 0 where it is not free
  Number* free_mean;         ///< three: velocity of the centre of mass when it turns and the first link does not move
  Number* free_max_impulse;  ///< Nms
  Number* motor_impulse;     ///< Nms: of motor and stop
  Number* motor_inverse;     ///< kg m^2: impulse for a change of speed of 1 rad/s

  /// Of the block, in vectors.
  static std::size_t size(const SpatialCounts& counts) {
    std::size_t used = 0;
    SpatialScratch().lay_out(counts, [&](Number*&, std::size_t count) { used += count; });
    return used;
  }
  SpatialScratch(Number* block, const SpatialCounts& counts) {
    lay_out(counts, [&](Number*& array, std::size_t count) {
      array = block;
      block += count;
    });
  }

 private:
  SpatialScratch() = default;

  template <typename Add>
  void lay_out(const SpatialCounts& counts, Add&& add) {
    const std::size_t unknowns = counts.joints + 3;
    const std::size_t contacts = counts.contacts;
    add(joint_position, 3 * counts.joints);
    add(axis, 3 * counts.joints);
    add(turned_inertia, 6 * counts.links);
    add(speed, counts.joints);
    add(lowest_speed, counts.joints);
    add(highest_speed, counts.joints);
    add(drift, 3 * counts.links);
    add(spin, 3 * counts.links);
    add(torque_impulse, counts.joints);
    add(new_link_speed, 3 * counts.links);
    add(new_momentum, 3 * counts.links);
    add(contact_impulse, 3 * counts.links);
    add(contact_moment, 3 * counts.links);
    add(mass_behind, counts.joints);
    add(moment_behind, 3 * counts.joints);
    add(inertia_behind, 6 * counts.joints);
    add(momentum_behind, 3 * counts.joints);
    add(angular_behind, 3 * counts.joints);
    add(link, contacts);
    add(corner, contacts);
    add(arm, 3 * contacts);
    add(lever, 3 * contacts);
    add(given, 3 * contacts);
    add(link_spin, 3 * contacts);
    add(depth_speed, contacts);
    add(friction, contacts);
    add(old_impulse, 3 * contacts);
    add(value, 3 * contacts);
    add(most_friction, contacts);
    add(normal_inverse, contacts);
    add(friction_inverse, contacts);
    add(jacobian, 3 * contacts * counts.joints);
    add(response, 3 * contacts * unknowns);
    add(unknown, unknowns);
    add(matrix, unknowns * unknowns);
    add(inverse_matrix, unknowns * unknowns);
    add(free_axis, 3 * counts.joints);
    add(free_mean, 3 * counts.joints);
    add(free_max_impulse, counts.joints);
    add(motor_impulse, counts.joints);
    add(motor_inverse, counts.joints);
  }
};

}  // namespace
}  // namespace proleg::sim::reduced
