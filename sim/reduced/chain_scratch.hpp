#pragma once

#include <cstddef>

#include "sim/reduced/chain_form.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// What a step computes and nothing keeps: arrays of vectors, as in ChainMemory. "From the centre": of mass of the
/// chain. A free joint is one whose speed follows from its torque, because its motor is not strong enough to keep the
/// speed that its servo wants; the others turn as their servos want. "Unknown" number 0 is the rotation of the first
/// link; number i + 1 is the speed of free joint i.
template <typename Number>
struct ChainScratch {
  Number* sine;            ///< by link
  Number* cosine;          ///< by link
  Number* joint_position;  ///< x and z by joint, from the centre, m
  Number* speed;           ///< rad/s, by joint: what it has after the step
  Number* lowest_speed;    ///< rad/s, by joint: so that it stays within its stops
  Number* highest_speed;
  Number* drift;           ///< x and z by link: velocity against the centre while the first link does not turn, m/s
  Number* spin;            ///< rad/s, by link: rotation against the first link
  Number* torque_impulse;  ///< Nms, by joint
  Number* new_link_speed;  ///< as in ChainMemory
  Number* new_rotation;

  // Sums over the links behind a joint, by joint.
  Number* mass_behind;      ///< kg
  Number* moment_behind;    ///< x and z: mass times position from the centre, kg m
  Number* inertia_behind;   ///< about the centre, kg m^2
  Number* momentum_behind;  ///< x and z, kg m/s
  Number* angular_behind;   ///< about the centre, kg m^2/s

  // By contact.
  Number* link;         ///< that touches
  Number* other_link;   ///< -1: the terrain
  Number* arm;          ///< x and z, from the centre
  Number* normal;       ///< x and z, into `link`
  Number* depth_speed;  ///< m/s: at which the points must part
  Number* friction;     ///< Coulomb coefficient
  Number* key;
  Number* old_normal;  ///< Ns: impulses of the step before, 0 for a new contact
  Number* old_friction;
  Number* most_friction;  ///< Ns
  Number* normal_value;   ///< Ns: the impulse so far
  Number* friction_value;
  Number* sliding_speed;  ///< m/s, after the step

  // By row: two for each contact, of its normal and of its friction.
  Number* direction;  ///< x and z of the impulse on the centre; 0 between two links
  Number* bias;       ///< m/s: speed in the direction of the row of what is given
  Number* inverse;    ///< kg: impulse for a change of speed of 1 m/s
  Number* jacobian;   ///< by row, then by unknown: speed in the direction of the row for each
  Number* response;   ///< by row, then by unknown: of the unknowns to an impulse of 1 Ns

  // By unknown.
  Number* unknown;  ///< rad/s
  Number* matrix;   ///< inertia, then its factors
  Number* inverse_matrix;

  // By free joint. A lane has no free joint i if it has at most i of them.
  Number* free_joint;     ///< its number among the joints; -1: none
  Number* free_position;  ///< as joint_position
  Number* free_moment;    ///< as moment_behind, ...
  Number* free_mass;
  Number* free_inertia;
  Number* free_momentum;     ///< kg m^2/s, about the joint: what is given lacks
  Number* free_max_impulse;  ///< Nms
  Number* free_wanted;       ///< rad/s
  Number* free_lowest;
  Number* free_highest;
  Number* motor_impulse;  ///< Nms: of motor and stop
  Number* motor_inverse;  ///< kg m^2: impulse for a change of speed of 1 rad/s

  /// Of the block, in vectors.
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
    const std::size_t unknowns = counts.joints + 1;
    add(sine, counts.links);
    add(cosine, counts.links);
    add(joint_position, 2 * counts.joints);
    add(speed, counts.joints);
    add(lowest_speed, counts.joints);
    add(highest_speed, counts.joints);
    add(drift, 2 * counts.links);
    add(spin, counts.links);
    add(torque_impulse, counts.joints);
    add(new_link_speed, 2 * counts.links);
    add(new_rotation, counts.links);
    add(mass_behind, counts.joints);
    add(moment_behind, 2 * counts.joints);
    add(inertia_behind, counts.joints);
    add(momentum_behind, 2 * counts.joints);
    add(angular_behind, counts.joints);
    add(link, counts.contacts);
    add(other_link, counts.contacts);
    add(depth_speed, counts.contacts);
    add(friction, counts.contacts);
    add(key, counts.contacts);
    add(old_normal, counts.contacts);
    add(old_friction, counts.contacts);
    add(most_friction, counts.contacts);
    add(normal_value, counts.contacts);
    add(friction_value, counts.contacts);
    add(sliding_speed, counts.contacts);
    add(arm, 2 * counts.contacts);
    add(normal, 2 * counts.contacts);
    add(direction, 4 * counts.contacts);
    add(bias, 2 * counts.contacts);
    add(inverse, 2 * counts.contacts);
    add(jacobian, 2 * counts.contacts * unknowns);
    add(response, 2 * counts.contacts * unknowns);
    add(unknown, unknowns);
    add(matrix, unknowns * unknowns);
    add(inverse_matrix, unknowns * unknowns);
    add(free_joint, counts.joints);
    add(free_position, 2 * counts.joints);
    add(free_moment, 2 * counts.joints);
    add(free_mass, counts.joints);
    add(free_inertia, counts.joints);
    add(free_momentum, counts.joints);
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
