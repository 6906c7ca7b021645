#pragma once

// A host that drives a robot of modules: the master, and what the modules send while the robot moves.

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
  std::uint32_t tick = 0;  ///< k
  /// By joint, then by channel (0, 1); nothing: this host did not receive it.
  std::vector<std::array<std::optional<StateFrame>, 2>> frames;
};

/// What the module of a joint has measured at SYNC `tick`.
struct Measurement {
  std::uint32_t tick;
  unsigned joint;
  canopen::Monitoring values;
};

class RobotDrive final : public BusUser {
 public:
  /// The frames of a tick are handed out this many SYNCs later at the latest: then none of them comes any more.
  static constexpr std::uint32_t wait_ticks = 2;

  /// port: must outlive this, as all that the master refers to.
  RobotDrive(CanPort& port, const canopen::RobotSetup& setup, const canopen::MasterOptions& options,
             std::span<canopen::Change> changes);
  RobotDrive(const RobotDrive&) = delete;
  RobotDrive& operator=(const RobotDrive&) = delete;

  [[nodiscard]] canopen::Master& master() { return master_; }
  [[nodiscard]] const canopen::Master& master() const { return master_; }

  /// The oldest tick whose frames have not been taken: complete, or wait_ticks old. Ticks follow each other without a
  /// gap. at_end: no more frames come. To be called at least every 40 ticks: frames of later ticks are lost until then.
  [[nodiscard]] std::optional<TickFrames> take_tick(bool at_end = false);

  /// The last monitoring message of a joint.
  [[nodiscard]] const std::optional<canopen::Monitoring>& monitoring(unsigned joint) const {
    return monitoring_[joint];
  }

  /// The oldest measurement that has not been taken. The newest ones are kept, max_measurements of them.
  [[nodiscard]] std::optional<Measurement> take_measurement();
  static constexpr std::size_t max_measurements = 1'024;

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override { master_.transmitted(now, frame); }
  void poll(Microseconds now) override { master_.poll(now); }
  [[nodiscard]] Microseconds next_deadline() const override { return master_.next_deadline(); }

 private:
  /// Ticks between the oldest that is kept and the present one, at most. A power of 2, below half of the labels.
  static constexpr std::uint32_t kept = 64;

  void note_measurement(unsigned joint, const canopen::Monitoring& values);
  void note_sync();
  void note_state(const CanFrame& frame, unsigned channel);
  [[nodiscard]] std::optional<unsigned> joint_of(std::uint8_t node) const;
  [[nodiscard]] TickFrames& slot(std::uint32_t tick) { return ring_[tick % kept]; }
  [[nodiscard]] bool is_complete(const TickFrames& frames) const;

  canopen::Master master_;
  std::vector<std::uint8_t> nodes_;
  std::vector<std::uint8_t> channels_;    ///< by joint: number of state frames in a tick
  std::vector<TickFrames> ring_;          ///< by tick modulo `kept`
  std::uint32_t next_ = 0;                ///< the tick that is taken next
  std::optional<std::uint32_t> present_;  ///< of the last SYNC
  std::vector<std::optional<canopen::Monitoring>> monitoring_;
  std::deque<Measurement> measurements_;
};

}  // namespace proleg::host
