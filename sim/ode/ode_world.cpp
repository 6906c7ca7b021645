#include "sim/ode/ode_world.hpp"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "sim/ode/contact_choice.hpp"
#include "sim/ode/contact_friction.hpp"
#include "sim/ode/engine.hpp"
#include "sim/ode/engine_mesh.hpp"
#include "sim/ode/hinge_motor.hpp"
#include "sim/ode/step_memory.hpp"
#include "sim/ode/touch_sensors.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/robot/friction.hpp"

namespace proleg::sim {
namespace {

struct DestroyWorld {
  void operator()(dxWorld* world) const { dWorldDestroy(world); }
};
struct DestroySpace {
  void operator()(dxSpace* space) const { dSpaceDestroy(space); }
};
struct DestroyJointGroup {
  void operator()(dxJointGroup* group) const { dJointGroupDestroy(group); }
};
struct DestroyGeometry {
  void operator()(dxGeom* shape) const { dGeomDestroy(shape); }
};
struct FreeThreading {
  void operator()(dxThreadingImplementation* threading) const { dThreadingFreeImplementation(threading); }
};

void to_quaternion(const Eigen::Quaterniond& orientation, dQuaternion out) {
  out[0] = orientation.w();
  out[1] = orientation.x();
  out[2] = orientation.y();
  out[3] = orientation.z();
}

/// Properties of a geometry for the collision callback.
struct GeometryData {
  int link = -1;  ///< or one of the two below
  std::optional<double> friction;
  std::optional<double> friction_across;
  bool is_mesh = false;
};
constexpr int of_environment = -1;
constexpr int of_moving_object = -2;

Eigen::Vector3d vector_of(const dReal* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// Of the engine's frame, whose origin is the centre of mass.
Pose pose_of(dBodyID body) {
  const dReal* orientation = dBodyGetQuaternion(body);
  return {vector_of(dBodyGetPosition(body)), {orientation[0], orientation[1], orientation[2], orientation[3]}};
}

class OdeWorld final : public World {
 public:
  OdeWorld(const RobotModel& robot, const EnvironmentModel& environment, double step_s, Stepper stepper)
      : step_s_(step_s),
        stepper_(stepper),
        self_collision_(environment.self_collision),
        unspecified_friction_(environment.unspecified_friction) {
    prepare_engine_for_this_thread();
    messages_before_ = engine_messages();
    world_.reset(dWorldCreate());
    StepMemory::use_for(world_.get());
    // A world without its own threading implementation crashes when other worlds are stepped beside it.
    threading_.reset(dThreadingAllocateSelfThreadedImplementation());
    dWorldSetStepThreadingImplementation(world_.get(), dThreadingImplementationGetFunctions(threading_.get()),
                                         threading_.get());
    dRandSetSeed(0);  // dWorldQuickStep shuffles its rows with it
    robot_space_.reset(dSimpleSpaceCreate(nullptr));
    environment_space_.reset(dSimpleSpaceCreate(nullptr));
    object_space_.reset(dSimpleSpaceCreate(nullptr));
    contact_group_.reset(dJointGroupCreate(0));
    dWorldSetGravity(world_.get(), environment.gravity.x(), environment.gravity.y(), environment.gravity.z());

    std::size_t geometry_count = 0;
    for (const Link& link : robot.links) {
      geometry_count += link.geometries.size();
    }
    for (const StaticObject& object : environment.objects) {
      geometry_count += object.geometries.size();
    }
    for (const MovingObject& object : environment.moving_objects) {
      geometry_count += object.geometries.size();
    }
    geometry_data_.reserve(geometry_count);  // the engine keeps pointers into it

    add_environment(environment);
    add_links(robot, environment.robot_pose);
    add_joints(robot, environment.robot_pose);
    for (const MovingObject& object : environment.moving_objects) {
      objects_.push_back(add_body(object_space_.get(), object.pose, object.mass, object.geometries, of_moving_object));
      object_centers_.push_back(object.mass.center);
    }
    all_bodies_ = bodies_;
    all_bodies_.insert(all_bodies_.end(), objects_.begin(), objects_.end());
  }

  void set_joint_speed(std::size_t joint, double speed) override { motors_[joint].set_speed(speed); }
  void set_joint_torque(std::size_t joint, double torque) override { motors_[joint].set_max_torque(torque); }

  void step() override {
    if (world_ == nullptr) {
      throw PhysicsError("the simulation failed at an earlier step");
    }
    step_memory_.select();
    try {
      advance();
    } catch (...) {
      abandon();
      throw;
    }
    require_finite_positions();
  }

  void move_robot(const Pose& motion) override {
    for (const dBodyID body : bodies_) {
      const dReal* position = dBodyGetPosition(body);
      const dReal* orientation = dBodyGetQuaternion(body);
      const Pose moved = motion * Pose{{position[0], position[1], position[2]},
                                       {orientation[0], orientation[1], orientation[2], orientation[3]}};
      dQuaternion turned;
      to_quaternion(moved.orientation, turned);
      dBodySetPosition(body, moved.position.x(), moved.position.y(), moved.position.z());
      dBodySetQuaternion(body, turned);
      dBodySetLinearVel(body, 0.0, 0.0, 0.0);
      dBodySetAngularVel(body, 0.0, 0.0, 0.0);
    }
    touch_sensors_.release_all();
    contact_points_.clear();
    std::ranges::fill(contact_forces_, 0.0);
  }

  [[nodiscard]] double joint_angle(std::size_t joint) const override { return dJointGetHingeAngle(joints_[joint]); }

  [[nodiscard]] double motor_torque(std::size_t joint) const override { return motors_[joint].torque(); }

  [[nodiscard]] Pose link_pose(std::size_t link) const override {
    return pose_of(bodies_[link]) * Pose{-mass_centers_[link], Eigen::Quaterniond::Identity()};
  }

  void read_objects(std::span<Pose> poses) const override {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i] = pose_of(objects_[i]) * Pose{-object_centers_[i], Eigen::Quaterniond::Identity()};
    }
  }

  [[nodiscard]] bool is_slower_than(double speed, double rotation) const override {
    const auto is_below = [](const dReal* vector, double limit) {
      return vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2] < limit * limit;
    };
    return std::ranges::all_of(all_bodies_, [&](dBodyID body) {
      return is_below(dBodyGetLinearVel(body), speed) && is_below(dBodyGetAngularVel(body), rotation);
    });
  }

  [[nodiscard]] Eigen::Vector3d center_of_mass() const override {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double mass = 0.0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const dReal* position = dBodyGetPosition(bodies_[i]);
      sum += masses_[i] * Eigen::Vector3d(position[0], position[1], position[2]);
      mass += masses_[i];
    }
    return sum / mass;
  }

  [[nodiscard]] std::uint8_t link_contacts(std::size_t link) const override { return touch_sensors_.pressed(link); }
  [[nodiscard]] std::size_t contact_count() const override { return contact_count_; }
  [[nodiscard]] double contact_force(std::size_t link) const override { return contact_forces_[link]; }
  [[nodiscard]] ContactSliding contact_sliding() const override { return contact_friction_.sliding(); }
  [[nodiscard]] double energy() const override {
    std::array<dReal, 4> gravity{};
    dWorldGetGravity(world_.get(), gravity.data());
    double energy = 0.0;
    for (const dBodyID body : all_bodies_) {
      dMass mass;
      dBodyGetMass(body, &mass);
      const dReal* rotation = dBodyGetRotation(body);
      const dReal* turning = dBodyGetAngularVel(body);
      Eigen::Vector3d local = Eigen::Vector3d::Zero();  // the rotation in the frame of the body
      for (int row = 0; row < 3; ++row) {
        local += Eigen::Vector3d(rotation[4 * row], rotation[4 * row + 1], rotation[4 * row + 2]) * turning[row];
      }
      Eigen::Matrix3d inertia;
      for (int row = 0; row < 3; ++row) {
        inertia.row(row) << mass.I[4 * row], mass.I[4 * row + 1], mass.I[4 * row + 2];
      }
      const dReal* velocity = dBodyGetLinearVel(body);
      const dReal* position = dBodyGetPosition(body);
      energy += 0.5 * local.dot(inertia * local);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        energy += mass.mass * (0.5 * velocity[axis] * velocity[axis] - gravity.at(axis) * position[axis]);
      }
    }
    return energy;
  }
  void keep_contact_points() override { keeps_contact_points_ = true; }
  [[nodiscard]] std::span<const LinkContact> contact_points() const override { return contact_points_; }
  [[nodiscard]] std::optional<double> distance_along(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                                                     double range, std::size_t link) const override {
    const std::unique_ptr<dxGeom, DestroyGeometry> ray(dCreateRay(nullptr, range));
    dGeomRaySet(ray.get(), from.x(), from.y(), from.z(), direction.x(), direction.y(), direction.z());
    dGeomRaySetClosestHit(ray.get(), 1);
    RayHit hit{ray.get(), static_cast<int>(link), std::nullopt};
    for (dxSpace* const space : {environment_space_.get(), robot_space_.get()}) {
      dSpaceCollide2(ray.get(), reinterpret_cast<dGeomID>(space), &hit, &OdeWorld::on_ray);
    }
    return hit.distance;
  }
  [[nodiscard]] std::optional<double> lowest_ground() const override { return lowest_ground_; }
  [[nodiscard]] std::size_t solver_messages() const override { return engine_messages() - messages_before_; }
  [[nodiscard]] std::span<const std::string> solver_message_texts() const override { return engine_message_texts(); }

 private:
  void advance() {
    touch_sensors_.release_all();
    contact_points_.clear();
    contact_friction_.begin_step();
    contact_count_ = 0;
    dSpaceCollide2(reinterpret_cast<dGeomID>(robot_space_.get()), reinterpret_cast<dGeomID>(environment_space_.get()),
                   this, &OdeWorld::on_near);
    if (self_collision_) {
      dSpaceCollide(robot_space_.get(), this, &OdeWorld::on_near);
    }
    if (!objects_.empty()) {
      const auto objects = reinterpret_cast<dGeomID>(object_space_.get());
      dSpaceCollide2(reinterpret_cast<dGeomID>(robot_space_.get()), objects, this, &OdeWorld::on_near);
      dSpaceCollide2(objects, reinterpret_cast<dGeomID>(environment_space_.get()), this, &OdeWorld::on_near);
      dSpaceCollide(object_space_.get(), this, &OdeWorld::on_near);
    }
    for (HingeMotor& motor : motors_) {
      motor.note_axis();
    }
    if (stepper_ == Stepper::direct) {
      dWorldStep(world_.get(), step_s_);
    } else {
      dWorldQuickStep(world_.get(), step_s_);
    }
    contact_friction_.end_step();
    sum_contact_forces();
    dJointGroupEmpty(contact_group_.get());
  }

  void sum_contact_forces() {
    std::ranges::fill(contact_forces_, 0.0);
    contact_friction_.for_each_pair([this](dGeomID a, dGeomID b, double force) {
      for (const dGeomID shape : {a, b}) {
        if (const int link = static_cast<const GeometryData*>(dGeomGetData(shape))->link; link >= 0) {
          contact_forces_[static_cast<std::size_t>(link)] += force;
        }
      }
    });
  }

  /// An error that the engine raises in the middle of a step leaves jobs in the world's threading implementation, and
  /// destroying that would fail the next assertion. So it is never destroyed, only kept reachable: less than 1 kB.
  void abandon() {
    contact_group_.reset();
    object_space_.reset();
    environment_space_.reset();
    robot_space_.reset();
    world_.reset();
    static auto* const abandoned = new std::vector<void*>;
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    abandoned->push_back(threading_.release());
  }

  /// One number that is not finite makes the sum not finite, so checking the sum checks all of them.
  void require_finite_positions() const {
    double sum = 0.0;
    for (const dBodyID body : all_bodies_) {
      const dReal* position = dBodyGetPosition(body);
      sum += position[0] + position[1] + position[2];
    }
    if (!std::isfinite(sum)) {
      throw PhysicsError(
          "the simulation became unstable: the position of a link or an object is no longer a finite number");
    }
  }

  dGeomID add_geometry(dxSpace* space, const Geometry& geometry, int link) {
    dGeomID shape = nullptr;
    switch (geometry.shape) {
      case Shape::box:
        shape = dCreateBox(space, 2 * geometry.extents.x(), 2 * geometry.extents.y(), 2 * geometry.extents.z());
        break;
      case Shape::sphere:
        shape = dCreateSphere(space, geometry.extents.x());
        break;
      case Shape::cylinder:
        shape = dCreateCylinder(space, geometry.extents.x(), 2 * geometry.extents.y());
        break;
      case Shape::hull:
      case Shape::surface:
      case Shape::height_field:
        shape = meshes_.try_emplace(geometry.mesh.get(), *geometry.mesh).first->second.make_shape(space);
        break;
    }
    geometry_data_.push_back({link, geometry.friction, geometry.friction_across, geometry.mesh != nullptr});
    dGeomSetData(shape, &geometry_data_.back());
    return shape;
  }

  /// The engine's cylinders lie along z, those of the model along y.
  static Eigen::Quaterniond engine_orientation(const Geometry& geometry, const Eigen::Quaterniond& orientation) {
    if (geometry.shape == Shape::cylinder) {
      return orientation * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
    }
    return orientation;
  }

  void add_environment(const EnvironmentModel& environment) {
    for (const StaticObject& object : environment.objects) {
      for (const Geometry& geometry : object.geometries) {
        const dGeomID shape = add_geometry(environment_space_.get(), geometry, of_environment);
        const Pose pose = object.pose * geometry.pose;
        dQuaternion orientation;
        to_quaternion(engine_orientation(geometry, pose.orientation), orientation);
        dGeomSetPosition(shape, pose.position.x(), pose.position.y(), pose.position.z());
        dGeomSetQuaternion(shape, orientation);
        std::array<dReal, 6> bounds{};
        dGeomGetAABB(shape, bounds.data());
        lowest_ground_ = std::min(lowest_ground_.value_or(bounds[4]), bounds[4]);
      }
    }
  }

  /// pose: of the frame of the body, in the world. owner: of its geometries.
  dBodyID add_body(dxSpace* space, const Pose& pose, const MassProperties& properties,
                   const std::vector<Geometry>& geometries, int owner) {
    const dBodyID body = dBodyCreate(world_.get());
    const Eigen::Matrix3d& inertia = properties.inertia;
    dMass mass;
    dMassSetParameters(&mass, properties.mass, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1),
                       inertia(0, 2), inertia(1, 2));
    dBodySetMass(body, &mass);

    // The engine's body frame has its origin at the centre of mass.
    const Eigen::Vector3d center = pose * properties.center;
    dQuaternion orientation;
    to_quaternion(pose.orientation, orientation);
    dBodySetPosition(body, center.x(), center.y(), center.z());
    dBodySetQuaternion(body, orientation);

    for (const Geometry& geometry : geometries) {
      const dGeomID shape = add_geometry(space, geometry, owner);
      dGeomSetBody(shape, body);
      const Eigen::Vector3d offset = geometry.pose.position - properties.center;
      dQuaternion rotation;
      to_quaternion(engine_orientation(geometry, geometry.pose.orientation), rotation);
      dGeomSetOffsetPosition(shape, offset.x(), offset.y(), offset.z());
      dGeomSetOffsetQuaternion(shape, rotation);
    }
    return body;
  }

  void add_links(const RobotModel& robot, const Pose& robot_pose) {
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      const Link& link = robot.links[i];
      bodies_.push_back(
          add_body(robot_space_.get(), robot_pose * link.pose, link.mass, link.geometries, static_cast<int>(i)));
      masses_.push_back(link.mass.mass);
      mass_centers_.push_back(link.mass.center);
      touch_sensors_.add_link(robot, i);
      contact_forces_.push_back(0.0);
    }
  }

  void add_joints(const RobotModel& robot, const Pose& robot_pose) {
    motors_.resize(robot.joints.size());  // the engine keeps pointers into it
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const Joint& joint = robot.joints[i];
      const dJointID hinge = dJointCreateHinge(world_.get(), nullptr);
      dJointAttach(hinge, bodies_[i], bodies_[i + 1]);
      const Eigen::Vector3d anchor = robot_pose * joint.anchor;
      const Eigen::Vector3d axis = robot_pose.orientation * joint.axis;
      dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
      dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
      // With a limp joint that stands exactly at its stop the solver breaks down: distance and force are both 0.
      constexpr double start_distance = 1e-7;  // rad
      const bool can_turn = joint.lower_limit < joint.upper_limit;
      dJointSetHingeParam(hinge, dParamLoStop,
                          joint.lower_limit - (can_turn && joint.lower_limit == 0 ? start_distance : 0));
      dJointSetHingeParam(hinge, dParamHiStop,
                          joint.upper_limit + (can_turn && joint.upper_limit == 0 ? start_distance : 0));
      joints_.push_back(hinge);
      motors_[i].attach(hinge, bodies_[i], joint, robot.links[i]);
    }
  }

  static void on_near(void* self, dGeomID a, dGeomID b) { static_cast<OdeWorld*>(self)->collide(a, b); }

  void collide(dGeomID a, dGeomID b) {
    const auto& data_a = *static_cast<const GeometryData*>(dGeomGetData(a));
    const auto& data_b = *static_cast<const GeometryData*>(dGeomGetData(b));
    // Neighbouring links overlap at their joint by construction.
    if (data_a.link >= 0 && data_b.link >= 0 && std::abs(data_a.link - data_b.link) <= 1) {
      return;
    }
    constexpr std::size_t max_contacts = 8;
    if (!data_a.is_mesh && !data_b.is_mesh) {
      std::array<dContactGeom, max_contacts> points;
      add_contacts(a, b, std::span(points).first(contact_points(a, b, points)));
      return;
    }
    std::array<dContactGeom, max_mesh_points> points;
    const auto found = std::span(points).first(contact_points(a, b, points));
    add_contacts(a, b, found.first(choose_contacts(found, max_contacts)));
  }

  /// Not initialised: the engine fills them in.
  static std::size_t contact_points(dGeomID a, dGeomID b, std::span<dContactGeom> points) {
    return static_cast<std::size_t>(
        dCollide(a, b, static_cast<int>(points.size()), points.data(), sizeof(dContactGeom)));
  }

  static ContactFriction::Between between(const GeometryData& a, const GeometryData& b) {
    if (a.link >= 0 && b.link >= 0) {
      return ContactFriction::Between::links;
    }
    return a.link >= 0 || b.link >= 0 ? ContactFriction::Between::robot_and_world : ContactFriction::Between::objects;
  }

  void add_contacts(dGeomID a, dGeomID b, std::span<const dContactGeom> points) {
    const auto& data_a = *static_cast<const GeometryData*>(dGeomGetData(a));
    const auto& data_b = *static_cast<const GeometryData*>(dGeomGetData(b));
    for (const dContactGeom& point : points) {
      dContact contact;  // not initialised: the engine reads only what the mode of the surface names
      contact.geom = point;
      set_surface(contact, a, b, data_a, data_b);
      const dJointID joint = dJointCreateContact(world_.get(), contact_group_.get(), &contact);
      dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
      contact_friction_.observe(joint);
      note_touch(data_a.link, data_b.link, contact);
      note_touch(data_b.link, data_a.link, contact);
    }
    contact_count_ += points.size();
  }

  void set_surface(dContact& contact, dGeomID a, dGeomID b, const GeometryData& data_a, const GeometryData& data_b) {
    const double along = friction_of(data_a.friction, data_b.friction, unspecified_friction_);
    const ContactFriction::Between who = between(data_a, data_b);
    if (!data_a.friction_across && !data_b.friction_across) {
      contact_friction_.set_surface(contact, along, a, b, who);
      return;
    }
    // Of two such bodies, which scrape along each other, the first one decides.
    const bool first = data_a.friction_across.has_value();
    const double across = friction_of((first ? data_a : data_b).friction_across, (first ? data_b : data_a).friction,
                                      unspecified_friction_);
    const dReal* rotation = dBodyGetRotation(dGeomGetBody(first ? a : b));  // 3 rows of 4
    contact_friction_.set_surface(contact, {rotation[1], rotation[5], rotation[9]}, along, across, a, b, who);
  }

  /// A ray, and the nearest surface that it has met.
  struct RayHit {
    dGeomID ray;
    int link;  ///< whose surfaces do not count
    std::optional<double> distance;
  };

  static void on_ray(void* data, dGeomID a, dGeomID b) {
    auto& hit = *static_cast<RayHit*>(data);
    const dGeomID shape = a == hit.ray ? b : a;
    dContactGeom contact;
    if (static_cast<const GeometryData*>(dGeomGetData(shape))->link != hit.link &&
        dCollide(hit.ray, shape, 1, &contact, sizeof(contact)) > 0) {
      hit.distance = std::min(hit.distance.value_or(contact.depth), contact.depth);
    }
  }

  void note_touch(int link, int other, const dContact& contact) {
    if (link >= 0 && other < 0) {
      const auto index = static_cast<std::size_t>(link);
      touch_sensors_.press(index, bodies_[index], contact.geom);
      if (keeps_contact_points_) {
        note_contact_point(index, contact.geom);
      }
    }
  }

  /// The engine's normal points into the first of the two shapes.
  void note_contact_point(std::size_t link, const dContactGeom& contact) {
    const bool link_is_first = static_cast<const GeometryData*>(dGeomGetData(contact.g1))->link >= 0;
    const Eigen::Vector3d normal(contact.normal[0], contact.normal[1], contact.normal[2]);
    contact_points_.push_back(
        {link, {contact.pos[0], contact.pos[1], contact.pos[2]}, link_is_first ? normal : Eigen::Vector3d(-normal)});
  }

  // Declared in the order in which the engine needs them; destroyed in reverse.
  StepMemory step_memory_;
  std::map<const TriangleMesh*, EngineMesh> meshes_;
  std::unique_ptr<dxThreadingImplementation, FreeThreading> threading_;
  std::unique_ptr<dxWorld, DestroyWorld> world_;
  std::unique_ptr<dxSpace, DestroySpace> robot_space_;
  std::unique_ptr<dxSpace, DestroySpace> environment_space_;
  std::unique_ptr<dxSpace, DestroySpace> object_space_;
  std::unique_ptr<dxJointGroup, DestroyJointGroup> contact_group_;
  std::vector<GeometryData> geometry_data_;
  std::vector<dBodyID> bodies_;                  ///< of the links
  std::vector<dBodyID> objects_;                 ///< of the objects that move
  std::vector<dBodyID> all_bodies_;              ///< of both
  std::vector<Eigen::Vector3d> object_centers_;  ///< of mass, in the frames of the objects
  std::vector<dJointID> joints_;
  std::vector<HingeMotor> motors_;  ///< by joint
  std::vector<double> masses_;
  std::vector<Eigen::Vector3d> mass_centers_;
  TouchSensors touch_sensors_;
  ContactFriction contact_friction_;
  std::vector<double> contact_forces_;  ///< N, by link
  bool keeps_contact_points_ = false;
  std::vector<LinkContact> contact_points_;
  std::size_t contact_count_ = 0;
  std::optional<double> lowest_ground_;
  std::size_t messages_before_ = 0;
  double step_s_;
  Stepper stepper_;
  bool self_collision_;
  double unspecified_friction_;
};

}  // namespace

std::unique_ptr<World> make_ode_world(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                      Stepper stepper) {
  return std::make_unique<OdeWorld>(robot, environment, step_s, stepper);
}

}  // namespace proleg::sim
