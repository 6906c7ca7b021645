#pragma once

#include <cstddef>

#include "sim/reduced/spatial_form.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

/// As ChainMemory, for a SpatialForm. Three numbers (x, y, z) are a point or a direction in the world.
template <typename Number>
struct SpatialMemory {
  // Constants of each chain.
  Number* mass;          ///< by link
  Number* inertia;       ///< by link: xx, yy, zz, xy, xz, yz, along the axes at angles 0
  Number* inverse_mass;  ///< of the chain, 1/kg
  Number* gravity;       ///< three
  Number* friction;      ///< of a box with the floor
  // What the servos want.
  Number* wanted_speed;  ///< rad/s, by joint
  Number* max_torque;    ///< Nm, by joint
  Number* is_free;       ///< 1 or 0, by joint: in the step that is made, its motor is too weak to keep the wanted speed
  // State.
  Number* center;         ///< three, m, of mass of the chain
  Number* center_speed;   ///< three, m/s
  Number* orientation;    ///< of the first link: w, x, y, z
  Number* joint_angle;    ///< rad
  Number* link_speed;     ///< three by link: of its centre of mass, less that of the chain, m/s
  Number* spin_momentum;  ///< three by link: angular, about its centre of mass, kg m^2/s
  // Results of the last step.
  Number* motor_torque;   ///< Nm, by joint
  Number* link_position;  ///< three by link: of its centre of mass, from that of the chain, m, at the start of the step
  Number* link_turn;      ///< nine by link: its x, y and z axis, at the start of the step
  Number* rotation;       ///< three by link, rad/s
  Number* contact_force;  ///< N, by link
  Number* pressed;        ///< touch sensors by link: bit 0 rear, bit 1 front
  Number* sliding;        ///< on the floor: normal forces, N; forces times speed, N m/s; power of friction, W
  Number* overlap;        ///< 0, or 1 + first box + second box * boxes: two that touch
  Number* failed;         ///< not 0: the solver broke down
  // Contacts of the last step, also part of the state.
  Number* contact_count;
  Number* contact_corner;  ///< number of the corner, by contact, ascending
  Number* impulse;         ///< three by contact, Ns

  /// Of the block, in vectors.
  static std::size_t size(const SpatialCounts& counts) {
    std::size_t used = 0;
    SpatialMemory().lay_out(counts, [&](Number*&, std::size_t count) { used += count; });
    return used;
  }
  /// width: of the vectors if Number is double, else 1.
  SpatialMemory(Number* block, const SpatialCounts& counts, std::size_t width = 1) {
    lay_out(counts, [&](Number*& array, std::size_t count) {
      array = block;
      block += count * width;
    });
  }

 private:
  SpatialMemory() = default;

  template <typename Add>
  void lay_out(const SpatialCounts& counts, Add&& add) {
    add(mass, counts.links);
    add(inertia, 6 * counts.links);
    add(inverse_mass, 1);
    add(gravity, 3);
    add(friction, counts.boxes);
    add(wanted_speed, counts.joints);
    add(max_torque, counts.joints);
    add(is_free, counts.joints);
    add(center, 3);
    add(center_speed, 3);
    add(orientation, 4);
    add(joint_angle, counts.joints);
    add(link_speed, 3 * counts.links);
    add(spin_momentum, 3 * counts.links);
    add(motor_torque, counts.joints);
    add(link_position, 3 * counts.links);
    add(link_turn, 9 * counts.links);
    add(rotation, 3 * counts.links);
    add(contact_force, counts.links);
    add(pressed, counts.links);
    add(sliding, 3);
    add(overlap, 1);
    add(failed, 1);
    add(contact_count, 1);
    add(contact_corner, counts.contacts);
    add(impulse, 3 * counts.contacts);
  }
};

}  // namespace
}  // namespace proleg::sim::reduced
