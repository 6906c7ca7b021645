#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/robot_control/robot_control.hpp"
#include "shared/gait/joint_readings.hpp"
#include "shared/kernel/servo_pulses.hpp"

namespace proleg::host {

/// Port: the kernels that compute the gait, on the host. A robot behind a plug-in has no modules with a core of their
/// own.
class SetpointSource {
 public:
  virtual ~SetpointSource() = default;

  /// The set-points of the joints, 90 degrees = 2^30: those of the last computed tick; before the first one, those of
  /// the start.
  [[nodiscard]] virtual std::span<const std::int32_t> setpoints() const = 0;
  /// Computes a tick. contacts: debounced contacts of each joint, in the bits of StateFrame::contact_bits.
  virtual void advance(std::span<const std::uint8_t> contacts) = 0;
};

/// Bounds of the commands to joints. The bounds of the plug-in's description are added to them.
struct DriveLimits {
  std::vector<std::int32_t> lower;                      ///< lower limit of each joint, 90 degrees = 2^30, at most 0
  std::vector<std::int32_t> upper;                      ///< upper limit of each joint, 90 degrees = 2^30, at least 0
  std::uint32_t command_speed = default_command_speed;  ///< degrees a second, 90 to 10,000
};

/// Speed of the ramps [deg/s]; equal to that of a quick stop of a module.
inline constexpr std::uint32_t ramp_speed = min_command_speed;

/// Moves a robot through a run: ramps in from the angles that it has, plays the gait, ramps down to 0 degrees, and
/// switches the power of the servos off. It has no clock: tick() is called once a tick period.
class GaitDriver {
 public:
  enum class Phase : std::uint8_t {
    idle,       ///< the servos have no power
    ramp_in,    ///< the joints move to the set-points of the start, at ramp_speed
    gait,       ///< one tick of the gait for each tick()
    ramp_down,  ///< the joints move to 0 degrees, at ramp_speed
    finished,   ///< the servos have no power, or the plug-in is lost
  };

  /// A tick of the gait.
  struct Tick {
    std::uint32_t number;                     ///< number of the tick, from 0
    std::span<const std::int32_t> setpoints;  ///< set-points of the kernels
    std::span<const double> measured_deg;     ///< angles that were received last when the tick ended
  };
  using Observer = std::function<void(const Tick&)>;

  /// control, source: must outlive the driver. ticks: ticks of the gait; 0: it runs until stop(). observer: called
  /// after each tick of the gait; may be empty.
  GaitDriver(RobotControl& control, SetpointSource& source, const DriveLimits& limits, std::uint32_t ticks,
             Observer observer);

  /// Connects, reads the angles and gives the servos power. Throws RobotControlError, and then nothing has moved: a
  /// part does not answer, or a joint is outside of its limits.
  void start();
  /// Performs one period. Does not throw: a failure begins the ramp down. Returns the phase of the next period.
  Phase tick();
  /// Begins the ramp down.
  void stop();

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] std::uint32_t tick_us() const { return control_.setup().tick_us; }
  /// Number of ticks of the gait so far.
  [[nodiscard]] std::uint32_t gait_ticks() const { return gait_ticks_; }
  /// The first failure, which ended the run early.
  [[nodiscard]] const std::optional<std::string>& failure() const { return failure_; }
  /// Greatest difference in degrees of a measured angle from the one commanded in the same tick of the gait. It
  /// contains the delay of the servo.
  [[nodiscard]] double max_difference_deg() const { return max_difference_deg_; }

 private:
  void ramp_in();
  void play_gait();
  void ramp_down();
  void attempt(const std::function<void()>& action);
  void set_step(std::uint32_t degrees_per_second);
  /// Sends the angles that the limiters allow on the way to these goals. Returns whether all goals are reached.
  bool send(std::span<const std::int32_t> goals);
  void read_contacts();
  void require_within_limits(std::span<const double> measured_deg) const;

  RobotControl& control_;
  SetpointSource& source_;
  std::uint32_t command_speed_;
  std::uint32_t max_ticks_;
  Observer observer_;
  std::vector<MotionLimiter> limiters_;
  std::vector<double> lower_deg_;
  std::vector<double> upper_deg_;
  std::vector<double> commanded_deg_;
  std::vector<ContactDebouncer> debouncers_;
  std::vector<std::uint8_t> contacts_;
  Phase phase_ = Phase::idle;
  bool is_at_goal_ = false;  ///< all limiters have reached the last goals
  std::uint32_t gait_ticks_ = 0;
  std::uint32_t settle_ticks_ = 0;
  std::optional<std::string> failure_;
  double max_difference_deg_ = 0.0;
};

/// Port: the clock of a drive.
class Clock {
 public:
  virtual ~Clock() = default;
  /// The time in microseconds; never decreases.
  [[nodiscard]] virtual std::uint64_t now_us() = 0;
  virtual void sleep_until(std::uint64_t time_us) = 0;
};

/// The computer's clock.
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] std::uint64_t now_us() override;
  void sleep_until(std::uint64_t time_us) override;
};

struct DriveResult {
  std::uint32_t gait_ticks = 0;
  std::uint32_t late_ticks = 0;        ///< ticks that began more than a tick period late; the ticks behind them moved
  std::uint64_t max_delay_us = 0;      ///< greatest delay of the start of a tick
  double max_difference_deg = 0.0;     ///< GaitDriver::max_difference_deg()
  std::optional<std::string> failure;  ///< one line about the failure that ended the run early
};

/// Starts the driver and calls its tick() in time until it has finished. must_stop: asked before each tick; true begins
/// the ramp down. A tick that begins late does not make the next ones faster. Throws RobotControlError if the driver
/// does not start.
[[nodiscard]] DriveResult drive(GaitDriver& driver, Clock& clock, const std::function<bool()>& must_stop);

}  // namespace proleg::host
