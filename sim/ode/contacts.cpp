#include "sim/ode/contacts.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <utility>

#include "sim/ode/shapes.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {
namespace {

double squared_distance(const dContactGeom& a, const dContactGeom& b) {
  const double x = a.pos[0] - b.pos[0];
  const double y = a.pos[1] - b.pos[1];
  const double z = a.pos[2] - b.pos[2];
  return x * x + y * y + z * z;
}

/// Removes points at the place of a deeper one, and returns the number of those left.
std::size_t merge(std::span<dContactGeom> points) {
  constexpr double same_place = 1e-10;  // m^2
  std::size_t count = 0;
  for (const dContactGeom& point : points) {
    const auto kept = points.first(count);
    const auto same = std::ranges::find_if(
        kept, [&](const dContactGeom& other) { return squared_distance(point, other) < same_place; });
    if (same == kept.end()) {
      points[count++] = point;
    } else if (point.depth > same->depth) {
      *same = point;
    }
  }
  return count;
}

/// Finds contact points. `points` need no values before: the engine fills them.
std::size_t contact_points(dGeomID a, dGeomID b, std::span<dContactGeom> points) {
  return static_cast<std::size_t>(dCollide(a, b, static_cast<int>(points.size()), points.data(), sizeof(dContactGeom)));
}

ContactFriction::Between between(const ShapeData& a, const ShapeData& b) {
  if (a.link >= 0 && b.link >= 0) {
    return ContactFriction::Between::links;
  }
  return a.link >= 0 || b.link >= 0 ? ContactFriction::Between::robot_and_world : ContactFriction::Between::objects;
}

}  // namespace

std::size_t choose_contacts(std::span<dContactGeom> points, std::size_t most) {
  points = points.first(merge(points));
  if (points.size() <= most) {
    return points.size();
  }
  std::array<double, max_mesh_points> distances{};  // distance from the nearest point that is kept
  distances.fill(std::numeric_limits<double>::max());
  auto next = static_cast<std::size_t>(std::ranges::max_element(points, {}, &dContactGeom::depth) - points.begin());
  for (std::size_t kept = 0; kept < most; ++kept) {
    std::swap(points[kept], points[next]);
    std::swap(distances[kept], distances[next]);
    next = kept + 1;
    for (std::size_t i = kept + 1; i < points.size(); ++i) {
      distances[i] = std::min(distances[i], squared_distance(points[i], points[kept]));
      next = distances[i] > distances[next] ? i : next;
    }
  }
  return most;
}

void Contacts::add_link(const RobotModel& robot, std::size_t link, dBodyID body) {
  bodies_.push_back(body);
  touch_sensors_.add_link(robot, link);
  forces_.push_back(0.0);
}

void Contacts::begin_step() {
  touch_sensors_.release_all();
  points_.clear();
  friction_.begin_step();
  count_ = 0;
}

void Contacts::find(dSpaceID space) { dSpaceCollide(space, this, &Contacts::on_near); }

void Contacts::find(dSpaceID a, dSpaceID b) {
  dSpaceCollide2(reinterpret_cast<dGeomID>(a), reinterpret_cast<dGeomID>(b), this, &Contacts::on_near);
}

void Contacts::end_step() {
  friction_.end_step();
  sum_forces();
  dJointGroupEmpty(group_.get());
}

void Contacts::clear() {
  touch_sensors_.release_all();
  points_.clear();
  std::ranges::fill(forces_, 0.0);
}

void Contacts::sum_forces() {
  std::ranges::fill(forces_, 0.0);
  friction_.for_each_pair([this](dGeomID a, dGeomID b, double force) {
    for (const dGeomID shape : {a, b}) {
      if (const int link = data_of(shape).link; link >= 0) {
        forces_[static_cast<std::size_t>(link)] += force;
      }
    }
  });
}

void Contacts::collide(dGeomID a, dGeomID b) {
  const ShapeData& data_a = data_of(a);
  const ShapeData& data_b = data_of(b);
  // Neighbouring links overlap at their joint by construction.
  if (data_a.link >= 0 && data_b.link >= 0 && std::abs(data_a.link - data_b.link) <= 1) {
    return;
  }
  constexpr std::size_t max_contacts = 8;
  if (!data_a.is_mesh && !data_b.is_mesh) {
    std::array<dContactGeom, max_contacts> points;
    add(a, b, std::span(points).first(contact_points(a, b, points)));
    return;
  }
  std::array<dContactGeom, max_mesh_points> points;
  const auto found = std::span(points).first(contact_points(a, b, points));
  add(a, b, found.first(choose_contacts(found, max_contacts)));
}

void Contacts::add(dGeomID a, dGeomID b, std::span<const dContactGeom> points) {
  if (points.empty()) {
    return;
  }
  const ShapeData& data_a = data_of(a);
  const ShapeData& data_b = data_of(b);
  const dBodyID body_a = dGeomGetBody(a);
  const dBodyID body_b = dGeomGetBody(b);
  const double along = friction_of(data_a.friction, data_b.friction, unspecified_friction_);
  const bool has_axis = data_a.friction_across || data_b.friction_across;
  friction_.begin_pair(a, b, between(data_a, data_b));
  for (const dContactGeom& point : points) {
    dContact contact;  // not initialised: the engine reads only what the mode of the surface names
    contact.geom = point;
    if (has_axis) {
      set_surface_with_axis(contact, along, a, b);
    } else {
      friction_.set_surface(contact, along);
    }
    const dJointID joint = dJointCreateContact(world_, group_.get(), &contact);
    dJointAttach(joint, body_a, body_b);
    friction_.observe(joint);
    note_touch(data_a.link, data_b.link, point);
    note_touch(data_b.link, data_a.link, point);
  }
  count_ += points.size();
}

/// Sets the surface if a body's friction has another coefficient across an axis. If both have such an axis, the first
/// one decides.
void Contacts::set_surface_with_axis(dContact& contact, double along, dGeomID a, dGeomID b) {
  const ShapeData& data_a = data_of(a);
  const ShapeData& data_b = data_of(b);
  const bool first = data_a.friction_across.has_value();
  const double across =
      friction_of((first ? data_a : data_b).friction_across, (first ? data_b : data_a).friction, unspecified_friction_);
  const dReal* rotation = dBodyGetRotation(dGeomGetBody(first ? a : b));  // 3 rows of 4
  friction_.set_surface(contact, {rotation[1], rotation[5], rotation[9]}, along, across);
}

void Contacts::note_touch(int link, int other, const dContactGeom& contact) {
  if (link >= 0 && other < 0) {
    const auto index = static_cast<std::size_t>(link);
    touch_sensors_.press(index, bodies_[index], contact);
    if (keeps_points_) {
      note_point(index, contact);
    }
  }
}

/// The engine's normal points into the first of the two shapes.
void Contacts::note_point(std::size_t link, const dContactGeom& contact) {
  const bool link_is_first = data_of(contact.g1).link >= 0;
  const Eigen::Vector3d normal(contact.normal[0], contact.normal[1], contact.normal[2]);
  points_.push_back(
      {link, {contact.pos[0], contact.pos[1], contact.pos[2]}, link_is_first ? normal : Eigen::Vector3d(-normal)});
}

}  // namespace proleg::sim
