#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "firmware/module/ports.hpp"
#include "sim/physics/world.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What the joints' programs move: servos and the world, in physics steps of which a tick has a whole number.
class Plant {
 public:
  /// scenario: must outlive the plant.
  explicit Plant(const Scenario& scenario);

  /// A servo takes a pulse, in twelfths of a microsecond.
  void set_command(std::size_t joint, std::int32_t command);
  /// A servo that gets no pulses goes limp.
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
  /// Touch sensors per link: bit 0 rear, bit 1 front; as they are, not debounced.
  [[nodiscard]] std::span<const std::uint8_t> link_contacts() const { return link_contacts_; }

  /// What the module of a joint measures now: the current that its servo drew in the last step (an estimate,
  /// sim/robot/servo_current.hpp), the actual angle, and a chip at 25 degrees Celsius.
  [[nodiscard]] firmware::ServoReadings servo_readings(std::size_t joint) const;

  /// Horizontal distance, in m, of the centre of mass from its start (thesis, equation 3.7).
  [[nodiscard]] double displacement() const;
  /// Contact points in a physics step, on average.
  [[nodiscard]] double mean_contacts() const;
  [[nodiscard]] const World& world() const { return world_; }

 private:
  void read_world();
  void require_crawling() const;

  const Scenario& scenario_;
  World world_;
  std::uint32_t steps_per_tick_;
  std::uint32_t finished_ticks_ = 0;
  std::uint64_t contact_sum_ = 0;
  std::uint64_t steps_ = 0;
  Eigen::Vector3d start_;
  Eigen::Vector3d center_before_;
  std::vector<bool> limp_;
  std::vector<std::int32_t> servo_commands_;
  struct Motion {
    double commanded_speed = 0.0;  ///< rad/s
    double angle_before = 0.0;     ///< rad
  };
  std::vector<Motion> last_step_;  ///< of each joint
  std::vector<Pose> link_poses_;
  std::vector<double> joint_angles_;
  std::vector<std::uint8_t> link_contacts_;
};

}  // namespace proleg::sim
