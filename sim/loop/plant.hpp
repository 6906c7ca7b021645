#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/computer/hash/sha256.hpp"
#include "shared/fixed/random.hpp"
#include "shared/gait/joint_readings.hpp"
#include "sim/loop/module_readings.hpp"
#include "sim/measure/gait_meter.hpp"
#include "sim/physics/world.hpp"
#include "sim/record/motion.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/sensor/attached_sensors.hpp"

namespace proleg::sim {

/// The servos and the world that the joints' programs move, in steps of the physics. A tick is a whole number of steps.
class Plant {
 public:
  /// scenario: must outlive the plant. world: nothing: a new one of the scenario.
  explicit Plant(const Scenario& scenario, std::unique_ptr<World> world = nullptr);

  /// A servo takes a pulse, in twelfths of a microsecond. It acts on the pulse after its latency, in whole steps.
  void set_command(std::size_t joint, std::int32_t command);
  /// A servo that gets no pulses goes limp, after its latency.
  void release(std::size_t joint);

  /// From now on the world makes no step while nothing moves: no servo has had another pulse for a while, and all links
  /// lie still. What was measured last remains. So a simulated robot that lies on the table costs no time; but its
  /// world is not, to the last bit, the one of Simulation.
  void let_it_rest() { may_rest_ = true; }

  /// The joint does not turn any more, and its servo draws this current, in mA, while it gets pulses. Or it turns
  /// again.
  void jam(std::size_t joint, std::uint32_t current_ma);
  void free(std::size_t joint);

  /// Between two ticks: moves the robot as World::move_robot does. The values below are those at its new place. The
  /// measures count only what the robot crawls: for them the world moves with the robot.
  void move_robot(const Pose& motion);

  [[nodiscard]] std::uint32_t steps_per_tick() const { return steps_per_tick_; }
  /// Microseconds from the tick to the start of one of its steps, rounded down; pulses start at whole microseconds, so
  /// the fraction does not matter.
  [[nodiscard]] std::uint32_t step_start_us(std::uint32_t step) const;
  /// Throws PhysicsError if the engine fails.
  void step() {
    begin_step();
    finish_step();
  }
  /// The two halves of step(). Worlds that make their steps together make them between the halves.
  void begin_step();
  void finish_step();
  /// Must be called after the last step of a tick: updates the values below and the measures. A pulse that a servo
  /// takes after the last step counts for the next tick. Throws PhysicsError if the robot moves faster than 100 m/s or
  /// fell off its environment. setpoints: of the gait in this tick, by joint, 90 degrees = 2^30; for the measures of
  /// the servos, which are undefined without.
  void finish_tick(std::span<const std::int32_t> setpoints = {});

  // The state at the end of the last finished tick.

  /// The last pulse of each servo; the middle position before the first one.
  [[nodiscard]] std::span<const std::int32_t> servo_commands() const { return servo_commands_; }
  [[nodiscard]] std::span<const Pose> link_poses() const { return link_poses_; }
  /// The poses of the objects that move.
  [[nodiscard]] std::span<const Pose> object_poses() const { return object_poses_; }
  [[nodiscard]] std::span<const double> joint_angles() const { return joint_angles_; }
  /// Torque of each motor in Nm, and current of each servo in mA (an estimate): means over the tick.
  [[nodiscard]] std::span<const double> motor_torques() const { return motor_torques_; }
  [[nodiscard]] std::span<const double> servo_currents() const { return servo_currents_; }
  /// The contact force of each link, in N: normal forces of its contacts, mean over the last tick.
  [[nodiscard]] std::span<const double> contact_forces() const { return contact_forces_; }
  /// What the sensors of the robot's file measure.
  [[nodiscard]] const AttachedSensors& sensors() const { return sensors_; }
  /// Touch sensors per link, as they are wired to the modules: bit 0 rear, bit 1 front; not debounced, and with the
  /// scenario's contact noise.
  [[nodiscard]] std::span<const std::uint8_t> link_contacts() const { return link_contacts_; }

  /// Adds what a recorder takes of the servos and the world. Valid until the next step.
  void add_to(TickSample& sample) const;

  /// What the module of a joint measures now: the current that its servo drew in the last step (an estimate,
  /// sim/robot/servo.hpp), the actual angle, and a chip at 25 degrees Celsius.
  [[nodiscard]] ServoReadings servo_readings(std::size_t joint) const;

  /// What an algorithm on a joint can read of its module now (shared/gait/joint_readings.hpp), with sensors that no
  /// real module has. Those that no algorithm of the scenario reads are absent.
  [[nodiscard]] JointReadings joint_readings(std::size_t joint) const {
    return module_readings_.of(joint, servo_readings(joint));
  }

  /// The current of a servo, in mA, summed over all steps so far.
  struct DrawnCurrent {
    double sum_ma;
    std::uint64_t steps;
  };
  [[nodiscard]] DrawnCurrent drawn_current(std::size_t joint) const { return {servos_[joint].drawn, steps_}; }

  /// Horizontal distance, in m, of the centre of mass from its start (thesis, equation 3.7), without moves by hand.
  [[nodiscard]] double displacement() const;
  /// The measures of the run so far (sim/measure/gait_meter.hpp).
  [[nodiscard]] const GaitMeter& meter() const { return meter_; }
  /// Where the energy went since the start, in J. Only without moves by hand.
  struct EnergyBalance {
    double motors;    ///< work that the motors did
    double friction;  ///< work that friction took
    double stored;    ///< now in motion and height, more than at the start
    /// stored - motors + friction: what contacts and joints gave beside. It is negative where links strike the ground,
    /// and positive where the engine pushes links apart that are in each other.
    double unexplained;
  };
  [[nodiscard]] EnergyBalance energy_balance() const;
  /// Contact points in a physics step, on average.
  [[nodiscard]] double mean_contacts() const;
  [[nodiscard]] const World& world() const { return *world_; }

 private:
  /// A pulse that a servo has taken and does not act on yet.
  struct DelayedPulse {
    std::uint64_t step;  ///< at which the servo begins to act on it
    std::size_t joint;
    std::optional<std::int32_t> command;  ///< nothing: pulses end, and the servo goes limp
  };

  void act(std::size_t joint, std::int32_t command);
  void go_limp(std::size_t joint);
  /// Updates the torque of a joint's motor after a change of its servo.
  void update_torque(std::size_t joint);
  void act_on_delayed_pulses();
  void step_world();
  void disturb();
  void read_world();
  void add_contact_noise();
  /// The beginning of an error's message: number, from 0, and start of the tick.
  [[nodiscard]] std::string present_tick() const;
  void require_crawling(const Eigen::Vector3d& center) const;

  const Scenario& scenario_;
  std::unique_ptr<World> world_;
  std::uint32_t steps_per_tick_;
  std::uint32_t finished_ticks_ = 0;
  std::uint64_t contact_sum_ = 0;
  std::uint64_t steps_ = 0;
  bool may_rest_ = false;
  bool is_at_rest_ = false;
  std::uint64_t disturbed_at_ = 0;  ///< step at which something moved, or a servo got another pulse
  Eigen::Vector3d start_;
  double start_energy_;  ///< J
  Eigen::Vector3d center_before_;
  std::optional<Pose> unmoved_;           ///< from the world to where the robot would be without moves by hand
  std::vector<Pose> unmoved_link_poses_;  ///< of links, only with moves
  AttachedSensors sensors_;
  ModuleReadings module_readings_;
  GaitMeter meter_;
  std::uint64_t latency_steps_;
  std::deque<DelayedPulse> delayed_pulses_;
  std::vector<std::int32_t> servo_commands_;
  struct Servo {
    std::int32_t command;  ///< the pulse that it acts on
    bool limp = false;
    std::optional<double> jam_ma{};  ///< jammed: the current that it draws then
    double commanded_speed = 0.0;    ///< rad/s, in the last step
    double angle_before = 0.0;       ///< rad, at the start of the last step
    double angle = 0.0;              ///< rad, now
    double torque_sum = 0.0;         ///< Nm, over the steps of this tick
    double current_sum = 0.0;        ///< mA, over the steps of this tick
    double drawn = 0.0;              ///< mA, over all steps
  };
  std::vector<Servo> servos_;  ///< by joint
  Pcg32 contact_noise_;
  std::vector<Pose> link_poses_;
  std::vector<Pose> object_poses_;
  std::vector<double> joint_angles_;
  std::vector<double> motor_torques_;
  std::vector<double> servo_currents_;
  std::vector<double> contact_force_sums_;  ///< N, over the steps of this tick
  std::vector<double> contact_forces_;
  std::vector<double> joint_targets_;  ///< rad, of the servos in the last step
  std::vector<double> setpoints_;      ///< rad, of the gait in this tick
  // What the joints are to do in a step, and what they did.
  std::vector<double> speeds_;               ///< rad/s
  std::vector<double> angles_;               ///< rad
  std::vector<double> torques_;              ///< Nm
  std::vector<std::uint8_t> link_contacts_;  ///< with noise
};

/// Hashes of the states of a world after ticks.
class WorldHash {
 public:
  /// The state at the end of the last finished tick.
  void append(const Plant& plant) {
    for (const double number : plant.world().state()) {
      has_states_ = true;
      hash_.append_number(number);
    }
    motion_.append(plant.link_poses(), plant.object_poses());
  }

  /// Two runs on any two computers had the same motion if these are equal. Nothing if the engine does not give the same
  /// states on every computer.
  [[nodiscard]] std::optional<std::string> hex() const {
    return has_states_ ? std::optional(hash_.hex()) : std::nullopt;
  }
  /// Of the poses, with every engine (sim/record/motion.hpp).
  [[nodiscard]] std::string motion_hex() const { return motion_.hex(); }

 private:
  ValueHash hash_;
  MotionHash motion_;
  bool has_states_ = false;
};

}  // namespace proleg::sim
