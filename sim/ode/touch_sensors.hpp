#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/robot/robot_model.hpp"
#include "sim/robot/touch_sensor_frame.hpp"

namespace proleg::sim {

/// The two touch sensors under each link, as World::link_contacts() describes them.
class TouchSensors {
 public:
  void add_link(const RobotModel& robot, std::size_t link) {
    frames_.push_back(touch_sensor_frame(robot, link));
    pressed_.push_back(0);
  }

  /// Must be called before each step: releases all sensors.
  void release_all() { pressed_.assign(frames_.size(), 0); }
  /// Notes that the environment touches a link. body: the body of the link.
  void press(std::size_t link, dBodyID body, const dContactGeom& contact);
  /// Sensors that are pressed: bit 0 rear, bit 1 front.
  [[nodiscard]] std::uint8_t pressed(std::size_t link) const { return pressed_[link]; }

 private:
  std::vector<TouchSensorFrame> frames_;  ///< by link
  std::vector<std::uint8_t> pressed_;
};

// This function runs for each contact of each step, so it uses the data of the engine: the middle of the link is its
// centre of mass, which is the origin of the engine's body.
inline void TouchSensors::press(std::size_t link, dBodyID body, const dContactGeom& contact) {
  const dReal* rotation = dBodyGetRotation(body);  // 3 rows of 4
  const dReal* middle = dBodyGetPosition(body);
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   // contact point from the middle, in the frame of the link
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // its sign depends on the order of the two bodies
  for (int row = 0; row < 3; ++row) {
    const Eigen::Vector3d row_of_rotation(rotation[4 * row], rotation[4 * row + 1], rotation[4 * row + 2]);
    point += row_of_rotation * (contact.pos[row] - middle[row]);
    normal += row_of_rotation * contact.normal[row];
  }
  pressed_[link] = static_cast<std::uint8_t>(pressed_[link] | frames_[link].pressed_by(point, normal));
}

}  // namespace proleg::sim
