#include "sim/reduced/reduced_world.hpp"

#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/physics/physics_error.hpp"

namespace proleg::sim::reduced {
namespace {

Eigen::Vector3d vector_of(const Point3& point) { return {point.x, point.y, point.z}; }
Point3 point_of(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

double product(double a, double b) { return a * b; }
double product(const Point& a, const Point& b) { return a.x * b.x + a.z * b.z; }
double product(const Point3& a, const Point3& b) { return vector_of(a).dot(vector_of(b)); }

// The order of multiplications decides the last bit.
double twice_energy_of_rotation(const PlanarChain& chain, std::size_t link, const Planar::LinkMotion& motion) {
  return chain.inertias[link] * motion.rotation * motion.rotation;
}
double twice_energy_of_rotation(const SpatialChain& /*chain*/, std::size_t /*link*/,
                                const Spatial::LinkMotion& motion) {
  return product(motion.rotation, motion.angular_momentum);
}

Eigen::Vector3d in_world(const PlanarChain& chain, const Point& point) { return chain.plane.lift(point); }
Eigen::Vector3d in_world(const SpatialChain& /*chain*/, const Point3& point) { return vector_of(point); }

Eigen::Quaterniond orientation_of(const PlanarChain& chain, std::size_t link, const Planar::LinkPlace& place) {
  const Eigen::Vector3d turn = -place.half_sine * chain.plane.across;
  return Eigen::Quaterniond(place.half_cosine, turn.x(), turn.y(), turn.z()) * chain.link_orientations[link];
}
Eigen::Quaterniond orientation_of(const SpatialChain& chain, std::size_t link, const Spatial::LinkPlace& place) {
  Eigen::Matrix3d axes;
  axes << vector_of(place.axes[0]), vector_of(place.axes[1]), vector_of(place.axes[2]);
  return (Eigen::Quaterniond(axes) * chain.link_orientations[link]).normalized();
}

template <typename Chain>
class ReducedWorld final : public World {
  using Kind = typename Chain::Kind;
  using Batch = ChainBatch<Kind>;
  static constexpr bool is_planar = std::is_same_v<Kind, Planar>;

 public:
  /// batch: the batch in which `chain` is number `lane`.
  ReducedWorld(const WorldInput& input, Chain chain, std::shared_ptr<Batch> batch, std::size_t lane)
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
    if constexpr (is_planar) {
      // The plane may be another one. A place that the engine refuses leaves all as it is.
      EnvironmentModel environment = environment_;
      environment.robot_pose = motion * environment_.robot_pose;
      Chain chain = make_planar_chain(robot_, environment, step_s_, file_);
      auto moved = std::make_shared<Batch>(std::span(&chain, 1));
      moved->place_like(0, *batch_, lane_, chain.plane.project(center));
      environment_ = std::move(environment);
      chain_ = std::move(chain);
      batch_ = std::move(moved);
      lane_ = 0;
    } else {
      const auto [w, x, y, z] = batch_->orientation(lane_);
      const Eigen::Quaterniond moved = motion.orientation * Eigen::Quaterniond(w, x, y, z);
      batch_->move(lane_, point_of(center), {moved.w(), moved.x(), moved.y(), moved.z()});
    }
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
    if (const auto links = batch_->touching_links(lane_)) {
      throw PhysicsError("links '" + robot_.links[links->first].name + "' and '" + robot_.links[links->second].name +
                         "' touch each other; the reduced engine has no such contacts for a robot whose joints have "
                         "different axes (--engine ode has them)");
    }
  }

  [[nodiscard]] double joint_angle(std::size_t joint) const override {
    return chain_.joint_signs[joint] * batch_->joint_angle(lane_, joint);
  }
  [[nodiscard]] double motor_torque(std::size_t joint) const override {
    return chain_.joint_signs[joint] * batch_->motor_torque(lane_, joint);
  }
  [[nodiscard]] Pose link_pose(std::size_t link) const override {
    return pose_of(link, batch_->link_place(lane_, link));
  }
  void read_links(std::span<Pose> poses) const override {
    batch_->read_links(lane_, places_);
    for (std::size_t link = 0; link < poses.size(); ++link) {
      poses[link] = pose_of(link, places_[link]);
    }
  }
  [[nodiscard]] bool is_slower_than(double speed, double rotation) const override {
    for (std::size_t link = 0; link < robot_.links.size(); ++link) {
      const auto motion = batch_->link_motion(lane_, link);
      if (product(motion.velocity, motion.velocity) >= speed * speed ||
          product(motion.rotation, motion.rotation) >= rotation * rotation) {
        return false;
      }
    }
    return true;
  }
  [[nodiscard]] Eigen::Vector3d center_of_mass() const override { return in_world(chain_, batch_->center(lane_)); }
  [[nodiscard]] std::uint8_t link_contacts(std::size_t link) const override { return batch_->pressed(lane_, link); }
  [[nodiscard]] double contact_force(std::size_t link) const override { return batch_->contact_force(lane_, link); }
  [[nodiscard]] std::size_t contact_count() const override { return batch_->contact_count(lane_); }
  [[nodiscard]] ContactSliding contact_sliding() const override { return batch_->sliding(lane_); }
  [[nodiscard]] double energy() const override {
    batch_->read_links(lane_, places_);
    double energy = 0.0;
    for (std::size_t link = 0; link < chain_.masses.size(); ++link) {
      const auto motion = batch_->link_motion(lane_, link);
      const double squared_speed = product(motion.velocity, motion.velocity);
      const double fall = product(chain_.gravity, places_[link].position);
      energy +=
          chain_.masses[link] * (0.5 * squared_speed - fall) + 0.5 * twice_energy_of_rotation(chain_, link, motion);
    }
    return energy;
  }
  [[nodiscard]] std::optional<double> lowest_ground() const override { return chain_.lowest_ground; }
  [[nodiscard]] std::size_t solver_messages() const override { return 0; }
  [[nodiscard]] std::span<const std::string> solver_message_texts() const override { return {}; }
  [[nodiscard]] std::vector<double> state() const override {
    std::vector<double> state = batch_->state(lane_);
    if constexpr (is_planar) {
      const MotionPlane& plane = chain_.plane;
      for (const double number : {plane.across.x(), plane.across.y(), plane.offset}) {
        state.push_back(number + 0.0);  // rounding errors may give -0.0
      }
    }
    return state;
  }

 private:
  [[nodiscard]] Pose pose_of(std::size_t link, const typename Kind::LinkPlace& place) const {
    const Eigen::Quaterniond orientation = orientation_of(chain_, link, place);
    return {in_world(chain_, place.position) - orientation * chain_.mass_centers[link], orientation};
  }

  RobotModel robot_;
  EnvironmentModel environment_;  ///< in a plane it has the robot's pose after the moves so far
  double step_s_;
  std::string file_;
  Chain chain_;
  std::shared_ptr<Batch> batch_;
  std::size_t lane_;
  mutable std::vector<typename Kind::LinkPlace> places_;  ///< where read_links() and energy() read the links
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

/// Chains, and the numbers of the inputs that they are made from.
template <typename Chain>
struct NumberedChains {
  std::vector<Chain> chains;
  std::vector<std::size_t> numbers;

  void add(Chain chain, std::size_t number) {
    chains.push_back(std::move(chain));
    numbers.push_back(number);
  }
};

/// Makes the worlds of the chains. Returns their batches: one for all chains of one form.
template <typename Chain>
auto make_worlds(std::span<const WorldInput> inputs, NumberedChains<Chain> of, const ChainKernel* kernel,
                 std::vector<std::unique_ptr<World>>& worlds) {
  using Batch = ChainBatch<typename Chain::Kind>;
  std::vector<std::shared_ptr<Batch>> batches;
  std::vector<bool> is_done(of.chains.size());
  for (std::size_t first = 0; first < of.chains.size(); ++first) {
    if (is_done[first]) {
      continue;
    }
    std::vector<Chain> alike;
    std::vector<std::size_t> numbers;
    for (std::size_t i = first; i < of.chains.size(); ++i) {
      if (!is_done[i] && of.chains[i].has_form_of(of.chains[first])) {
        alike.push_back(of.chains[i]);
        numbers.push_back(of.numbers[i]);
        is_done[i] = true;
      }
    }
    batches.push_back(std::make_shared<Batch>(alike, kernel));
    for (std::size_t lane = 0; lane < numbers.size(); ++lane) {
      worlds[numbers[lane]] =
          std::make_unique<ReducedWorld<Chain>>(inputs[numbers[lane]], std::move(alike[lane]), batches.back(), lane);
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

std::unique_ptr<World> make_world(const WorldInput& input, SpatialChain chain,
                                  std::shared_ptr<ChainBatch<Spatial>> batch, std::size_t lane) {
  return std::make_unique<ReducedWorld<SpatialChain>>(input, std::move(chain), std::move(batch), lane);
}

ReducedWorlds::ReducedWorlds(std::span<const WorldInput> inputs, const ChainKernel* kernel) : worlds_(inputs.size()) {
  NumberedChains<PlanarChain> planar;
  NumberedChains<SpatialChain> spatial;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const WorldInput& input = inputs[i];
    refuse_sensors(*input.robot);
    if (needs_space(*input.robot, *input.environment)) {
      spatial.add(make_spatial_chain(*input.robot, *input.environment, input.step_s, input.file), i);
    } else {
      planar.add(make_planar_chain(*input.robot, *input.environment, input.step_s, input.file), i);
    }
  }
  planar_batches_ = make_worlds(inputs, std::move(planar), kernel, worlds_);
  spatial_batches_ = make_worlds(inputs, std::move(spatial), kernel, worlds_);
}

void ReducedWorlds::step() {
  const auto step_all = [](const auto& batches) {
    for (const auto& batch : batches) {
      if (batch->size() > 1) {
        batch->step();  // a world that is alone makes its own step
      }
    }
  };
  step_all(planar_batches_);
  step_all(spatial_batches_);
}

}  // namespace proleg::sim::reduced
