#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "firmware/module/ports.hpp"
#include "shared/fixed/random.hpp"
#include "sim/measure/gait_meter.hpp"
#include "sim/physics/world.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What the joints' programs move: servos and the world, in physics steps of which a tick has a whole number.
class Plant {
 public:
  /// scenario: must outlive the plant.
  explicit Plant(const Scenario& scenario);

  /// A servo takes a pulse, in twelfths of a microsecond. It acts on it after its latency, in whole steps.
  void set_command(std::size_t joint, std::int32_t command);
  /// A servo that gets no pulses goes limp, after its latency.
  void release(std::size_t joint);

  [[nodiscard]] std::uint32_t steps_per_tick() const { return steps_per_tick_; }
  /// Microseconds from the tick to the start of one of its steps, rounded down; pulses start at whole microseconds, so
  /// nothing is lost.
  [[nodiscard]] std::uint32_t step_start_us(std::uint32_t step) const;
  /// Throws PhysicsError if the engine gave up.
  void step();
  /// To be called after the last step of a tick: updates what follows. Throws PhysicsError if the robot moves faster
  /// than 100 m/s or fell off its environment.
  void finish_tick();

  // As of the last tick that was finished.
  /// The last pulse of each servo; the middle position before the first one.
  [[nodiscard]] std::span<const std::int32_t> servo_commands() const { return servo_commands_; }
  [[nodiscard]] std::span<const Pose> link_poses() const { return link_poses_; }
  [[nodiscard]] std::span<const double> joint_angles() const { return joint_angles_; }
  /// Touch sensors per link: bit 0 rear, bit 1 front; not debounced, and with the scenario's contact noise.
  [[nodiscard]] std::span<const std::uint8_t> link_contacts() const { return link_contacts_; }

  /// What the module of a joint measures now: the current that its servo drew in the last step (an estimate,
  /// sim/robot/servo_current.hpp), the actual angle, and a chip at 25 degrees Celsius.
  [[nodiscard]] firmware::ServoReadings servo_readings(std::size_t joint) const;

  /// Horizontal distance, in m, of the centre of mass from its start (thesis, equation 3.7).
  [[nodiscard]] double displacement() const;
  /// What the run was worth so far, and how much each link was on the ground (sim/measure/gait_meter.hpp).
  [[nodiscard]] const GaitMeter& meter() const { return meter_; }
  /// Contact points in a physics step, on average.
  [[nodiscard]] double mean_contacts() const;
  [[nodiscard]] const World& world() const { return world_; }

 private:
  /// What a servo was told: a pulse, or that there is none.
  struct Order {
    std::uint64_t step;  ///< from which on it acts on it
    std::size_t joint;
    std::optional<std::int32_t> command;
  };

  void act(std::size_t joint, std::int32_t command);
  void go_limp(std::size_t joint);
  void follow_orders();
  void read_world();
  void add_contact_noise();
  void require_crawling(const Eigen::Vector3d& center) const;

  const Scenario& scenario_;
  World world_;
  std::uint32_t steps_per_tick_;
  std::uint32_t finished_ticks_ = 0;
  std::uint64_t contact_sum_ = 0;
  std::uint64_t steps_ = 0;
  Eigen::Vector3d start_;
  Eigen::Vector3d center_before_;
  GaitMeter meter_;
  std::uint64_t latency_steps_;
  std::deque<Order> orders_;  ///< that servos have not acted on yet
  std::vector<std::int32_t> servo_commands_;
  struct Servo {
    std::int32_t command;  ///< that it acts on
    bool limp = false;
    double commanded_speed = 0.0;  ///< rad/s, in the last step
    double angle_before = 0.0;     ///< rad, at the start of the last step
    double angle = 0.0;            ///< rad, now
  };
  std::vector<Servo> servos_;  ///< of each joint
  Pcg32 contact_noise_;
  std::vector<Pose> link_poses_;
  std::vector<double> joint_angles_;
  std::vector<double> joint_targets_;        ///< rad, that the servos turn to
  std::vector<std::uint8_t> link_contacts_;  ///< with noise
};

}  // namespace proleg::sim
