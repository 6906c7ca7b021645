#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/ode/contact_friction.hpp"
#include "sim/ode/touch_sensors.hpp"
#include "sim/physics/world.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

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
  void set_surface(dContact& contact, dGeomID a, dGeomID b);
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
