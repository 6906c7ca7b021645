#pragma once

// Moves the joint of one module to and fro, so that a person can identify the module. All other modules are reset and
// have no power.

#include <array>
#include <cstdint>
#include <optional>

#include "host/robot/bus_user.hpp"
#include "host/robot/sdo_queue.hpp"
#include "shared/computer/master/master.hpp"
#include "shared/kernel/kernel_configuration.hpp"

namespace proleg::host {

struct JointMotionOptions {
  std::int32_t amplitude = raw(Unit::degree, 5);  ///< 90 degrees = 2^30; above 0
  /// Angles that are safe for every joint. The limits of the joint itself (0x607D) apply as well.
  AngleLimits limits;
};

class JointMotion final : public BusUser {
 public:
  enum class State : std::uint8_t {
    idle,
    reading,   ///< the limits and the angle of the joint
    starting,  ///< another host is looked for, modules are reset, this one is set up and gets power
    moving,
    stopping,
    stopped,  ///< the joint has no power
    failed,   ///< problem() says why; stop() switches the power off
  };

  /// port: must outlive this. node: 1 to 126.
  JointMotion(CanPort& port, std::uint8_t node, const JointMotionOptions& options = {});
  JointMotion(const JointMotion&) = delete;
  JointMotion& operator=(const JointMotion&) = delete;

  /// Starts the motion about the measured angle; if the module does not measure it, about the angle nearest to 0 that
  /// the limits allow. The amplitude is reduced if the whole motion does not fit within the limits.
  void start(Microseconds now);
  void stop(Microseconds now);

  [[nodiscard]] State state() const;
  [[nodiscard]] const canopen::Problem& problem() const { return master_ ? master_->problem() : problem_; }
  /// Takes an event of the master: an EMCY, or a module that did not confirm that its servo has no power.
  [[nodiscard]] std::optional<canopen::Event> take_event();
  /// Number of events that were dropped because the log was full.
  [[nodiscard]] std::uint32_t lost_events() const { return master_ ? master_->lost_events() : 0; }
  /// The amplitude, 90 degrees = 2^30; valid when the joint moves.
  [[nodiscard]] std::int32_t amplitude() const { return amplitude_; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  void read(canopen::Address address, std::uint32_t& value);
  void begin_motion(Microseconds now);
  void plan();

  CanPort& port_;
  std::array<std::uint8_t, 1> nodes_;
  JointMotionOptions options_;
  SdoQueue readings_;
  State state_ = State::idle;  ///< state before the master exists
  canopen::Problem problem_;
  // Values that were read from the module.
  std::uint32_t lowest_ = 0;
  std::uint32_t highest_ = 0;
  std::uint32_t measured_ = 0;
  std::uint32_t core_fingerprint_ = 0;

  std::int32_t center_ = 0;
  std::int32_t amplitude_ = 0;
  std::array<AngleLimits, 1> limits_{};
  std::array<Setting, 3> start_values_{};
  canopen::RobotSetup setup_;
  std::optional<canopen::Master> master_;
};

}  // namespace proleg::host
