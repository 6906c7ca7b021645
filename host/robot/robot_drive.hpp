#pragma once

// Drives a robot of modules with the master, collects the frames that the modules send while the robot moves, and
// checks that modules and this computer have the same set-points.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "shared/computer/master/master.hpp"
#include "shared/fixed/crc32.hpp"

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

/// Checks that modules and this computer have the same set-points, in all 32 bits: state frames carry only the upper
/// bits of angles.
class SetpointCheck {
 public:
  enum class Result : std::uint8_t {
    equal,
    different,
    // With the results below nothing was compared.
    no_checksum,   ///< the program of the module is older than these checksums
    no_answer,     ///< the module has not answered
    not_complete,  ///< the module has joined the robot late
    unknown_tick,  ///< this computer does not have the set-points up to the tick of the module
  };

  /// joints: number of joints of the robot.
  explicit SetpointCheck(std::size_t joints) : crcs_(joints), kept_(kept_ticks * joints) {}

  /// Adds the set-points of all joints that this computer has for the next tick, from tick 0 on.
  void add(std::span<const std::int32_t> setpoints);

  /// Compares the answer of the module of a joint, for one of the last kept_ticks ticks.
  [[nodiscard]] Result compare(unsigned joint, const canopen::Master::SetpointChecksum& found) const;

  /// Number of kept ticks: more than a robot takes to stop, also with a tick of 1 ms and several modules that do not
  /// answer.
  static constexpr std::uint32_t kept_ticks = 8'192;

 private:
  std::vector<Crc32> crcs_;
  std::vector<std::uint32_t> kept_;  ///< checksums of all joints, by tick modulo kept_ticks
  std::uint32_t ticks_ = 0;
};

/// The reason why nothing was compared, for people: "its module has joined late". Empty for the other results.
[[nodiscard]] std::string why_not_compared(SetpointCheck::Result result);

}  // namespace proleg::host
