#include "sim/reduced/reduced_world.hpp"

#include <optional>
#include <span>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/reduced/planar_chain.hpp"
#include "sim/reduced/spatial_chain.hpp"
#include "sim/reduced/spatial_world.hpp"

namespace proleg::sim::reduced {
namespace {

class ReducedWorld final : public World {
 public:
  /// batch: of which `chain` is number `lane`.
  ReducedWorld(const WorldInput& input, PlanarChain chain, std::shared_ptr<ChainBatch> batch, std::size_t lane)
      : robot_(*input.robot),
        environment_(*input.environment),
        step_s_(input.step_s),
        file_(input.file),
        chain_(std::move(chain)),
        batch_(std::move(batch)),
        lane_(lane),
        places_(robot_.links.size()) {
    for (std::size_t joint = 0; joint < robot_.joints.size(); ++joint) {
      set_joint_torque(joint, robot_.joints[joint].max_torque);
    }
  }

  void set_joint_speed(std::size_t joint, double speed) override {
    batch_->set_wanted_speed(lane_, joint, chain_.joint_signs[joint] * speed);
  }
  void set_joint_speeds(std::span<const double> speeds) override {
    batch_->set_wanted_speeds(lane_, chain_.joint_signs, speeds);
  }
  void read_joints(std::span<double> angles, std::span<double> torques) const override {
    batch_->read_joints(lane_, chain_.joint_signs, angles, torques);
  }
  void add_contact_forces(std::span<double> sums) const override { batch_->add_contact_forces(lane_, sums); }
  void set_joint_torque(std::size_t joint, double torque) override { batch_->set_max_torque(lane_, joint, torque); }

  void move_robot(const Pose& motion) override {
    const Eigen::Vector3d center = motion * center_of_mass();
    // A place that the engine refuses leaves all as it is.
    EnvironmentModel environment = environment_;
    environment.robot_pose = motion * environment_.robot_pose;
    PlanarChain chain = make_planar_chain(robot_, environment, step_s_, file_);
    auto moved = std::make_shared<ChainBatch>(std::span(&chain, 1));
    moved->place_like(0, *batch_, lane_, chain.plane.project(center));
    environment_ = std::move(environment);
    chain_ = std::move(chain);
    batch_ = std::move(moved);
    lane_ = 0;
  }

  void step() override {
    if (batch_->size() == 1) {
      batch_->step();
    }
    if (batch_->failed(lane_)) {
      throw PhysicsError(
          batch_->failure(lane_) == too_many_contacts
              ? "the robot has more contacts at once than the reduced engine keeps (--engine ode has them)"
              : "the simulation became unstable: the position of a link is no longer a finite number");
    }
  }

  [[nodiscard]] double joint_angle(std::size_t joint) const override {
    return chain_.joint_signs[joint] * batch_->joint_angle(lane_, joint);
  }
  [[nodiscard]] double motor_torque(std::size_t joint) const override {
    return chain_.joint_signs[joint] * batch_->motor_torque(lane_, joint);
  }
  [[nodiscard]] Pose link_pose(std::size_t link) const override {
    batch_->read_links(lane_, std::span(places_).first(link + 1));
    return pose_of(link);
  }
  void read_links(std::span<Pose> poses) const override {
    batch_->read_links(lane_, places_);
    for (std::size_t link = 0; link < poses.size(); ++link) {
      poses[link] = pose_of(link);
    }
  }
  [[nodiscard]] bool is_slower_than(double speed, double rotation) const override {
    for (std::size_t link = 0; link < robot_.links.size(); ++link) {
      const ChainBatch::LinkMotion motion = batch_->link_motion(lane_, link);
      if (motion.velocity.x * motion.velocity.x + motion.velocity.z * motion.velocity.z >= speed * speed ||
          motion.rotation * motion.rotation >= rotation * rotation) {
        return false;
      }
    }
    return true;
  }
  [[nodiscard]] Eigen::Vector3d center_of_mass() const override { return chain_.plane.lift(batch_->center(lane_)); }
  [[nodiscard]] std::uint8_t link_contacts(std::size_t link) const override { return batch_->pressed(lane_, link); }
  [[nodiscard]] double contact_force(std::size_t link) const override { return batch_->contact_force(lane_, link); }
  [[nodiscard]] std::size_t contact_count() const override { return batch_->contact_count(lane_); }
  [[nodiscard]] ContactSliding contact_sliding() const override { return batch_->sliding(lane_); }
  [[nodiscard]] double energy() const override {
    batch_->read_links(lane_, places_);
    double energy = 0.0;
    for (std::size_t link = 0; link < chain_.masses.size(); ++link) {
      const ChainBatch::LinkMotion motion = batch_->link_motion(lane_, link);
      const Point position = places_[link].position;
      const double squared_speed = motion.velocity.x * motion.velocity.x + motion.velocity.z * motion.velocity.z;
      const double fall = chain_.gravity.x * position.x + chain_.gravity.z * position.z;
      energy += chain_.masses[link] * (0.5 * squared_speed - fall) +
                0.5 * chain_.inertias[link] * motion.rotation * motion.rotation;
    }
    return energy;
  }
  [[nodiscard]] std::optional<double> lowest_ground() const override { return chain_.lowest_ground; }
  [[nodiscard]] std::size_t solver_messages() const override { return 0; }
  [[nodiscard]] std::span<const std::string> solver_message_texts() const override { return {}; }
  [[nodiscard]] std::vector<double> state() const override {
    std::vector<double> state = batch_->state(lane_);
    const MotionPlane& plane = chain_.plane;
    for (const double number : {plane.across.x(), plane.across.y(), plane.offset}) {
      state.push_back(number + 0.0);  // rounding errors may give -0.0
    }
    return state;
  }

 private:
  /// The link's place must have been read.
  [[nodiscard]] Pose pose_of(std::size_t link) const {
    const ChainBatch::LinkPlace& place = places_[link];
    const Eigen::Vector3d turn = -place.half_sine * chain_.plane.across;
    const Eigen::Quaterniond orientation =
        Eigen::Quaterniond(place.half_cosine, turn.x(), turn.y(), turn.z()) * chain_.start_orientations[link];
    return {chain_.plane.lift(place.position) - orientation * chain_.mass_centers[link], orientation};
  }

  RobotModel robot_;
  EnvironmentModel environment_;  ///< with the robot's pose after the moves so far
  double step_s_;
  std::string file_;
  PlanarChain chain_;
  std::shared_ptr<ChainBatch> batch_;
  std::size_t lane_;
  mutable std::vector<ChainBatch::LinkPlace> places_;  ///< of the links, as they were read last
};

/// Rays and single contact points are no part of this engine.
void refuse_sensors(const RobotModel& robot) {
  for (const AttachedSensor& sensor : robot.sensors) {
    if (sensor.kind == SensorKind::laser || sensor.kind == SensorKind::touch) {
      throw InputError(
          sensor.file, sensor.line, "sensor '" + sensor.name + "' of type " + std::string(name_of(sensor.kind)),
          "what the reduced engine has: ServoCurrent, Inclinometer and Accelerometer (--engine ode has all "
          "sensors)");
    }
  }
}

/// A batch for all chains of one form. use(i, batch, lane): chain i is in this lane; it is not needed any more.
template <typename Batch, typename Chain, typename Use>
std::vector<std::shared_ptr<Batch>> make_batches(const std::vector<Chain>& chains, const ChainKernel* kernel,
                                                 Use&& use) {
  std::vector<std::shared_ptr<Batch>> batches;
  std::vector<bool> is_done(chains.size());
  for (std::size_t first = 0; first < chains.size(); ++first) {
    if (is_done[first]) {
      continue;
    }
    std::vector<Chain> alike;
    std::vector<std::size_t> numbers;
    for (std::size_t i = first; i < chains.size(); ++i) {
      if (!is_done[i] && chains[i].has_form_of(chains[first])) {
        alike.push_back(chains[i]);
        numbers.push_back(i);
        is_done[i] = true;
      }
    }
    batches.push_back(std::make_shared<Batch>(alike, kernel));
    for (std::size_t lane = 0; lane < numbers.size(); ++lane) {
      use(numbers[lane], batches.back(), lane);
    }
  }
  return batches;
}

}  // namespace

std::unique_ptr<World> make_reduced_world(const RobotModel& robot, const EnvironmentModel& environment, double step_s,
                                          const std::string& file) {
  const WorldInput input{&robot, &environment, step_s, file};
  return std::move(ReducedWorlds(std::span(&input, 1)).take_worlds().front());
}

ReducedWorlds::ReducedWorlds(std::span<const WorldInput> inputs, const ChainKernel* kernel) : worlds_(inputs.size()) {
  std::vector<PlanarChain> chains;
  std::vector<std::size_t> numbers;  // of their inputs
  std::vector<SpatialChain> spatial_chains;
  std::vector<std::size_t> spatial_numbers;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const WorldInput& input = inputs[i];
    refuse_sensors(*input.robot);
    if (needs_space(*input.robot, *input.environment)) {
      spatial_chains.push_back(make_spatial_chain(*input.robot, *input.environment, input.step_s, input.file));
      spatial_numbers.push_back(i);
    } else {
      chains.push_back(make_planar_chain(*input.robot, *input.environment, input.step_s, input.file));
      numbers.push_back(i);
    }
  }
  batches_ = make_batches<ChainBatch>(
      chains, kernel, [&](std::size_t i, const std::shared_ptr<ChainBatch>& batch, std::size_t lane) {
        worlds_[numbers[i]] = std::make_unique<ReducedWorld>(inputs[numbers[i]], std::move(chains[i]), batch, lane);
      });
  spatial_batches_ = make_batches<SpatialBatch>(
      spatial_chains, kernel, [&](std::size_t i, const std::shared_ptr<SpatialBatch>& batch, std::size_t lane) {
        worlds_[spatial_numbers[i]] =
            make_spatial_world(*inputs[spatial_numbers[i]].robot, std::move(spatial_chains[i]), batch, lane);
      });
}

void ReducedWorlds::step() {
  const auto step_all = [](const auto& batches) {
    for (const auto& batch : batches) {
      if (batch->size() > 1) {
        batch->step();  // a world that is alone makes its own step
      }
    }
  };
  step_all(batches_);
  step_all(spatial_batches_);
}

}  // namespace proleg::sim::reduced
