#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/environment/environment_model.hpp"
#include "sim/physics/contact_sliding.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// How contact and joint forces are solved.
enum class Stepper : std::uint8_t {
  direct,     ///< dWorldStep: exact, repeatable on every thread; the faster one up to about 8 links
  iterative,  ///< dWorldQuickStep, 20 iterations: the faster one above. Draws from one random generator for the whole
              ///< process, so each run that must be repeatable needs its own process.
};

/// A robot and its environment in the Open Dynamics Engine. Time passes in equal steps; a world of the same models
/// repeats to the last bit.
class World {
 public:
  /// step_s: length of a step, above 0. The models must be valid (sim/scenario checks them).
  World(const RobotModel& robot, const EnvironmentModel& environment, double step_s, Stepper stepper);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// The speed, in rad/s, that the motor of a joint tries to reach with the torque it has.
  void set_joint_speed(std::size_t joint, double speed);
  /// The torque, in Nm, that the motor of a joint has from now on; at first that of its model. 0: the joint is limp.
  void set_joint_torque(std::size_t joint, double torque);

  /// Moves the robot as a rigid body, and brings it to rest: the pose of each link becomes motion * pose. As before the
  /// first step no sensor is pressed.
  void move_robot(const Pose& motion);

  /// Advances the world by one step. Throws PhysicsError if the solver broke down or a position of a link is no longer
  /// a finite number; after that the world can only be read and destroyed.
  void step();

  /// Angle of a joint in rad, as RobotModel defines it.
  [[nodiscard]] double joint_angle(std::size_t joint) const;
  /// The torque, in Nm, that the motor of a joint gave in the last step, about the joint's axis: what it adds to the
  /// energy per radian that the joint turns. At a stop of the joint it is the sum of stop and motor, limited to what
  /// the motor has. 0 before the first step.
  [[nodiscard]] double motor_torque(std::size_t joint) const;
  /// Pose of the frame of a link in the world.
  [[nodiscard]] Pose link_pose(std::size_t link) const;
  /// Whether no link is faster than the two given speeds: of its centre of mass in m/s, of its rotation in rad/s.
  [[nodiscard]] bool is_slower_than(double speed, double rotation) const;
  /// Centre of mass of the robot in the world.
  [[nodiscard]] Eigen::Vector3d center_of_mass() const;
  /// Which of the two touch sensors under a link the environment presses: bit 0 the one towards the tail, bit 1 the one
  /// towards the head. Each senses its half of the underside. A contact presses a sensor if it lies below the link's
  /// centre of mass and does not push from the side by more than 45 degrees. The underside faces down (-z) in the
  /// robot's file at angles 0, or towards -y if the link is upright in the file; it turns with the link. The contacts
  /// are those at the start of the last step; before the first step no sensor is pressed.
  [[nodiscard]] std::uint8_t link_contacts(std::size_t link) const;
  /// Sum of the normal forces, in N, of the link's contact points with the environment and with other links, in the
  /// last step; 0 before the first.
  [[nodiscard]] double contact_force(std::size_t link) const;
  /// Number of contact points at the start of the last step.
  [[nodiscard]] std::size_t contact_count() const;
  /// In the last step; zeros before the first.
  [[nodiscard]] ContactSliding contact_sliding() const;
  /// Height of the lowest point of the environment; nothing if there is no environment.
  [[nodiscard]] std::optional<double> lowest_ground() const;
  /// Number of messages from the solver since the world was made, such as "LCP internal error".
  [[nodiscard]] std::size_t solver_messages() const;
  /// The first of the messages on this thread that differ.
  [[nodiscard]] static std::span<const std::string> solver_message_texts();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::sim
