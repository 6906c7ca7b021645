#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/physics/contact_sliding.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// A point at which a link touches the environment.
struct LinkContact {
  std::size_t link;
  Eigen::Vector3d point;   ///< m, in the world
  Eigen::Vector3d normal;  ///< unit vector in the world, out of the environment
};

/// A robot and its environment in a physics engine. Time passes in equal steps; a world of the same models repeats to
/// the last bit.
class World {
 public:
  World() = default;
  virtual ~World() = default;
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// The speed, in rad/s, that the motor of a joint tries to reach with the torque it has.
  virtual void set_joint_speed(std::size_t joint, double speed) = 0;
  /// Sets the wanted speeds of all joints.
  virtual void set_joint_speeds(std::span<const double> speeds) {
    for (std::size_t joint = 0; joint < speeds.size(); ++joint) {
      set_joint_speed(joint, speeds[joint]);
    }
  }
  /// The torque, in Nm, that the motor of a joint has from now on; at first that of its model. 0: the joint is limp.
  virtual void set_joint_torque(std::size_t joint, double torque) = 0;

  /// Moves the robot as a rigid body, and brings it to rest: the pose of each link becomes motion * pose. As before the
  /// first step no sensor is pressed.
  virtual void move_robot(const Pose& motion) = 0;

  /// Advances the world by one step. Throws PhysicsError if the solver broke down or a position of a link is no longer
  /// a finite number; after that the world can only be read and destroyed.
  virtual void step() = 0;

  /// Angle of a joint in rad, as RobotModel defines it.
  [[nodiscard]] virtual double joint_angle(std::size_t joint) const = 0;
  /// The torque, in Nm, that the motor of a joint gave in the last step, about the joint's axis: what it adds to the
  /// energy per radian that the joint turns. At a stop of the joint it is the sum of stop and motor, limited to what
  /// the motor has. 0 before the first step.
  [[nodiscard]] virtual double motor_torque(std::size_t joint) const = 0;
  /// Reads the angles and the torques of all joints.
  virtual void read_joints(std::span<double> angles, std::span<double> torques) const {
    for (std::size_t joint = 0; joint < angles.size(); ++joint) {
      angles[joint] = joint_angle(joint);
      torques[joint] = motor_torque(joint);
    }
  }
  /// Pose of the frame of a link in the world.
  [[nodiscard]] virtual Pose link_pose(std::size_t link) const = 0;
  /// Poses of the frames of all links in the world.
  virtual void read_links(std::span<Pose> poses) const {
    for (std::size_t link = 0; link < poses.size(); ++link) {
      poses[link] = link_pose(link);
    }
  }
  /// Poses of the frames of the objects that move (EnvironmentModel::moving_objects), in the world.
  virtual void read_objects(std::span<Pose> /*poses*/) const {}
  /// Whether no link, and no object that moves, is faster than the two given speeds: of its centre of mass in m/s, of
  /// its rotation in rad/s.
  [[nodiscard]] virtual bool is_slower_than(double speed, double rotation) const = 0;
  /// Centre of mass of the robot in the world.
  [[nodiscard]] virtual Eigen::Vector3d center_of_mass() const = 0;
  /// Which of the two touch sensors under a link the environment presses: bit 0 the one towards the tail, bit 1 the one
  /// towards the head. Each senses its half of the underside. A contact presses a sensor if it lies below the link's
  /// centre of mass and does not push from the side by more than 45 degrees. The underside faces down (-z) in the
  /// robot's file at angles 0, or towards -y if the link is upright in the file; it turns with the link. The contacts
  /// are those at the start of the last step; before the first step no sensor is pressed.
  [[nodiscard]] virtual std::uint8_t link_contacts(std::size_t link) const = 0;
  /// Sum of the normal forces, in N, of the link's contact points with the environment, with objects that move and with
  /// other links, in the last step; 0 before the first.
  [[nodiscard]] virtual double contact_force(std::size_t link) const = 0;
  /// Adds those of all links.
  virtual void add_contact_forces(std::span<double> sums) const {
    for (std::size_t link = 0; link < sums.size(); ++link) {
      sums[link] += contact_force(link);
    }
  }
  /// Number of contact points at the start of the last step.
  [[nodiscard]] virtual std::size_t contact_count() const = 0;
  /// How contact points slid in the last step; zeros before the first step.
  [[nodiscard]] virtual ContactSliding contact_sliding() const = 0;
  /// The contact points of links with the environment at the start of the last step; none before the first, and none
  /// unless keep_contact_points() was called before that step. The reduced engine has none.
  virtual void keep_contact_points() {}
  [[nodiscard]] virtual std::span<const LinkContact> contact_points() const { return {}; }
  /// Distance, in m, from a point along a unit vector to the nearest surface of the environment or of a link other than
  /// `link`; nothing if it is farther than `range`. The reduced engine never finds one.
  [[nodiscard]] virtual std::optional<double> distance_along(const Eigen::Vector3d& /*from*/,
                                                             const Eigen::Vector3d& /*direction*/, double /*range*/,
                                                             std::size_t /*link*/) const {
    return std::nullopt;
  }
  /// J, of the robot and the objects that move: kinetic energy, and potential energy against the origin of the world.
  [[nodiscard]] virtual double energy() const = 0;
  /// Height of the lowest point of the environment; nothing if there is no environment.
  [[nodiscard]] virtual std::optional<double> lowest_ground() const = 0;
  /// Number of messages from the solver since the world was made, such as "LCP internal error".
  [[nodiscard]] virtual std::size_t solver_messages() const = 0;
  /// The first of these messages that differ, at most ten.
  [[nodiscard]] virtual std::span<const std::string> solver_message_texts() const = 0;
  /// The numbers on which the next poses depend, if the engine gives the same ones on every computer; otherwise
  /// nothing.
  [[nodiscard]] virtual std::vector<double> state() const { return {}; }
};

}  // namespace proleg::sim
