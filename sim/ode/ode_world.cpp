#include "sim/ode/ode_world.hpp"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <vector>

#include "sim/ode/contacts.hpp"
#include "sim/ode/engine.hpp"
#include "sim/ode/hinge_motor.hpp"
#include "sim/ode/shapes.hpp"
#include "sim/physics/physics_error.hpp"

namespace proleg::sim {
namespace {

struct DestroyWorld {
  void operator()(dxWorld* world) const { dWorldDestroy(world); }
};
struct DestroySpace {
  void operator()(dxSpace* space) const { dSpaceDestroy(space); }
};
struct DestroyGeometry {
  void operator()(dxGeom* shape) const { dGeomDestroy(shape); }
};
struct FreeThreading {
  void operator()(dxThreadingImplementation* threading) const { dThreadingFreeImplementation(threading); }
};

Eigen::Vector3d vector_of(const dReal* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// Pose of the engine's frame, whose origin is the centre of mass.
Pose pose_of(dBodyID body) {
  const dReal* orientation = dBodyGetQuaternion(body);
  return {vector_of(dBodyGetPosition(body)), {orientation[0], orientation[1], orientation[2], orientation[3]}};
}

class OdeWorld final : public World {
 public:
  OdeWorld(const RobotModel& robot, const EnvironmentModel& environment, double step_s, Stepper stepper)
      : step_s_(step_s), stepper_(stepper), self_collision_(environment.self_collision) {
    prepare_engine_for_this_thread();
    world_.reset(dWorldCreate());
    StepMemory::use_for(world_.get());
    // A world without its own threading implementation crashes when other worlds are stepped beside it.
    threading_.reset(dThreadingAllocateSelfThreadedImplementation());
    dWorldSetStepThreadingImplementation(world_.get(), dThreadingImplementationGetFunctions(threading_.get()),
                                         threading_.get());
    robot_space_.reset(dSimpleSpaceCreate(nullptr));
    environment_space_.reset(dSimpleSpaceCreate(nullptr));
    object_space_.reset(dSimpleSpaceCreate(nullptr));
    contacts_.emplace(world_.get(), environment.unspecified_friction);
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
    shapes_.reserve(geometry_count);

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
      const std::size_t before = engine_messages();
      advance();
      messages_ += engine_messages() - before;
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
    contacts_->clear();
    for (HingeMotor& motor : motors_) {
      motor.end_step();
    }
  }

  [[nodiscard]] double joint_angle(std::size_t joint) const override { return motors_[joint].angle(); }

  [[nodiscard]] double motor_torque(std::size_t joint) const override { return motors_[joint].torque(); }
  void read_joints(std::span<double> angles, std::span<double> torques) const override {
    for (std::size_t joint = 0; joint < angles.size(); ++joint) {
      angles[joint] = motors_[joint].angle();
      torques[joint] = motors_[joint].torque();
    }
  }

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

  [[nodiscard]] std::uint8_t link_contacts(std::size_t link) const override { return contacts_->pressed(link); }
  [[nodiscard]] std::size_t contact_count() const override { return contacts_->count(); }
  [[nodiscard]] std::size_t relieved_steps() const { return relieved_steps_; }
  [[nodiscard]] double contact_force(std::size_t link) const override { return contacts_->force(link); }
  [[nodiscard]] ContactSliding contact_sliding() const override { return contacts_->sliding(); }
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
  void keep_contact_points() override { contacts_->keep_points(); }
  [[nodiscard]] std::span<const LinkContact> contact_points() const override { return contacts_->points(); }
  [[nodiscard]] std::optional<double> distance_along(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                                                     double range, std::size_t link) const override {
    const std::unique_ptr<dxGeom, DestroyGeometry> ray(dCreateRay(nullptr, range));
    dGeomRaySet(ray.get(), from.x(), from.y(), from.z(), direction.x(), direction.y(), direction.z());
    dGeomRaySetClosestHit(ray.get(), 1);
    RayHit hit{ray.get(), static_cast<int>(link), std::nullopt};
    for (dxSpace* const space : {environment_space_.get(), object_space_.get(), robot_space_.get()}) {
      dSpaceCollide2(ray.get(), reinterpret_cast<dGeomID>(space), &hit, &OdeWorld::on_ray);
    }
    return hit.distance;
  }
  [[nodiscard]] std::optional<double> lowest_ground() const override { return lowest_ground_; }
  [[nodiscard]] std::size_t solver_messages() const override { return messages_; }
  [[nodiscard]] std::span<const std::string> solver_message_texts() const override { return engine_message_texts(); }

 private:
  void advance() {
    contacts_->begin_step();
    contacts_->find(robot_space_.get(), environment_space_.get());
    if (self_collision_) {
      contacts_->find(robot_space_.get());
    }
    if (!objects_.empty()) {
      contacts_->find(robot_space_.get(), object_space_.get());
      contacts_->find(object_space_.get(), environment_space_.get());
      contacts_->find(object_space_.get());
    }
    for (HingeMotor& motor : motors_) {
      motor.begin_step();
    }
    if (stepper_ == Stepper::direct || (stepper_ == Stepper::automatic && budget_.take(contacts_->count()))) {
      dWorldStep(world_.get(), step_s_);
    } else {
      random_numbers_.quick_step(world_.get(), step_s_);
      relieved_steps_ += stepper_ == Stepper::automatic ? 1 : 0;
    }
    contacts_->end_step();
    for (HingeMotor& motor : motors_) {
      motor.end_step();
    }
  }

  /// Gives up the threading implementation. An error that the engine raises in the middle of a step leaves jobs in it,
  /// and destroying it would fail the next assertion. So it is never destroyed, only kept reachable: less than 1 kB.
  void abandon() {
    contacts_->abandon();
    object_space_.reset();
    environment_space_.reset();
    robot_space_.reset();
    world_.reset();
    static auto* const abandoned = new std::vector<void*>;
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    abandoned->push_back(threading_.release());
  }

  /// Checks the sum of all positions: one number that is not finite makes the sum not finite.
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

  void add_environment(const EnvironmentModel& environment) {
    for (const StaticObject& object : environment.objects) {
      for (const Geometry& geometry : object.geometries) {
        const dGeomID shape = shapes_.add(environment_space_.get(), geometry, of_environment);
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

  /// pose: pose of the body's frame in the world. owner: owner of its geometries.
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
      const dGeomID shape = shapes_.add(space, geometry, owner);
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
      contacts_->add_link(robot, i, bodies_.back());
    }
  }

  void add_joints(const RobotModel& robot, const Pose& robot_pose) {
    motors_.resize(robot.joints.size());  // the engine keeps pointers to the motors
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const Joint& joint = robot.joints[i];
      const dJointID hinge = dJointCreateHinge(world_.get(), nullptr);
      dJointAttach(hinge, bodies_[i], bodies_[i + 1]);
      const Eigen::Vector3d anchor = robot_pose * joint.anchor;
      const Eigen::Vector3d axis = robot_pose.orientation * joint.axis;
      dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
      dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
      // The solver fails if a limp joint is exactly at its stop: distance and force are both 0.
      constexpr double start_distance = 1e-7;  // rad
      const bool can_turn = joint.lower_limit < joint.upper_limit;
      dJointSetHingeParam(hinge, dParamLoStop,
                          joint.lower_limit - (can_turn && joint.lower_limit == 0 ? start_distance : 0));
      dJointSetHingeParam(hinge, dParamHiStop,
                          joint.upper_limit + (can_turn && joint.upper_limit == 0 ? start_distance : 0));
      motors_[i].attach(hinge, bodies_[i], joint, robot.links[i]);
    }
  }

  /// A ray, and the nearest surface that it has met.
  struct RayHit {
    dGeomID ray;
    int link;  ///< link whose surfaces do not count
    std::optional<double> distance;
  };

  static void on_ray(void* data, dGeomID a, dGeomID b) {
    auto& hit = *static_cast<RayHit*>(data);
    const dGeomID shape = a == hit.ray ? b : a;
    dContactGeom contact;
    if (data_of(shape).link != hit.link && dCollide(hit.ray, shape, 1, &contact, sizeof(contact)) > 0) {
      hit.distance = std::min(hit.distance.value_or(contact.depth), contact.depth);
    }
  }

  // The engine needs these in the order of declaration; they are destroyed in reverse.
  StepMemory step_memory_;
  SolverRandomNumbers random_numbers_;
  Shapes shapes_;
  std::unique_ptr<dxThreadingImplementation, FreeThreading> threading_;
  std::unique_ptr<dxWorld, DestroyWorld> world_;
  std::unique_ptr<dxSpace, DestroySpace> robot_space_;
  std::unique_ptr<dxSpace, DestroySpace> environment_space_;
  std::unique_ptr<dxSpace, DestroySpace> object_space_;
  std::optional<Contacts> contacts_;
  std::vector<dBodyID> bodies_;                  ///< bodies of the links
  std::vector<dBodyID> objects_;                 ///< bodies of the objects that move
  std::vector<dBodyID> all_bodies_;              ///< bodies of links and objects
  std::vector<Eigen::Vector3d> object_centers_;  ///< centres of mass, in the frames of the objects
  std::vector<HingeMotor> motors_;               ///< by joint
  std::vector<double> masses_;
  std::vector<Eigen::Vector3d> mass_centers_;
  std::optional<double> lowest_ground_;
  std::size_t messages_ = 0;  ///< of its own steps; the thread may step other worlds, too
  double step_s_;
  Stepper stepper_;
  StepBudget budget_;
  std::size_t relieved_steps_ = 0;
  bool self_collision_;
};

}  // namespace

bool StepBudget::take(std::size_t points) {
  constexpr double cube_of_lasting = lasting_points * lasting_points * lasting_points;
  constexpr double moment = 250 * cube_of_lasting;  // two steps of 200 points, or seven of 128
  const auto count = static_cast<double>(points);
  spent_ = std::clamp(spent_ + count * count * count - cube_of_lasting, 0.0, 2 * moment);
  return spent_ <= moment;
}

std::unique_ptr<World> make_ode_world(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                      Stepper stepper) {
  return std::make_unique<OdeWorld>(robot, environment, step_s, stepper);
}

std::size_t relieved_steps(const World& world) {
  const auto* const its = dynamic_cast<const OdeWorld*>(&world);
  return its != nullptr ? its->relieved_steps() : 0;
}

}  // namespace proleg::sim
