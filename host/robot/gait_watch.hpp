#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "host/robot/sdo_queue.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// Watches whether the joints of a moving robot still follow its gait. A joint does not if its drive has a fault, has
/// no power or ramps to the safe pose, if its mode differs, or if its module is not Operational. A fault is in the
/// state frames of the module, and the network state in its heartbeats. Statusword and mode are read, one module after
/// the other, all of them within 0.8 s (60 modules: 2.4 s), with at least 20 ms between two requests, so that TICK
/// finds its gaps. A module that reports an error is read first.
class GaitWatch final : public BusUser {
 public:
  enum class Reason : std::uint8_t {
    drive,    ///< the drive is not in Operation enabled
    mode,     ///< the mode differs from the expected one
    network,  ///< the module is not Operational
  };
  /// A joint that does not follow, and the reason.
  struct Loss {
    std::uint8_t node;
    Reason reason;
    std::uint16_t statusword = 0;                                     ///< 0x6041; valid for `drive`
    std::int8_t mode = 0;                                             ///< 0x6061; valid for `mode`
    canopen::NmtState state = canopen::NmtState::operational;         ///< valid for `network`
    canopen::EmergencyCode emergency = canopen::EmergencyCode::none;  ///< the last error that the module has reported
  };

  /// port: must outlive this. nodes: node ids of the robot in kernel order.
  GaitWatch(CanPort& port, std::vector<std::uint8_t> nodes);
  GaitWatch(const GaitWatch&) = delete;
  GaitWatch& operator=(const GaitWatch&) = delete;

  /// Starts the watch: the joints should follow from now on. Before start() and after stop() nothing is sent.
  void start(Microseconds now);
  void stop() { next_reading_ = never; }
  /// Reads the statuswords of all modules, as fast as they answer.
  void look_at_all();
  /// Whether the readings that look_at_all() has begun have ended.
  [[nodiscard]] bool has_looked() const { return readings_.is_idle(); }
  /// Resumes the watch of a module that has restarted, after the master has set it up again, or has failed to do so.
  void return_to_gait(std::uint8_t node);
  /// Sets the mode (0x6061) that the joints should have from now on; at first it is that of the gait. Nothing: the
  /// mode is being switched, and any mode is right.
  void expect_mode(std::optional<std::int8_t> mode) { expected_mode_ = mode; }

  /// The first joint that did not follow; nothing if all follow.
  [[nodiscard]] const std::optional<Loss>& loss() const { return loss_; }
  /// The last statusword that was read; nothing if none was read yet, or if the node does not belong to the robot.
  [[nodiscard]] std::optional<std::uint16_t> statusword(std::uint8_t node) const;

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override { readings_.transmitted(now, frame); }
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  struct Module {
    std::uint8_t node;
    bool is_away = false;     ///< the module has booted and is not set up again yet
    bool is_suspect = false;  ///< the module has reported an error since its last reading
    canopen::EmergencyCode emergency = canopen::EmergencyCode::none;
    std::optional<std::uint16_t> statusword = {};
  };
  [[nodiscard]] Module* module_of(std::uint8_t node);
  void on_emergency(const canopen::Emergency& emergency);
  void on_heartbeat(const canopen::Heartbeat& heartbeat);
  void read_next();
  void read_statusword(Module& module);
  void read_mode(const Module& module);
  void lose(const Module& module, Loss loss);

  std::vector<Module> modules_;
  SdoQueue readings_;
  Microseconds period_us_;
  Microseconds next_reading_ = never;
  std::optional<std::int8_t> expected_mode_ = canopen::mode_gait;
  std::size_t next_ = 0;  ///< next reading: the statusword of each module, then the mode of each
  std::optional<Loss> loss_;
};

}  // namespace proleg::host
