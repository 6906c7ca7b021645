#pragma once

#include <cstddef>

#include "sim/reduced/chain_form.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// The numbers of the chains that one vector steps together: arrays of vectors in one block of memory. Code for vectors
/// of any width sees the same block: number i of an array, of lane k, is the double at i * width + k.
template <typename Number>
struct ChainMemory {
  // Constants of each chain.
  Number* mass;              ///< by link
  Number* inertia;           ///< by link
  Number* inverse_mass;      ///< of the chain, 1/kg
  Number* gravity;           ///< x and z
  Number* terrain_friction;  ///< by shape, then by solid
  Number* self_friction;     ///< by shape, then by shape
  // What the servos want.
  Number* wanted_speed;  ///< rad/s, by joint
  Number* max_torque;    ///< Nm, by joint
  Number* is_free;       ///< 1 or 0, by joint: in the step that is made, its motor is too weak to keep the wanted speed
  // State.
  Number* center;        ///< x and z, m, of mass of the chain
  Number* center_speed;  ///< x and z, m/s
  Number* angle;         ///< rad, of the first link
  Number* joint_angle;   ///< rad
  Number* link_speed;    ///< x and z by link: of its centre of mass, less that of the chain, m/s
  Number* rotation;      ///< rad/s, by link
  // Results of the last step.
  Number* motor_torque;  ///< Nm, by joint
  Number*
      link_position;  ///< x and z by link: of its centre of mass, from that of the chain, m, at the start of the step
  Number* contact_force;  ///< N, by link
  Number* pressed;        ///< touch sensors by link: bit 0 rear, bit 1 front
  Number* sliding;        ///< with the terrain: normal forces, N; forces times speed, N m/s; power of friction, W
  Number* failed;         ///< 0, or why the chain is lost: not_finite, too_many_contacts
  // Contacts of the last step, also part of the state.
  Number* contact_count;
  Number* contact_key;     ///< which corners touched, by contact, in the order of pairs of outlines
  Number* normal_impulse;  ///< Ns, by contact
  Number* friction_impulse;

  /// Of the block, in vectors.
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

  template <typename Add>
  void lay_out(const ChainCounts& counts, Add&& add) {
    add(mass, counts.links);
    add(inertia, counts.links);
    add(inverse_mass, 1);
    add(gravity, 2);
    add(terrain_friction, counts.shapes * counts.solids);
    add(self_friction, counts.shapes * counts.shapes);
    add(wanted_speed, counts.joints);
    add(max_torque, counts.joints);
    add(is_free, counts.joints);
    add(center, 2);
    add(center_speed, 2);
    add(angle, 1);
    add(joint_angle, counts.joints);
    add(link_speed, 2 * counts.links);
    add(rotation, counts.links);
    add(motor_torque, counts.joints);
    add(link_position, 2 * counts.links);
    add(contact_force, counts.links);
    add(pressed, counts.links);
    add(sliding, 3);
    add(failed, 1);
    add(contact_count, 1);
    add(contact_key, counts.contacts);
    add(normal_impulse, counts.contacts);
    add(friction_impulse, counts.contacts);
  }
};

}  // namespace
}  // namespace proleg::sim::reduced
