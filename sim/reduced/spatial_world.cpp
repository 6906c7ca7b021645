#include "sim/reduced/spatial_world.hpp"

#include <utility>
#include <vector>

#include "sim/physics/physics_error.hpp"

namespace proleg::sim::reduced {
namespace {

Eigen::Vector3d vector_of(const Point3& point) { return {point.x, point.y, point.z}; }
Point3 point_of(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

class SpatialWorld final : public World {
 public:
  SpatialWorld(const RobotModel& robot, SpatialChain chain, std::shared_ptr<SpatialBatch> batch, std::size_t lane)
      : chain_(std::move(chain)), batch_(std::move(batch)), lane_(lane) {
    for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
      set_joint_torque(joint, robot.joints[joint].max_torque);
    }
    for (const Link& link : robot.links) {
      link_names_.push_back(link.name);
    }
  }

  void set_joint_speed(std::size_t joint, double speed) override { batch_->set_wanted_speed(lane_, joint, speed); }
  void set_joint_speeds(std::span<const double> speeds) override { batch_->set_wanted_speeds(lane_, speeds); }
  void set_joint_torque(std::size_t joint, double torque) override { batch_->set_max_torque(lane_, joint, torque); }
  void read_joints(std::span<double> angles, std::span<double> torques) const override {
    batch_->read_joints(lane_, angles, torques);
  }
  void add_contact_forces(std::span<double> sums) const override { batch_->add_contact_forces(lane_, sums); }

  void move_robot(const Pose& motion) override {
    const SpatialBatch::Orientation now = batch_->orientation(lane_);
    const Eigen::Quaterniond moved = motion.orientation * Eigen::Quaterniond(now.w, now.x, now.y, now.z);
    batch_->move(lane_, point_of(motion * center_of_mass()), {moved.w(), moved.x(), moved.y(), moved.z()});
  }

  void step() override {
    if (batch_->size() == 1) {
      batch_->step();
    }
    if (batch_->failed(lane_)) {
      throw PhysicsError("the simulation became unstable: the position of a link is no longer a finite number");
    }
    if (const auto links = batch_->touching_links(lane_)) {
      throw PhysicsError("links '" + link_names_[links->first] + "' and '" + link_names_[links->second] +
                         "' touch each other; the reduced engine has no such contacts for a robot whose joints have "
                         "different axes (--engine ode has them)");
    }
  }

  [[nodiscard]] double joint_angle(std::size_t joint) const override { return batch_->joint_angle(lane_, joint); }
  [[nodiscard]] double motor_torque(std::size_t joint) const override { return batch_->motor_torque(lane_, joint); }
  [[nodiscard]] Pose link_pose(std::size_t link) const override {
    const SpatialBatch::LinkPlace place = batch_->link_place(lane_, link);
    Eigen::Matrix3d axes;
    axes << vector_of(place.axes[0]), vector_of(place.axes[1]), vector_of(place.axes[2]);
    const Eigen::Quaterniond orientation = (Eigen::Quaterniond(axes) * chain_.link_orientations[link]).normalized();
    return {vector_of(place.position) - orientation * chain_.mass_centers[link], orientation};
  }
  [[nodiscard]] bool is_slower_than(double speed, double rotation) const override {
    for (std::size_t link = 0; link < chain_.links.size(); ++link) {
      const SpatialBatch::LinkMotion motion = batch_->link_motion(lane_, link);
      if (vector_of(motion.velocity).squaredNorm() >= speed * speed ||
          vector_of(motion.rotation).squaredNorm() >= rotation * rotation) {
        return false;
      }
    }
    return true;
  }
  [[nodiscard]] Eigen::Vector3d center_of_mass() const override { return vector_of(batch_->center(lane_)); }
  [[nodiscard]] std::uint8_t link_contacts(std::size_t link) const override { return batch_->pressed(lane_, link); }
  [[nodiscard]] double contact_force(std::size_t link) const override { return batch_->contact_force(lane_, link); }
  [[nodiscard]] std::size_t contact_count() const override { return batch_->contact_count(lane_); }
  [[nodiscard]] ContactSliding contact_sliding() const override { return batch_->sliding(lane_); }
  [[nodiscard]] double energy() const override {
    double energy = 0.0;
    for (std::size_t link = 0; link < chain_.masses.size(); ++link) {
      const SpatialBatch::LinkMotion motion = batch_->link_motion(lane_, link);
      const Eigen::Vector3d position = vector_of(batch_->link_place(lane_, link).position);
      energy += chain_.masses[link] *
                    (0.5 * vector_of(motion.velocity).squaredNorm() - vector_of(chain_.gravity).dot(position)) +
                0.5 * vector_of(motion.rotation).dot(vector_of(motion.angular_momentum));
    }
    return energy;
  }
  [[nodiscard]] std::optional<double> lowest_ground() const override { return chain_.lowest_ground; }
  [[nodiscard]] std::size_t solver_messages() const override { return 0; }
  [[nodiscard]] std::span<const std::string> solver_message_texts() const override { return {}; }
  [[nodiscard]] std::vector<double> state() const override { return batch_->state(lane_); }

 private:
  SpatialChain chain_;
  std::shared_ptr<SpatialBatch> batch_;
  std::size_t lane_;
  std::vector<std::string> link_names_;
};

}  // namespace

std::unique_ptr<World> make_spatial_world(const RobotModel& robot, SpatialChain chain,
                                          std::shared_ptr<SpatialBatch> batch, std::size_t lane) {
  return std::make_unique<SpatialWorld>(robot, std::move(chain), std::move(batch), lane);
}

}  // namespace proleg::sim::reduced
