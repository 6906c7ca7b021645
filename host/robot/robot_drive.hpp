#pragma once

// Drives a robot of modules with the master, and collects the frames that the modules send while the robot moves.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "shared/computer/master/master.hpp"

namespace proleg::host {

/// The state frames with state k + 1, which the modules send after SYNC k.
struct TickFrames {
  std::uint32_t tick = 0;  ///< number k of the tick
  /// Frames by joint, then by channel (0, 1); nothing: this host did not receive the frame.
  std::vector<std::array<std::optional<StateFrame>, 2>> frames;
};

/// The measurement of the module of a joint at SYNC `tick`.
struct Measurement {
  std::uint32_t tick;
  unsigned joint;
  canopen::Monitoring values;
};

class RobotDrive final : public BusUser {
 public:
  /// Number of SYNCs after which the frames of a tick are returned at the latest; no more of them are received then.
  static constexpr std::uint32_t wait_ticks = 2;

  /// port: must outlive this, like all objects that the master refers to.
  RobotDrive(CanPort& port, const canopen::RobotSetup& setup, const canopen::MasterOptions& options,
             std::span<Change> changes);
  RobotDrive(const RobotDrive&) = delete;
  RobotDrive& operator=(const RobotDrive&) = delete;

  [[nodiscard]] canopen::Master& master() { return master_; }
  [[nodiscard]] const canopen::Master& master() const { return master_; }

  /// Takes the frames of the oldest tick that is complete, or wait_ticks old. Ticks follow each other without a gap.
  /// at_end: no more frames are received. To be called at least every 40 ticks: frames of later ticks are lost until
  /// then.
  [[nodiscard]] std::optional<TickFrames> take_tick(bool at_end = false);

  /// The last monitoring message of a joint.
  [[nodiscard]] const std::optional<canopen::Monitoring>& monitoring(unsigned joint) const {
    return monitoring_[joint];
  }

  /// Takes the oldest measurement. Only the newest max_measurements are kept.
  [[nodiscard]] std::optional<Measurement> take_measurement();
  static constexpr std::size_t max_measurements = 1'024;

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override { master_.transmitted(now, frame); }
  void poll(Microseconds now) override { master_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const override { return master_.next_deadline(); }

 private:
  /// Greatest distance in ticks between the oldest kept tick and the present one. A power of 2, below half of the
  /// labels.
  static constexpr std::uint32_t kept = 64;

  void note_measurement(unsigned joint, const canopen::Monitoring& values);
  void note_sync();
  void note_state(const CanFrame& frame, unsigned channel);
  [[nodiscard]] std::optional<unsigned> joint_of(std::uint8_t node) const;
  [[nodiscard]] TickFrames& slot(std::uint32_t tick) { return ring_[tick % kept]; }
  [[nodiscard]] bool is_complete(const TickFrames& frames) const;

  canopen::Master master_;
  std::vector<std::uint8_t> nodes_;
  std::vector<std::uint8_t> channels_;    ///< number of state frames in a tick, by joint
  std::vector<TickFrames> ring_;          ///< frames by tick modulo `kept`
  std::uint32_t next_ = 0;                ///< next tick that is taken
  std::optional<std::uint32_t> present_;  ///< tick of the last SYNC
  std::vector<std::optional<canopen::Monitoring>> monitoring_;
  std::deque<Measurement> measurements_;
};

}  // namespace proleg::host
