#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/ode/contact_friction.hpp"
#include "sim/physics/world.hpp"
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

/// Most points that the engine may report for two shapes of which one is a mesh. It reports a corner that several
/// triangles share once for each of them, and a flat side has points all over it.
inline constexpr std::size_t max_mesh_points = 192;

/// Keeps points that hold a body as all of them would: the deepest, then repeatedly the one farthest from the kept
/// ones. Of points at the same place only the deepest counts. Moves the kept points to the front and returns their
/// number, at most `most`.
[[nodiscard]] std::size_t choose_contacts(std::span<dContactGeom> points, std::size_t most);

/// Finds the contacts of a step, gives the engine a joint for each, and keeps the data for sensors and measures.
class Contacts {
 public:
  /// world: has the joints; must outlive this object. unspecified_friction: coefficient of bodies without one.
  Contacts(dWorldID world, double unspecified_friction)
      : group_(dJointGroupCreate(0)), world_(world), unspecified_friction_(unspecified_friction) {}

  /// Must be called before the first step, in the order of the links. body: the body of the link.
  void add_link(const RobotModel& robot, std::size_t link, dBodyID body);
  /// Lets points() have the points of each step from the next one on.
  void keep_points() { keeps_points_ = true; }

  /// Must be called before the calls of find() of a step.
  void begin_step();
  /// Find the contacts of the shapes of one space with each other, or of two spaces. Shapes must have their ShapeData.
  void find(dSpaceID space);
  void find(dSpaceID a, dSpaceID b);
  /// Must be called after the step; destroys the joints.
  void end_step();
  /// Destroys the joints in the middle of a step that failed. The contacts found so far stay.
  void abandon() { group_.reset(); }
  /// Removes all contacts, because the robot was moved.
  void clear();

  [[nodiscard]] std::uint8_t pressed(std::size_t link) const { return touch_sensors_.pressed(link); }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double force(std::size_t link) const { return forces_[link]; }  ///< N
  [[nodiscard]] const ContactSliding& sliding() const { return friction_.sliding(); }
  [[nodiscard]] std::span<const LinkContact> points() const { return points_; }

 private:
  struct DestroyJointGroup {
    void operator()(dxJointGroup* group) const { dJointGroupDestroy(group); }
  };

  static void on_near(void* self, dGeomID a, dGeomID b) { static_cast<Contacts*>(self)->collide(a, b); }
  void collide(dGeomID a, dGeomID b);
  void add(dGeomID a, dGeomID b, std::span<const dContactGeom> points);
  void set_surface_with_axis(dContact& contact, double along, dGeomID a, dGeomID b);
  void note_touch(int link, int other, const dContactGeom& contact);
  void note_point(std::size_t link, const dContactGeom& contact);
  void sum_forces();

  std::unique_ptr<dxJointGroup, DestroyJointGroup> group_;
  dWorldID world_;
  double unspecified_friction_;
  std::vector<dBodyID> bodies_;  ///< by link
  TouchSensors touch_sensors_;
  ContactFriction friction_;
  std::vector<double> forces_;  ///< N, by link
  bool keeps_points_ = false;
  std::vector<LinkContact> points_;
  std::size_t count_ = 0;
};

}  // namespace proleg::sim
