#include "sim/reduced/reduced_world.hpp"

#include <optional>
#include <span>
#include <utility>

#include "sim/physics/physics_error.hpp"

namespace proleg::sim::reduced {
namespace {

class ReducedWorld final : public World {
 public:
  ReducedWorld(const RobotModel& robot, const EnvironmentModel& environment, double step_s, std::string file)
      : robot_(robot),
        environment_(environment),
        step_s_(step_s),
        file_(std::move(file)),
        chain_(make_planar_chain(robot_, environment_, step_s_, file_)),
        batch_(std::make_unique<ChainBatch>(std::span(&chain_, 1))) {
    for (std::size_t joint = 0; joint < robot_.joints.size(); ++joint) {
      set_joint_torque(joint, robot_.joints[joint].max_torque);
    }
  }

  void set_joint_speed(std::size_t joint, double speed) override {
    batch_->set_wanted_speed(0, joint, chain_.joint_signs[joint] * speed);
  }
  void set_joint_torque(std::size_t joint, double torque) override { batch_->set_max_torque(0, joint, torque); }

  void move_robot(const Pose& motion) override {
    // A place that the engine refuses leaves all as it is.
    const Eigen::Vector3d center = motion * center_of_mass();
    EnvironmentModel environment = environment_;
    environment.robot_pose = motion * environment_.robot_pose;
    PlanarChain chain = make_planar_chain(robot_, environment, step_s_, file_);
    auto batch = std::make_unique<ChainBatch>(std::span(&chain, 1));
    batch->place_like(0, *batch_, 0, chain.plane.project(center));
    environment_ = std::move(environment);
    chain_ = std::move(chain);
    batch_ = std::move(batch);
  }

  void step() override {
    batch_->step();
    if (batch_->failed(0)) {
      throw PhysicsError(
          "the simulation became unstable: the position of a link is no longer a finite number, or it has "
          "more contacts than the engine keeps");
    }
  }

  [[nodiscard]] double joint_angle(std::size_t joint) const override {
    return chain_.joint_signs[joint] * batch_->joint_angle(0, joint);
  }
  [[nodiscard]] double motor_torque(std::size_t joint) const override {
    return chain_.joint_signs[joint] * batch_->motor_torque(0, joint);
  }
  [[nodiscard]] Pose link_pose(std::size_t link) const override {
    const ChainBatch::LinkPlace place = batch_->link_place(0, link);
    const Eigen::Quaterniond orientation =
        Eigen::AngleAxisd(-place.angle, chain_.plane.across) * chain_.start_orientations[link];
    return {chain_.plane.lift(place.position) - orientation * chain_.mass_centers[link], orientation};
  }
  [[nodiscard]] bool is_slower_than(double speed, double rotation) const override {
    for (std::size_t link = 0; link < robot_.links.size(); ++link) {
      const ChainBatch::LinkMotion motion = batch_->link_motion(0, link);
      if (motion.velocity.x * motion.velocity.x + motion.velocity.z * motion.velocity.z >= speed * speed ||
          motion.rotation * motion.rotation >= rotation * rotation) {
        return false;
      }
    }
    return true;
  }
  [[nodiscard]] Eigen::Vector3d center_of_mass() const override { return chain_.plane.lift(batch_->center(0)); }
  [[nodiscard]] std::uint8_t link_contacts(std::size_t link) const override { return batch_->pressed(0, link); }
  [[nodiscard]] double contact_force(std::size_t link) const override { return batch_->contact_force(0, link); }
  [[nodiscard]] std::size_t contact_count() const override { return batch_->contact_count(0); }
  [[nodiscard]] ContactSliding contact_sliding() const override { return batch_->sliding(0); }
  [[nodiscard]] std::optional<double> lowest_ground() const override { return chain_.lowest_ground; }
  [[nodiscard]] std::size_t solver_messages() const override { return 0; }
  [[nodiscard]] std::span<const std::string> solver_message_texts() const override { return {}; }
  [[nodiscard]] std::vector<double> state() const override { return batch_->state(0); }

 private:
  RobotModel robot_;
  EnvironmentModel environment_;  ///< with the robot's pose after the moves so far
  double step_s_;
  std::string file_;
  PlanarChain chain_;
  std::unique_ptr<ChainBatch> batch_;
};

}  // namespace

std::unique_ptr<World> make_reduced_world(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                          const std::string& file) {
  return std::make_unique<ReducedWorld>(robot, environment, step_s, file);
}

}  // namespace proleg::sim::reduced
