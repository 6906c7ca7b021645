#include "sim/mujoco/mujoco_world.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/mujoco/mujoco_model.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/robot/bounds.hpp"
#include "sim/robot/touch_sensor_frame.hpp"

namespace proleg::sim::mujoco {
namespace {

using Vector = Eigen::Vector3d;

// Places in MuJoCo's arrays (write_mjcf).
constexpr int free_joint_positions = 7;
constexpr int free_joint_speeds = 6;
int position_of(std::size_t joint) { return free_joint_positions + static_cast<int>(joint); }
int speed_of(std::size_t joint) { return free_joint_speeds + static_cast<int>(joint); }
int body_of(std::size_t link) { return static_cast<int>(link) + 1; }

Eigen::Map<const Vector> vector_at(const mjtNum* numbers, int row) {
  return Eigen::Map<const Vector>(numbers + 3 * row);
}

/// The motor of a joint must reach its speed by the end of the step with the torque it has, as in ODE. MuJoCo has a
/// constraint that does this for the speed 0: dry friction of a joint. This class gives it the speed. (A velocity
/// actuator with a force range is not the same: its force is computed from the speed at the start of the step, so it is
/// either soft or always at its limit.)
class MujocoWorld final : public World {
 public:
  MujocoWorld(const RobotModel& robot, const EnvironmentModel& environment, double step_s, const std::string& file,
              Integrator integrator)
      : model_(compile_mjcf(write_mjcf(robot, environment, step_s, integrator), file)),
        data_(mj_makeData(model_.get())),
        speeds_(robot.joints.size()),
        torques_(robot.joints.size()),
        contact_forces_(robot.links.size()),
        pressed_(robot.links.size()) {
    fill_height_fields(environment);
    if (data_ == nullptr) {
      throw PhysicsError("MuJoCo finds no memory for a world");
    }
    for (std::size_t link = 0; link < robot.links.size(); ++link) {
      touch_sensors_.push_back(touch_sensor_frame(robot, link));
    }
    for (const StaticObject& object : environment.objects) {
      for (const Geometry& geometry : object.geometries) {
        const double lowest = bounds_of(geometry, object.pose).lowest.z();
        lowest_ground_ = std::min(lowest_ground_.value_or(lowest), lowest);
      }
    }
    prepare_step();
  }

  void set_joint_speed(std::size_t joint, double speed) override { speeds_[joint] = speed; }
  void set_joint_torque(std::size_t joint, double torque) override {
    model_->dof_frictionloss[speed_of(joint)] = torque;
    is_prepared_ = false;
  }

  void move_robot(const Pose& motion) override {
    const Pose moved = motion * link_pose(0);
    const Eigen::Quaterniond& turn = moved.orientation;
    const double place[free_joint_positions] = {
        moved.position.x(), moved.position.y(), moved.position.z(), turn.w(), turn.x(), turn.y(), turn.z()};
    std::ranges::copy(place, data_->qpos);
    std::fill_n(data_->qvel, free_joint_speeds + static_cast<int>(speeds_.size()), 0.0);
    std::fill_n(data_->qacc_warmstart, model_->nv, 0.0);
    std::ranges::fill(pressed_, std::uint8_t{0});
    std::ranges::fill(contact_forces_, 0.0);
    contact_points_.clear();
    prepare_step();
  }

  void step() override {
    if (has_failed_) {
      throw PhysicsError("the simulation failed at an earlier step");
    }
    has_failed_ = true;
    if (!is_prepared_) {
      prepare_step();
    }
    aim_motors();
    keep_sliding_contacts_closed();
    mj_step2(model_.get(), data_.get());
    note_torques();
    note_contacts();
    prepare_step();
    note_sliding();
    has_failed_ = false;
  }

  [[nodiscard]] double joint_angle(std::size_t joint) const override { return data_->qpos[position_of(joint)]; }
  [[nodiscard]] double motor_torque(std::size_t joint) const override { return torques_[joint]; }
  [[nodiscard]] Pose link_pose(std::size_t link) const override {
    const mjtNum* const turn = data_->xquat + 4 * body_of(link);
    return {vector_at(data_->xpos, body_of(link)), {turn[0], turn[1], turn[2], turn[3]}};
  }
  void read_objects(std::span<Pose> poses) const override {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i] = link_pose(pressed_.size() + i);  // the bodies of the objects follow those of the links
    }
  }
  [[nodiscard]] bool is_slower_than(double speed, double rotation) const override {
    for (int body = 1; body < model_->nbody; ++body) {
      if (velocity_of(body, vector_at(data_->xipos, body)).norm() >= speed || rotation_of(body).norm() >= rotation) {
        return false;
      }
    }
    return true;
  }
  [[nodiscard]] Vector center_of_mass() const override { return vector_at(data_->subtree_com, 1); }
  [[nodiscard]] std::uint8_t link_contacts(std::size_t link) const override { return pressed_[link]; }
  [[nodiscard]] double contact_force(std::size_t link) const override { return contact_forces_[link]; }
  [[nodiscard]] std::size_t contact_count() const override { return contacts_.size(); }
  [[nodiscard]] ContactSliding contact_sliding() const override { return sliding_; }
  [[nodiscard]] double energy() const override { return data_->energy[0] + data_->energy[1]; }
  void keep_contact_points() override { keeps_contact_points_ = true; }
  [[nodiscard]] std::span<const LinkContact> contact_points() const override { return contact_points_; }
  [[nodiscard]] std::optional<double> distance_along(const Vector& from, const Vector& direction, double range,
                                                     std::size_t link) const override {
    int shape = -1;
    constexpr mjtByte with_environment = 1;
    const double distance = mj_ray(model_.get(), data_.get(), from.data(), direction.data(), nullptr, with_environment,
                                   body_of(link), &shape);
    return shape >= 0 && distance >= 0.0 && distance <= range ? std::optional(distance) : std::nullopt;
  }
  [[nodiscard]] std::optional<double> lowest_ground() const override { return lowest_ground_; }
  [[nodiscard]] std::size_t solver_messages() const override { return 0; }
  [[nodiscard]] std::span<const std::string> solver_message_texts() const override { return {}; }

 private:
  /// Fills in the heights, from 0 to 1, of each height field of the environment, in its order (mjcf.cpp).
  void fill_height_fields(const EnvironmentModel& environment) {
    std::vector<const HeightField*> filled;
    for (const StaticObject& object : environment.objects) {
      for (const Geometry& geometry : object.geometries) {
        if (!geometry.heights || std::ranges::find(filled, geometry.heights.get()) != filled.end()) {
          continue;
        }
        const auto number = static_cast<std::ptrdiff_t>(filled.size());
        const std::vector<double>& heights = geometry.heights->heights;
        const double lowest = *std::ranges::min_element(heights);
        const double range = model_->hfield_size[4 * number + 2];
        std::ranges::transform(heights, model_->hfield_data + model_->hfield_adr[number],
                               [&](double height) { return static_cast<float>((height - lowest) / range); });
        filled.push_back(geometry.heights.get());
      }
    }
  }

  /// A contact at the start of the last step.
  struct Contact {
    int body;  ///< MuJoCo's number of the body; 0: the environment
    int other;
    Vector point;
    Vector normal;
    Vector force;     ///< force between the two bodies, N
    Vector velocity;  ///< velocity of one relative to the other before the step, m/s
  };

  /// Computes all that depends on positions and speeds, and the constraints of the next step.
  void prepare_step() {
    mj_step1(model_.get(), data_.get());
    for (int warning = 0; warning < mjNWARNING; ++warning) {
      if (data_->warning[warning].number > 0) {
        throw PhysicsError(std::string("the simulation became unstable: MuJoCo warns: ") +
                           mju_warningText(warning, data_->warning[warning].lastinfo));
      }
    }
    is_prepared_ = true;
  }

  /// Sets the reference acceleration of each motor's constraint: it leads to the wanted speed within the step.
  void aim_motors() {
    for (int row = data_->ne; row < data_->ne + data_->nf; ++row) {
      const double wanted = speeds_[static_cast<std::size_t>(data_->efc_id[row] - free_joint_speeds)];
      data_->efc_aref[row] = (wanted - data_->efc_vel[row]) / model_->opt.timestep;
    }
  }

  /// In MuJoCo's model of friction, which is convex, a contact that slides also opens, with the friction coefficient
  /// times its slip: the body hops, and its sensors are released. This function subtracts that speed, for the slip
  /// before the step, from the reference. Coulomb's law remains.
  void keep_sliding_contacts_closed() {
    for (int i = 0; i < data_->ncon; ++i) {
      const int row = data_->contact[i].efc_address;
      if (row >= 0) {
        const double slip = std::hypot(data_->efc_vel[row + 1], data_->efc_vel[row + 2]);
        data_->efc_aref[row] -= data_->contact[i].friction[0] * slip / model_->opt.timestep;
      }
    }
  }

  void note_torques() {
    std::ranges::fill(torques_, 0.0);
    for (int row = data_->ne; row < data_->nefc; ++row) {
      if (data_->efc_type[row] == mjCNSTR_FRICTION_DOF) {
        torques_[static_cast<std::size_t>(data_->efc_id[row] - free_joint_speeds)] += data_->efc_force[row];
      } else if (data_->efc_type[row] == mjCNSTR_LIMIT_JOINT) {
        const auto joint = static_cast<std::size_t>(data_->efc_id[row] - 1);
        const double* const range = model_->jnt_range + 2 * data_->efc_id[row];
        const bool is_lower = data_->qpos[position_of(joint)] < 0.5 * (range[0] + range[1]);
        torques_[joint] += is_lower ? data_->efc_force[row] : -data_->efc_force[row];
      }
    }
    for (std::size_t joint = 0; joint < torques_.size(); ++joint) {
      const double limit = model_->dof_frictionloss[speed_of(joint)];
      torques_[joint] = std::clamp(torques_[joint], -limit, limit);
    }
  }

  void note_contacts() {
    contacts_.clear();
    contact_points_.clear();
    std::ranges::fill(contact_forces_, 0.0);
    std::ranges::fill(pressed_, std::uint8_t{0});
    for (int i = 0; i < data_->ncon; ++i) {
      const mjContact& found = data_->contact[i];
      mjtNum in_frame[6];  // normal, two tangents, three torques
      mj_contactForce(model_.get(), data_.get(), i, in_frame);
      Contact contact{model_->geom_bodyid[found.geom1],
                      model_->geom_bodyid[found.geom2],
                      vector_at(found.pos, 0),
                      vector_at(found.frame, 0),
                      Vector::Zero(),
                      Vector::Zero()};
      for (int axis = 0; axis < 3; ++axis) {
        contact.force += in_frame[axis] * vector_at(found.frame, axis);
      }
      contact.velocity = relative_velocity(contact);
      note_force(contact.body, in_frame[0]);
      note_force(contact.other, in_frame[0]);
      if (is_link(contact.body) != is_link(contact.other)) {
        note_touch(is_link(contact.body) ? contact.body : contact.other, contact);
        note_contact_point(contact);
      }
      contacts_.push_back(contact);
    }
  }

  /// Whether a body is a link; else it is the environment or an object that moves.
  [[nodiscard]] bool is_link(int body) const { return body > 0 && body <= static_cast<int>(pressed_.size()); }

  void note_force(int body, double normal_force) {
    if (is_link(body)) {
      contact_forces_[static_cast<std::size_t>(body - 1)] += normal_force;
    }
  }

  void note_touch(int body, const Contact& contact) {
    const auto link = static_cast<std::size_t>(body - 1);
    const Eigen::Quaterniond to_link = link_pose(link).orientation.conjugate();
    pressed_[link] = static_cast<std::uint8_t>(
        pressed_[link] | touch_sensors_[link].pressed_by(to_link * (contact.point - vector_at(data_->xipos, body)),
                                                         to_link * contact.normal));
  }

  /// Keeps a contact point. MuJoCo's normal points from the first body to the other.
  void note_contact_point(const Contact& contact) {
    if (keeps_contact_points_) {
      const bool is_first = is_link(contact.body);
      const auto link = static_cast<std::size_t>((is_first ? contact.body : contact.other) - 1);
      contact_points_.push_back({link, contact.point, is_first ? Vector(-contact.normal) : contact.normal});
    }
  }

  void note_sliding() {
    sliding_ = {};
    for (const Contact& contact : contacts_) {
      if (is_link(contact.body) && is_link(contact.other)) {
        continue;
      }
      const auto along = [&](const Vector& vector) -> Vector {
        return vector - vector.dot(contact.normal) * contact.normal;
      };
      const double normal_force = std::abs(contact.force.dot(contact.normal));
      const Vector velocity = along(relative_velocity(contact));
      if (is_link(contact.body) || is_link(contact.other)) {
        sliding_.normal_force += normal_force;
        sliding_.force_times_speed += normal_force * velocity.norm();
      }
      // Friction takes the power of a force times the mean of the speeds before and after the step, as in ODE.
      sliding_.friction_power += std::abs(along(contact.force).dot(0.5 * (velocity + along(contact.velocity))));
    }
  }

  /// Velocities of a body, rotation and translation. MuJoCo has them at the centre of mass of the robot or the object.
  [[nodiscard]] Vector rotation_of(int body) const { return vector_at(data_->cvel, 2 * body); }
  [[nodiscard]] Vector velocity_of(int body, const Vector& point) const {
    return vector_at(data_->cvel, 2 * body + 1) +
           rotation_of(body).cross(point - vector_at(data_->subtree_com, model_->body_rootid[body]));
  }
  [[nodiscard]] Vector relative_velocity(const Contact& contact) const {
    return velocity_of(contact.other, contact.point) - velocity_of(contact.body, contact.point);
  }

  Model model_;
  Data data_;
  std::vector<double> speeds_;   ///< wanted speeds by joint, rad/s
  std::vector<double> torques_;  ///< Nm, by joint
  std::vector<Contact> contacts_;
  std::vector<double> contact_forces_;  ///< N, by link
  std::vector<std::uint8_t> pressed_;   ///< sensors by link
  std::vector<TouchSensorFrame> touch_sensors_;
  bool keeps_contact_points_ = false;
  std::vector<LinkContact> contact_points_;
  ContactSliding sliding_;
  std::optional<double> lowest_ground_;
  bool is_prepared_ = false;
  bool has_failed_ = false;
};

}  // namespace

bool is_built_in() { return true; }

namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& found) {
  throw InputError(file, 0, found,
                   "what MuJoCo has here: objects that do not move, of boxes, spheres, cylinders, convex meshes and "
                   "height fields (or "
                   "--engine ode)");
}

void require_known_friction(const RobotModel& robot, const std::string& file) {
  for (const Link& link : robot.links) {
    for (const Geometry& geometry : link.geometries) {
      if (geometry.friction_across) {
        throw InputError(file, 0, "link " + in_quotes(link.name) + " with another friction across it",
                         "the same friction in every direction, as MuJoCo has it here (or --engine ode)");
      }
    }
  }
}

void require_known_shapes(const EnvironmentModel& environment, const std::string& file) {
  for (const StaticObject& object : environment.objects) {
    for (const Geometry& geometry : object.geometries) {
      if (geometry.shape == Shape::surface) {
        refuse(file, "object " + in_quotes(object.name) + " with " + std::string(with_article(geometry.shape)));
      }
    }
  }
}

}  // namespace

std::unique_ptr<World> make_mujoco_world(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                         const std::string& file, Integrator integrator) {
  require_known_shapes(environment, file);
  require_known_friction(robot, file);
  return std::make_unique<MujocoWorld>(robot, environment, step_s, file, integrator);
}

}  // namespace proleg::sim::mujoco
